"""Faults on the wires: agents that disturb a wire, of several kinds.

One file of this folder that has a function `attach` is one kind of fault, found by its presence. It defines

    Settings                  a dataclass of the keys of [[fault]]: those of `When`, and its own
    attach(settings, place)   attaches the agent to its wires; ValueError for invalid settings

An agent is an ordinary party: wires list it when it pulls, and no other object depends on it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from random import Random
from typing import Protocol, cast

from ...core.discover import modules_with
from ...core.kernel import Kernel
from ...core.wire import Wire
from .when import When


@dataclass(frozen=True)
class FaultContext:
    """The environment of a new fault. who: its name on wires. wire: by name; ValueError if the scene has none.

    ticks: converts seconds. start: the tick at which the run begins. random: its own.
    """

    kernel: Kernel
    who: str
    wire: Callable[[str], Wire]
    ticks: Callable[[Fraction], int]
    start: int
    random: Random


class FaultKind(Protocol):
    """The definitions of every kind of fault."""

    Settings: type[When]

    def attach(self, settings: When, place: FaultContext) -> None: ...


@cache
def kinds() -> dict[str, FaultKind]:
    """Return every kind of fault, by the name of its file."""
    return {name: cast(FaultKind, module) for name, module in modules_with("attach", __name__, __path__).items()}


def pulse(when: When, place: FaultContext, wire: str, length: Fraction) -> None:
    """Pull a wire low for `length` at each time of `when`."""
    pin, ticks = place.wire(wire).attach(place.who), place.ticks(length)

    def strike() -> None:
        pin.drive(0)
        place.kernel.at(place.kernel.now + ticks, lambda: pin.drive(1))

    repeat(when, place, strike)


def repeat(when: When, place: FaultContext, strike: Callable[[], None]) -> None:
    """Call `strike` at each time of `when`, one event at a time."""

    def plan(number: int) -> None:
        if number and (when.every is None or number == when.times):
            return
        due = place.start + place.ticks(when.at + number * (when.every or 0))
        late = place.random.randrange(place.ticks(when.spread) + 1)
        place.kernel.at(due + late, lambda: struck(number))

    def struck(number: int) -> None:
        strike()
        plan(number + 1)

    plan(0)
