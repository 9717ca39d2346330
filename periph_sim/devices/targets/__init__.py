"""Devices on an I2C bus by the name of their model.

One file of this folder that has MODELS is one family of devices, found by its presence. It defines

    MODELS                           the names that `model` may have in [device.NAME]
    Settings                         a `Table` of its own keys there
    build(model, settings, place)    the target; BadDevice for settings that contradict each other

A target is an ordinary party: it knows the time and its wires, and no other object depends on it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, Protocol, cast

from ...bus.i2c.target_side import Reply, Stretches
from ...core.chip import Note
from ...core.discover import modules_with
from ...core.kernel import Kernel
from ...core.state import State
from ...core.table import Table
from ...core.wire import Wire


class BadDevice(ValueError):
    """Contradictory settings, or an invalid file named there. place: the key, and the place inside it."""

    def __init__(self, what: str, *place: str | int) -> None:
        super().__init__(what)
        self.place = place


@dataclass(frozen=True)
class TargetContext:
    """The environment of a new target. who: its name on wires. address: 7 bits; None if the case gives none.

    ticks: converts seconds. start: the tick at which the run begins. folder: base of relative paths. random: its own.
    wire: by name; ValueError if the scene has none. hold_clock: see `TargetSide`. note: called with each note.
    """

    STATE = State("random")

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

    def duty(self, text: str, source: str) -> None:
        """Note that the controller did what the source forbids."""
        self.note(Note("duty", text, source))


class PlainReply:
    """Base of replies that acknowledge the address and never stretch the clock."""

    ack = True
    stretches: Stretches = ()


class Target(Protocol):
    """A device on the bus. addresses: all addresses that it acknowledges, 7 bits each."""

    @property
    def addresses(self) -> tuple[int, ...]: ...

    def answer(self, address_byte: int) -> Reply | None:
        """Return the reply to a START with its address; None if it does not acknowledge."""

    def on_end(self, stop: bool, whole: bool) -> None:
        """Handle the end of a phase that it acknowledged, see `TargetSide`."""

    def power_on(self) -> None:
        """Handle the return of the supply: volatile data are lost."""


class Family(Protocol):
    """The definitions of every file of devices."""

    MODELS: tuple[str, ...]
    Settings: type[Table]

    def build(self, model: str, settings: Any, place: TargetContext) -> Target: ...


@cache
def families() -> Mapping[str, Family]:
    """Return the family of every model, by the model's name."""
    modules = modules_with("MODELS", __name__, __path__).values()
    return {model: cast(Family, module) for module in modules for model in module.MODELS}


def address_among(place: TargetContext, model: str, possible: tuple[int, ...]) -> int:
    """Return the device's address, its first one if the case gives none. Raise BadDevice for an impossible address."""
    address = possible[0] if place.address is None else place.address
    if address not in possible:
        can = ", ".join(f"{one:#04x}" for one in possible)
        raise BadDevice(f"{model} has no address {address:#04x}; it can have {can}", "address")
    return address
