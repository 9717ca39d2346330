"""Bounds beside what a run shows: a case goes in; each bound, the value seen and their ratio come out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from ...core.time import Timebase
from ...scene.case.model import Case
from ...scene.scene import Scene
from ...timing.budget_schema import Budget
from ...timing.measures.measure import Measure
from .deadlines import deadlines
from .form_of_case import closed_form
from .limits import LimitCheck, compare_with_limits
from .service_routine import ServiceRoutines
from .terms import Bound

ANYTHING = "1000000 s"
MANY = 10**18


@dataclass(frozen=True)
class BoundWithRun:
    """seen: the largest value of a run in ticks, the smallest of what is bounded from below; None: none was."""

    bound: Bound
    seen: int | None
    count: int

    @property
    def holds(self) -> bool:
        """False where nothing was seen: then nothing is compared. True where the sum is no bound, but a figure."""
        if self.seen is None:
            return False
        if self.bound.unproven:
            return True
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

    cycle: ticks of one of SYSCLKOUT. held_from: cycles more before each write of I2CDXR, from which on SCL may be held.
    limits: those of the case, beside the bounds.
    """

    case: str
    simulated_s: float
    timebase: Timebase
    cycle: Fraction
    handlers: ServiceRoutines
    deadlines: tuple[Bound, ...]
    held_from: int
    beside: tuple[BoundWithRun, ...]
    hung: tuple[str, ...]
    limits: tuple[LimitCheck, ...]

    @property
    def missed(self) -> list[Bound]:
        """The deadlines that may be missed."""
        return [deadline for deadline in self.deadlines if deadline.ticks < 0]

    @property
    def beyond(self) -> list[LimitCheck]:
        """The limits that some phase may break."""
        return [limit for limit in self.limits if limit.beyond]

    @property
    def unproven(self) -> list[LimitCheck]:
        """The limits whose closed form has a term that is no bound."""
        return [limit for limit in self.limits if limit.unproven]

    @property
    def holds(self) -> bool:
        """There are bounds, and no value is beyond its own."""
        return not self.missed and not self.hung and all(each.holds for each in self.beside)

    @property
    def passed(self) -> bool:
        """The bounds hold and are proven, and none is beyond a limit of the case."""
        return self.holds and not self.beyond and not self.unproven


def report(case: Case, seconds: Fraction | None = None, progress: Callable[[float], None] | None = None) -> Report:
    """The bounds of a case beside a run of so many seconds, the case's own if None. BadBound if there is no form."""
    closed = closed_form(case)
    spare = tuple(deadlines(closed))
    length = case.duration if seconds is None else seconds
    about = (case.name, float(length), closed.timebase, closed.calm.cycle, closed.handlers, spare, closed.held_from)
    if any(deadline.ticks < 0 for deadline in spare):
        return Report(*about, (), (), compare_with_limits(Scene(case).limits, ()))
    limited = {measure for budget in case.budget for measure in (budget.measure, *(c.measure for c in budget.also))}
    known = closed.bounds(spare)
    found = [bound for bound in known if bound.part == 1 and (not bound.special or bound.measure in limited)]
    budgets = (*case.budget, *(_anything(bound) for bound in found))
    scene = Scene(case.model_copy(update={"budget": budgets, "breaks": ()}))
    scene.run(length, progress)
    of_case, ours = scene.limits[: len(case.budget)], scene.limits[len(case.budget) :]
    beside = [_beside(bound, limit.measure) for bound, limit in zip(found, ours, strict=True)]
    return Report(*about, tuple(beside), tuple(scene.deadlocks()), compare_with_limits(of_case, known))


def _beside(bound: Bound, of: Measure) -> BoundWithRun:
    return BoundWithRun(bound, None if of.silent else of.least if bound.least else of.worst, of.count)


def _anything(bound: Bound) -> Budget:
    """A budget that measures and allows everything."""
    most = MANY if bound.counted else ANYTHING
    return Budget(name=f"bound of {bound.measure}", measure=bound.measure, max=most)
