"""Targets: devices that answer to an address on an I2C bus, selected by the key `model` of [device.NAME].

Each file of this folder that defines MODELS is one family of devices. The files are found automatically. A file defines

    MODELS                           the names that `model` can have in [device.NAME]
    Settings                         a `Table` with the keys of this family
    build(model, settings, place)    a function that returns the target; raises BadDevice for contradictory settings

`place` is a `TargetContext`, through which the target reads the time and drives wires. No other module depends on a
family.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, Protocol, cast

from ...bus.i2c.target_side import Stretches
from ...bus.i2c.target_side import Target as Target
from ...core.chip import Note
from ...core.discover import modules_with
from ...core.kernel import Kernel
from ...core.state import State
from ...core.table import Table
from ...core.wire import Wire


class BadDevice(ValueError):
    """Error: the settings of a device are contradictory, or a file that they name is invalid.

    place: the path of the invalid setting in the device's table: keys and list indices, such as ("register", 2, "at").
    """

    def __init__(self, what: str, *place: str | int) -> None:
        super().__init__(what)
        self.place = place


@dataclass(frozen=True)
class TargetContext:
    """The environment of a new target.

    who: the name under which the target drives wires.
    address: the 7-bit address; None if the case does not define it.
    ticks: a function that converts seconds to ticks.
    start: the tick at which the run begins.
    folder: the folder of the case, to which the paths in settings are relative.
    random: the target's own random generator.
    wire: a function that returns the wire with a name, and raises ValueError if there is no such wire.
    hold_clock: a function that holds SCL low for a number of ticks.
    note: a function that adds a note to the notes of the run.
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
        """Add a note that the controller did something that `source` forbids."""
        self.note(Note("duty", text, source))


class PlainReply:
    """Base of replies that acknowledge the address and never stretch the clock."""

    ack = True
    stretches: Stretches = ()


class Family(Protocol):
    """Interface of the modules that define devices."""

    MODELS: tuple[str, ...]
    Settings: type[Table]

    def build(self, model: str, settings: Any, place: TargetContext) -> Target: ...


@cache
def families() -> Mapping[str, Family]:
    """Return the module that defines each model, by the name of the model."""
    modules = modules_with("MODELS", __name__, __path__).values()
    return {model: cast(Family, module) for module in modules for model in module.MODELS}


def address_among(place: TargetContext, model: str, possible: tuple[int, ...]) -> int:
    """Return the device's address, by default the first in `possible`. Raise BadDevice if it is not in `possible`."""
    address = possible[0] if place.address is None else place.address
    if address not in possible:
        can = ", ".join(f"{one:#04x}" for one in possible)
        raise BadDevice(f"{model} has no address {address:#04x}; it can have {can}", "address")
    return address
