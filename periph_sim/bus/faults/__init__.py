"""Faults on the wires: agents that disturb a wire, of several kinds.

One file of this folder that has a function `attach` is one kind of fault, found by its presence. It defines

    Settings                  a dataclass of the keys of [[fault]]: those of `When`, and its own
    attach(settings, place)   attaches the agent, returns its `Repeated`; ValueError for invalid settings

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
from ...core.state import State
from ...core.wire import Wire
from ..held_line import HeldLine
from .when import When


@dataclass(frozen=True)
class FaultContext:
    """The environment of a new fault.

    who: the name of the fault's agent on the wires.
    wire: returns the wire of a name; ValueError if the scene has no such wire.
    ticks: converts seconds to ticks.
    start: the tick at which the run begins.
    random: the random generator of this fault alone.
    """

    STATE = State("random")

    kernel: Kernel
    who: str
    wire: Callable[[str], Wire]
    ticks: Callable[[Fraction], int]
    start: int
    random: Random


class FaultKind(Protocol):
    """The definitions that the module of each kind of fault has."""

    Settings: type[When]

    def attach(self, settings: When, place: FaultContext) -> Repeated: ...


@cache
def kinds() -> dict[str, FaultKind]:
    """Return the modules of all kinds of faults, indexed by the names of their files."""
    return {name: cast(FaultKind, module) for name, module in modules_with("attach", __name__, __path__).items()}


class Repeated:
    """Calls `strike` at each time of `when`, one event at a time."""

    STATE = State("_place _strike _number")

    def __init__(self, when: When, place: FaultContext, strike: Callable[[], None]) -> None:
        self._when = when
        self._place = place
        self._strike = strike
        self._number = 0
        self._plan()

    def _plan(self) -> None:
        when, place, number = self._when, self._place, self._number
        if number and (when.every is None or number == when.times):
            return
        due = place.start + place.ticks(when.at + number * (when.every or 0))
        late = place.random.randrange(place.ticks(when.spread) + 1)
        place.kernel.call_at(due + late, self._struck)

    def _struck(self) -> None:
        self._strike()
        self._number += 1
        self._plan()


def pulse(when: When, place: FaultContext, wire: str, length: Fraction) -> Repeated:
    """Pull a wire low for `length` at each time of `when`."""
    line = HeldLine(place.kernel, place.wire(wire), None, place.who, place.ticks(length), 0)
    return Repeated(when, place, line.pull)
