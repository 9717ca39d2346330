"""Devices on an I2C bus by name: a model and its settings go in, a target that answers comes out.

One file of this folder that has MODELS is one family of devices, found by being there. It defines

    MODELS                           the names that `model` may have in [device.NAME]
    Settings                         a `Table` of the keys that are its own there
    build(model, settings, place)    the target; BadDevice for settings that contradict each other

A target is a party like any other: it knows the time and its wires, and nothing else knows of it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, Protocol, cast

from ...bus.i2c.target_side import Reply
from ...core.chip import Note
from ...core.discover import modules_with
from ...core.kernel import Kernel
from ...core.table import Table
from ...core.wire import Wire


class BadDevice(ValueError):
    """Settings that contradict each other, or a file that they name. place: the key, and where inside it."""

    def __init__(self, what: str, *place: str | int) -> None:
        super().__init__(what)
        self.place = place


@dataclass(frozen=True)
class TargetContext:
    """What a target is built with. who: its name on wires. address: 7 bits; None if the case gives none.

    ticks: of seconds. start: the tick at which the run begins. folder: paths count from it. random: its own.
    wire: by name; ValueError if the scene has none. hold_clock: see `TargetSide`. note: takes what is to be noted.
    """

    kernel: Kernel
    who: str
    address: int | None
    ticks: Callable[[Fraction], int]
    start: int
    folder: Path
    random: Random
    wire: Callable[[str], Wire]
    hold_clock: Callable[[int], None]
    note: Callable[[Note], None]


class Target(Protocol):
    """addresses: 7 bits each, all that it answers to."""

    @property
    def addresses(self) -> tuple[int, ...]: ...

    def answer(self, address_byte: int) -> Reply | None:
        """The reply to a START with its address; None where it does not acknowledge."""

    def on_end(self, stop: bool, whole: bool) -> None:
        """A phase that it acknowledged ends, see `TargetSide`."""

    def power_on(self) -> None:
        """The supply was gone and comes back: what is not stored for good is lost."""


class Family(Protocol):
    """What every file of devices has."""

    MODELS: tuple[str, ...]
    Settings: type[Table]

    def build(self, model: str, settings: Any, place: TargetContext) -> Target: ...


@cache
def families() -> Mapping[str, Family]:
    """The family of every model, by the model's name."""
    modules = modules_with("MODELS", __name__, __path__).values()
    return {model: cast(Family, module) for module in modules for model in module.MODELS}


def address_among(place: TargetContext, model: str, possible: tuple[int, ...]) -> int:
    """The device's address, its first one if the case gives none. BadDevice for one that it cannot have."""
    address = possible[0] if place.address is None else place.address
    if address not in possible:
        can = ", ".join(f"{one:#04x}" for one in possible)
        raise BadDevice(f"{model} has no address {address:#04x}; it can have {can}", "address")
    return address
