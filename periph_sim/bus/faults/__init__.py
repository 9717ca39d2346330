"""Faults on the wires: a kind and its settings go in, an agent that disturbs a wire comes out.

One file of this folder that has a function `attach` is one kind of fault, found by being there. It defines

    Settings                  a dataclass of what a case may set in [[fault]]: `When`, and its own
    attach(settings, place)   puts the agent on its wires; ValueError, one sentence, if it cannot be

An agent is a party like any other: wires name it where it pulls, and nothing else knows of it.
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
    """What a fault is built with. who: its name on wires. wire: by name; ValueError if the scene has none.

    ticks: of seconds. start: the tick at which the run begins. random: its own.
    """

    kernel: Kernel
    who: str
    wire: Callable[[str], Wire]
    ticks: Callable[[Fraction], int]
    start: int
    random: Random


class FaultKind(Protocol):
    """What every kind of fault of this folder has."""

    Settings: type[When]

    def attach(self, settings: When, place: FaultContext) -> None: ...


@cache
def kinds() -> dict[str, FaultKind]:
    """Every kind of fault, by the name of its file."""
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
