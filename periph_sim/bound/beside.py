"""Bounds beside what a run shows: a case goes in; each bound, the value seen and their ratio come out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from ..board.scene import Scene
from ..case.model import Budget, Case
from ..core.options import options_from
from ..core.time import Timebase
from ..f28335.i2c_options import I2cOptions
from ..timing.measures import Measure
from .calm import observe, serving_unit
from .closed import Closed
from .deadlines import deadlines
from .handler import Handlers, observe_handlers
from .terms import Bound

ANYTHING = "1000000 s"


@dataclass(frozen=True)
class Beside:
    """seen: the largest value of a run in ticks, the smallest of what is bounded from below; None: none was."""

    bound: Bound
    seen: int | None
    count: int

    @property
    def holds(self) -> bool:
        """False where nothing was seen: then nothing is proven."""
        if self.seen is None:
            return False
        return self.seen >= self.bound.ticks if self.bound.least else self.seen <= self.bound.ticks

    @property
    def ratio(self) -> Fraction | None:
        """Bound by value seen, the larger on top; None where one of them is not above 0."""
        if self.seen is None or min(self.seen, self.bound.ticks) <= 0:
            return None
        return Fraction(max(self.bound.ticks, self.seen), min(self.bound.ticks, self.seen))


@dataclass(frozen=True)
class Report:
    """deadlines: the spare time of each; if one is negative there is no bound. hung: waits that the run never left.

    cycle: ticks of one of SYSCLKOUT.
    """

    case: str
    simulated_s: float
    timebase: Timebase
    cycle: Fraction
    handlers: Handlers
    deadlines: tuple[Bound, ...]
    beside: tuple[Beside, ...]
    hung: tuple[str, ...]

    @property
    def missed(self) -> list[Bound]:
        """The deadlines that may be missed."""
        return [deadline for deadline in self.deadlines if deadline.ticks < 0]

    @property
    def holds(self) -> bool:
        return not self.missed and not self.hung and all(each.holds for each in self.beside)


def closed_form(case: Case) -> Closed:
    """The closed form of a case. BadBound if it has none."""
    unit = serving_unit(case)
    calm = observe(case)
    timebase = Timebase(*(int(each.oscclk * each.pll / 2) for each in case.unit.values()))
    options = options_from(I2cOptions, case.unit[unit].options.i2c)
    return Closed(case, calm, observe_handlers(case, unit), timebase, options)


def report(case: Case, seconds: Fraction | None = None, progress: Callable[[float], None] | None = None) -> Report:
    """The bounds of a case beside a run of so many seconds, the case's own if None. BadBound if there is no form."""
    closed = closed_form(case)
    spare = tuple(deadlines(closed))
    length = case.duration if seconds is None else seconds
    about = (case.name, float(length), closed.timebase, closed.calm.cycle, closed.handlers, spare)
    if any(deadline.ticks < 0 for deadline in spare):
        return Report(*about, (), ())
    found = [closed.response, closed.round, closed.slack, *closed.spans]
    found += [closed.age] if closed.age is not None else []
    scene = Scene(case.model_copy(update={"budget": tuple(_anything(bound) for bound in found), "breaks": ()}))
    scene.run(length, progress)
    beside = [_beside(bound, limit.measure) for bound, limit in zip(found, scene.limits, strict=True)]
    return Report(*about, tuple(beside), tuple(scene.deadlocks()))


def _beside(bound: Bound, of: Measure) -> Beside:
    return Beside(bound, None if of.silent else of.least if bound.least else of.worst, of.count)


def _anything(bound: Bound) -> Budget:
    """A budget that measures and allows everything."""
    return Budget(name=bound.name, measure=bound.measure, max=ANYTHING)
