"""Budgets: limits and measures go in, verdicts with worst case, margin and time come out."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from ..case.model import Budget
from ..case.settings import duration
from ..core.nearest import near
from ..core.time import Timebase
from .measures import MEASURES, SPAN, Counter, Measure, make


class BadBudget(ValueError):
    """A budget that names no measure, or whose limit does not fit it; one sentence. key: measure, max or min."""

    def __init__(self, what: str, key: str) -> None:
        super().__init__(what)
        self.key = key


@dataclass
class Verdict:
    """worst, limit, margin: microseconds for times, else plain counts. at_s: when the worst was, from the start on."""

    name: str
    measure: str
    unit: str
    worst: float | int | None
    limit: float | int
    margin: float | int | None
    count: int
    verdict: str  # "pass" or "fail"
    at_s: float | None
    why: str = ""


class Limit:
    """One budget with its measure; `verdict` after the run."""

    def __init__(self, budget: Budget, timebase: Timebase) -> None:
        if not budget.measure.startswith(SPAN) and budget.measure not in MEASURES:
            hint = near(budget.measure, [*MEASURES, f"{SPAN}NAME"])
            raise BadBudget(f"there is no measure {budget.measure!r}; {hint}", "measure")
        self.budget = budget
        self.measure: Measure = make(budget.measure)
        self._timebase = timebase
        self._max = self._limit("max", budget.max)
        self._min = self._limit("min", budget.min)
        if self._max is not None and self._min is not None and self._min > self._max:
            raise BadBudget(f"min {budget.min} is above max {budget.max}, so no run can keep both", "min")

    def _limit(self, which: str, given: str | int | None) -> int | None:
        """The limit in ticks or counts."""
        if given is None:
            return None
        if self.measure.unit == "time":
            try:
                return self._timebase.ticks(duration(given), "nearest")
            except ValueError as error:
                raise BadBudget(str(error), which) from None
        if isinstance(given, str):
            counted = "a number" if self.measure.unit == "count" else f"a number of {self.measure.unit}"
            raise BadBudget(f"{given!r}, but {self.budget.measure!r} is {counted}; write a whole number", which)
        return given

    def verdict(self, start: int = 0) -> Verdict:
        """What a run that began at `start` showed. A duration never measured is a failure, never a silent pass."""
        measure = self.measure
        silent = not measure.count and not isinstance(measure, Counter)
        over = None if self._max is None else self._max - measure.worst
        under = None if self._min is None else measure.least - self._min
        slacks = [slack for slack in (over, under) if slack is not None]
        margin = min(slacks)
        by_max = over is not None and over == margin
        limit = self._max if by_max else self._min
        worst, at = (measure.worst, measure.worst_at) if by_max else (measure.least, measure.least_at)
        assert limit is not None
        return Verdict(
            name=self.budget.name,
            measure=self.budget.measure,
            unit="us" if measure.unit == "time" else measure.unit,
            worst=None if silent else self._show(worst),
            limit=self._show(limit),
            margin=None if silent else self._show(margin),
            count=measure.count,
            verdict="fail" if silent or margin < 0 else "pass",
            at_s=None if silent or at < 0 else float(self._timebase.seconds(at - start)),
            why=self.budget.why,
        )

    def _show(self, value: int) -> float | int:
        if self.measure.unit != "time":
            return value
        return float(round(Fraction(value * 1_000_000, self._timebase.per_second), 4))
