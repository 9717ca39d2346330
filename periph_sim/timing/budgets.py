"""Budgets: limits and measures go in, verdicts with worst case, margin and time come out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache

from msgspec import Struct

from ..core.settings import duration, share
from ..core.time import NO_TIME, Timebase, round_ratio
from .budget_schema import Budget
from .language.scope import BadEvent, Scope
from .measures.event import EventCount
from .measures.factory import measure_named
from .measures.measure import MILLIONTHS, Measure
from .verdict import FAIL, NOT_JUDGED, PASS, Verdict

PER_MILLE = {"p50": 500, "p95": 950, "p99": 990, "p99_9": 999}


class BadBudget(ValueError):
    """A budget that names no measure, or whose limits do not fit it or each other; one sentence.

    place: the wrong key, from the budget's table down.
    """

    def __init__(self, what: str, *place: str | int) -> None:
        super().__init__(what)
        self.place = place

    @property
    def key(self) -> str | int:
        """The wrong key alone."""
        return self.place[-1]


class _Seen(Struct, frozen=True):
    """A limit, and what the run has beside it."""

    which: str
    limit: int
    value: int
    at: int
    slack: int


class BudgetJudge:
    """One budget with its measure; `verdict` after the run. scope: what a measure of events may name.

    start: the tick at which the run begins. parts: this one, and one for each condition that is joined to it.
    others: of the same scene. same_as: the one of these whose measure it looks at, too.
    """

    def __init__(
        self,
        budget: Budget,
        timebase: Timebase,
        scope: Scope | None = None,
        start: int = 0,
        others: Sequence[BudgetJudge] = (),
    ) -> None:
        self.budget = budget
        self._text = budget.measure
        self.measure = _measure(self._text, scope or Scope())
        self._timebase = timebase
        self._found = ""
        self._coverage_of = budget.coverage
        self._given = budget.limits()
        self._limits = {key: self._limit(key, given) for key, given in self._given.items()}
        self._check()
        if budget.after is not None:
            if not self.measure.series:
                raise BadBudget(f"{budget.measure!r} is one number a run, so none of it can be left out", "after")
            self.measure.not_before = start + timebase.ticks(budget.after, "nearest")
        if PER_MILLE.keys() & self._limits.keys():
            self.measure.tally()
        self.parts = [self, *(self._joined(i, timebase, scope, start) for i in range(len(budget.also)))]
        if len(self.parts) > 1:
            for part in self.parts:
                part.measure.keep()
        self.same_as = next((other for other in others if self._measures_as(other)), None)
        if self.same_as is not None:
            if self.measure.tallied:
                self.same_as.measure.tally()
            self.measure = self.same_as.measure

    def _measures_as(self, other: BudgetJudge) -> bool:
        """Whether both measure the same, so that one does it for both. Conditions that are joined choose values."""
        if self._text != other._text or other.same_as is not None:
            return False
        return len(self.parts) == len(other.parts) == 1 and self.budget.after == other.budget.after

    def _joined(self, entry: int, timebase: Timebase, scope: Scope | None, start: int) -> BudgetJudge:
        """A condition as a budget of its own."""
        given = self.budget.also[entry]
        try:
            name = f"{self.budget.name} and {given.measure}"
            table = {"name": name, "measure": given.measure, **given.limits()}
            part = BudgetJudge(Budget.model_validate(table), timebase, scope, start)
        except BadBudget as error:
            raise BadBudget(str(error), "and", entry, *error.place) from None
        for each in (self, part):
            if not each.measure.occurrence or each.measure.occurrence != self.measure.occurrence:
                what = f"{each.budget.measure!r} is not measured read by read, so nothing can be joined to it; "
                joinable = "age, model age, stretch and value error are"
                raise BadBudget(f"{what}{joinable}", *(("measure",) if each is self else ("and", entry, "measure")))
        return part

    @property
    def own_measures(self) -> list[Measure]:
        """Those that it, and no other budget, has listen to a run."""
        return [part.measure for part in self.parts] if self.same_as is None else []

    @property
    def limits(self) -> dict[str, int]:
        """The limits by their keys, in ticks, millionths or counts."""
        return dict(self._limits)

    def _limit(self, which: str, given: str | int) -> int:
        """The limit in ticks, millionths or counts."""
        unit = self.measure.unit
        if unit == "time":
            try:
                return _nearest_tick(given, self._timebase.per_second)
            except ValueError as error:
                raise BadBudget(str(error), which) from None
        if unit == "%":
            return self._part(which, given)
        if unit == "LSB":
            return self._steps(which, given)
        if isinstance(given, str):
            counted = "a number" if unit in ("count", "value") else f"a number of {unit}"
            raise BadBudget(f"{given!r}, but {self.budget.measure!r} is {counted}; write a whole number", which)
        return given

    def _part(self, which: str, given: str | int) -> int:
        """ "40 %" in millionths."""
        try:
            return round(share(given) * MILLIONTHS)
        except ValueError:
            what = f"{given!r}, but {self.budget.measure!r} is a part of the time; write for instance '40 %'"
            raise BadBudget(what, which) from None

    def _steps(self, which: str, given: str | int) -> int:
        """2 or "2.5 LSB" in millionths."""
        text = str(given)
        try:
            steps = Fraction(text.removesuffix("LSB").strip())
        except (ValueError, ZeroDivisionError):
            steps = Fraction(-1)
        if steps < 0 or (isinstance(given, str) and not text.endswith("LSB")):
            raise BadBudget(f"{given!r}, but {self.budget.measure!r} is in LSB; write for instance '2.5 LSB'", which)
        return round(steps * MILLIONTHS)

    def _check(self) -> None:
        """Refuse limits that no run can keep, or of which one says all that another says."""
        limits, given = self._limits, self._given
        others = [key for key in limits if key != "exactly"]
        if "exactly" in limits and others:
            raise BadBudget(f"exactly says all that {' and '.join(others)} could; leave one of them out", "exactly")
        percentiles = [key for key in PER_MILLE if key in limits]
        if percentiles and not self.measure.series:
            key = percentiles[0]
            raise BadBudget(f"{self.budget.measure!r} is one number a run and has no percentiles; write max", key)
        low, high = limits.get("min"), limits.get("max")
        if low is not None and high is not None and low > high:
            what = f"min {given['min']} is above max {given['max']}, so no run can keep both"
            raise BadBudget(f"{what}; raise max or lower min", "min")
        for place, key in enumerate(percentiles):
            if high is not None and limits[key] > high:
                what = f"{key} {given[key]} is above max {given['max']}, which no value may exceed"
                raise BadBudget(f"{what}; lower {key} or leave it out", key)
            if low is not None and low > limits[key]:
                what = f"{key} {given[key]} is below min {given['min']}, so no run can keep both"
                raise BadBudget(f"{what}; raise {key} or lower min", key)
            for higher in percentiles[place + 1 :]:
                if limits[key] > limits[higher]:
                    what = f"{key} {given[key]} is above {higher} {given[higher]}, which says more already"
                    raise BadBudget(f"{what}; lower {key} or leave it out", key)
        if isinstance(self.measure, EventCount) and self.measure.event.free:
            for key in limits:
                if key != "min" and limits[key] == 0:
                    what = "a span's name is free text, so that none was seen proves nothing"
                    raise BadBudget(f"{what}; limit what the run does instead", key)

    def finish(self, now: int) -> None:
        """The run is over: what is not over counts with what it has come to."""
        if self.same_as is not None:
            self._found = self.same_as._found
            return
        for part in self.parts:
            part.measure.finish(now)
            part._found = part.measure.close(now)
        if len(self.parts) > 1:
            from .measures.combined import combine

            lacking = combine([part.measure for part in self.parts])
            for part, lacks in zip(self.parts, lacking, strict=True):
                if lacks:
                    what = f"{self.measure.count} values of {self.budget.measure!r}"
                    part._found = f"{part.budget.measure!r} has no value for {lacks} of {what}"

    def verdict(self, start: int = 0) -> Verdict:
        """The verdict of a run that began at `start`. What was measured too seldom is not judged, which is no pass.

        Of joined conditions that which is broken, else that which is not judged, else the first; all of them in words.
        """
        if len(self.parts) == 1:
            return self._judge(start)
        verdicts = [part._judge(start) for part in self.parts]
        shown = verdicts[self.parts.index(self.shown)]
        told = [verdict.found or part._in_words(verdict) for part, verdict in zip(self.parts, verdicts, strict=True)]
        return replace(shown, name=self.budget.name, why=self.budget.why, found="; ".join(told))

    @property
    def shown(self) -> BudgetJudge:
        """The condition that the verdict shows: the first one that is broken, else not judged; this one if all pass."""
        if len(self.parts) == 1:
            return self
        words = [part._judge(0).verdict for part in self.parts]
        return next((self.parts[words.index(word)] for word in (FAIL, NOT_JUDGED) if word in words), self)

    def _judge(self, start: int) -> Verdict:
        measure = self.measure
        limits = {key: limit for key, limit in self._limits.items() if self._can_judge(key, limit)}
        silent = measure.silent or not limits
        enough = self._measured_enough()
        found = self._found or measure.refuted or (measure.missing() if silent else "")
        if not enough and not found:
            found = f"measured {measure.measured} of {measure.occasions} {measure.asked}, less than {self._coverage()}"
        if silent:
            nearest = next(_Seen(key, limit, 0, NO_TIME, 0) for key, limit in self._limits.items())
        else:
            nearest = min((self._beside(key, limit) for key, limit in limits.items()), key=lambda s: s.slack)
        at = NO_TIME if silent else nearest.at
        until = NO_TIME
        if measure.refuted and nearest.slack >= 0:
            at, until = measure.refuted_at, measure.refuted_until
        return Verdict(
            name=self.budget.name,
            measure=self.budget.measure,
            unit="us" if measure.unit == "time" else measure.unit,
            worst=None if silent else self.show(nearest.value),
            limit=self.show(nearest.limit),
            margin=None if silent else self.show(nearest.slack),
            count=measure.counted,
            verdict=FAIL if nearest.slack < 0 or measure.refuted else NOT_JUDGED if silent or not enough else PASS,
            at_s=None if at < 0 else (at - start) / self._timebase.per_second,
            why=self.budget.why,
            which=nearest.which,
            found=found,
            measured=measure.measured,
            occasions=measure.occasions,
            until_s=None if until < 0 else (until - start) / self._timebase.per_second,
        )

    def _can_judge(self, which: str, limit: int) -> bool:
        """What the end of the run cut off has come to so much at least: it says when that is too much, and no more."""
        measure = self.measure
        if measure.count > measure.cut_off or not measure.series:
            return True
        return which not in ("min", "exactly") or (which == "exactly" and measure.worst > limit)

    def _measured_enough(self) -> bool:
        measure = self.measure
        part = self._coverage_of
        return measure.occasions is None or measure.measured * part.denominator >= part.numerator * measure.occasions

    def _coverage(self) -> str:
        return f"{float(100 * self._coverage_of):g} %"

    def typical(self, start: int = 0) -> Verdict | None:
        """The other end of what was measured: the value furthest from the limit. None where there was one value."""
        part = self.shown
        measure, worst = part.measure, self.verdict(start)
        low = worst.which == "min"
        value, at = (measure.worst, measure.worst_at) if low else (measure.least, measure.least_at)
        if worst.worst is None or not measure.series or measure.count < 2 or at < 0:
            return None
        return replace(worst, worst=part.show(value), at_s=float(self._timebase.seconds(at - start)), margin=None)

    def _in_words(self, verdict: Verdict) -> str:
        """ "age 22.153 ms at 0.025195 s (max 25 ms)"."""
        value = f"{verdict.worst} {verdict.unit}"
        if verdict.unit == "us" and verdict.worst is not None:
            value = self._timebase.show(round(verdict.worst * self._timebase.per_second / 1_000_000))
        at = "" if verdict.at_s is None else f" at {verdict.at_s:.6f} s"
        return f"{self.budget.measure} {value}{at} ({verdict.which} {self._given[verdict.which]})"

    def _beside(self, which: str, limit: int) -> _Seen:
        measure = self.measure
        if which == "max":
            return _Seen(which, limit, measure.worst, measure.worst_at, limit - measure.worst)
        if which == "min":
            return _Seen(which, limit, measure.least, measure.least_at, measure.least - limit)
        if which == "exactly":
            over, under = measure.worst - limit, limit - measure.least
            if over >= under:
                return _Seen(which, limit, measure.worst, measure.worst_at, -abs(over))
            return _Seen(which, limit, measure.least, measure.least_at, -abs(under))
        value, at = measure.percentile(PER_MILLE[which])
        return _Seen(which, limit, value, at, limit - value)

    def show(self, value: int) -> float | int:
        """A value of the measure in the unit of verdicts."""
        if self.measure.unit == "%":
            return value * 100 / MILLIONTHS
        if self.measure.unit == "LSB":
            return value / MILLIONTHS
        if self.measure.unit != "time":
            return value
        tenths, rest = divmod(value * 10_000_000_000, self._timebase.per_second)  # of a nanosecond
        middle = 2 * rest - self._timebase.per_second
        return (tenths + (middle > 0 or (middle == 0 and tenths % 2))) / 10_000  # a half goes to the even one


@lru_cache(maxsize=1024)  # scenes of one case have the same limits again and again
def _nearest_tick(given: str | int, per_second: int) -> int:
    """ValueError where the text is no duration."""
    return round_ratio(duration(given) * per_second, "nearest")


def _measure(text: str, scope: Scope) -> Measure:
    try:
        return measure_named(text, scope)
    except BadEvent as error:
        raise BadBudget(str(error), "measure") from None
