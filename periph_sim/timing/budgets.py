"""Judging of budgets after a run: verdicts with the worst case, its margin and its time."""

# core: compiled

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING, final

from msgspec import Struct

from ..core.records import Kind
from ..core.time import NO_TIME, Timebase
from ..form.c_types import BigInt
from .budget_plan import PER_MILLE, BudgetPlan
from .budget_schema import Budget
from .measures.event import EventMeasure
from .measures.measure import MILLIONTHS, Measure, Tally
from .verdict import FAIL, NOT_JUDGED, PASS, Verdict

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Values(Struct, frozen=True, eq=False):
    """Values of one budget's measure, in the order in which they were taken.

    A scene with `keep_values=True` stores them. Each value takes 16 bytes of memory. Measures with one number for the
    whole run (counts, loads) have no values.

    values: int64[n], in ticks if `unit` is "time", in millionths if it is "LSB", else as plain numbers.
    at: int64[n], the tick of each value, counted from the start of the run.
    limits: a dictionary from the key of a limit, such as "max", to the limit, in the same unit as the values.
    """

    unit: str
    values: NDArray[np.int64]
    at: NDArray[np.int64]
    limits: dict[str, int]


@final
class BudgetJudge:
    """Judges one budget in a scene. Call `verdict` after the run.

    others: the judges of the earlier budgets in the scene.
    joined: the judges of the conditions under the budget's key `and`, which limit further measures.
    same_as: the judge of an earlier budget, if both budgets have the same measure and so share one measure object; else
        None.
    own_measures: the measures that this judge and its joined conditions add to the run; empty if `same_as` is not None.
    """

    def __init__(self, plan: BudgetPlan, timebase: Timebase, others: Sequence[BudgetJudge] = ()) -> None:
        self.budget: Budget = plan.budget
        self._timebase = timebase
        self.plan: BudgetPlan = plan
        self._found = ""
        self.same_as: BudgetJudge | None = None if plan.same_as < 0 else others[plan.same_as]
        self.measure: Measure = plan.make() if self.same_as is None else self.same_as.measure
        self.measure.not_before = plan.not_before
        if PER_MILLE.keys() & plan.limits.keys() and self.measure.tally is None:
            self.measure.tally = Tally()
        self.joined = [BudgetJudge(part, timebase) for part in plan.joined]
        if self.joined:
            for part in self.parts:
                part.measure.keep()
        self.own_measures: list[Measure] = [part.measure for part in self.parts] if self.same_as is None else []

    @property
    def parts(self) -> list[BudgetJudge]:
        """This judge and the judges of its joined conditions."""
        return [self, *self.joined]

    def finish(self, now: int) -> None:
        """End the measures at tick `now`.

        If the end of the run cuts off an occurrence, the value so far is taken only if it exceeds all complete values.
        """
        if self.same_as is not None:
            self._found = self.same_as._found
            return
        for part in self.parts:
            part.measure.finish(now)
            part._found = part.measure.close(now)
        if self.joined:
            lacking = combine([part.measure for part in self.parts])
            for part, lacks in zip(self.parts, lacking, strict=True):
                if lacks:
                    what = f"{self.measure.count} values of {self.budget.measure!r}"
                    part._found = f"{part.budget.measure!r} has no value for {lacks} of {what}"

    def leave_out_bus(self, why: str) -> None:
        """If the budget depends on events of the bus and no value breaks it, it is not judged. why: the reason."""
        for part in self.parts:
            measure = part.measure
            if isinstance(measure, EventMeasure) and Kind.BUS in measure.kinds:
                measure.not_judged = measure.not_judged or why

    def verdict(self, start: int = 0) -> Verdict:
        """Return the verdict of a run that began at tick `start`.

        If no limit is broken, but values were measured on too few occasions, the budget is not judged, so it does not
        pass. If the budget has joined conditions, the result is the verdict of one of `parts`, which `shown` selects.
        Its text `found` then describes all parts.
        """
        if not self.joined:
            return self._judge(start)
        parts = self.parts
        verdicts = [part._judge(start) for part in parts]
        shown = verdicts[parts.index(self.shown)]
        texts = [verdict.found or part._in_words(verdict) for part, verdict in zip(parts, verdicts, strict=True)]
        return replace(shown, name=self.budget.name, why=self.budget.why, found="; ".join(texts))

    @property
    def shown(self) -> BudgetJudge:
        """The judge in `parts` whose verdict is shown.

        This is the first judge whose budget is broken. If no budget is broken, it is the first judge whose budget
        cannot be judged. Otherwise, it is this judge.
        """
        if not self.joined:
            return self
        parts = self.parts
        words = [part._judge(0).verdict for part in parts]
        return next((parts[words.index(word)] for word in (FAIL, NOT_JUDGED) if word in words), self)

    def _judge(self, start: BigInt) -> Verdict:
        measure = self.measure
        limits = [(key, limit) for key, limit in self.plan.limits.items() if self._can_judge(key, limit)]
        silent = measure.silent or not limits
        coverage = self.budget.coverage
        enough = (
            measure.occasions is None
            or measure.measured * coverage.denominator >= coverage.numerator * measure.occasions
        )
        judged = enough and not silent and not measure.not_judged
        found = self._found or measure.refuted or measure.not_judged or (measure.missing() if silent else "")
        if not enough and not found:
            percent = f"{float(100 * coverage):g} %"
            found = f"measured {measure.measured} of {measure.occasions} {measure.asked}, less than {percent}"
        if silent:
            which, limit = next(iter(self.plan.limits.items()))
            slack, value, at = 0, 0, NO_TIME
        else:
            slack, value, at, which, limit = min(
                [(*self._compared(key, limit), key, limit) for key, limit in limits], key=itemgetter(0)
            )
        until = measure.worst_until
        if measure.refuted and slack >= 0:
            at, until = measure.refuted_at, measure.refuted_until
        return Verdict(
            name=self.budget.name,
            measure=self.plan.text,
            unit="us" if measure.unit == "time" else measure.unit,
            worst=None if silent else self.show(value),
            limit=self.show(limit),
            margin=None if silent else self.show(slack),
            count=measure.counted,
            verdict=FAIL if slack < 0 or measure.refuted else PASS if judged else NOT_JUDGED,
            at_s=None if at < 0 else (at - start) / self._timebase.per_second,
            why=self.budget.why,
            which=which,
            found=found,
            measured=measure.measured,
            occasions=measure.occasions,
            until_s=None if until < 0 else (until - start) / self._timebase.per_second,
        )

    def _can_judge(self, which: str, limit: BigInt) -> bool:
        """Return True if the measured values suffice to judge a limit. which: the key of the limit.

        If the end of the run cut off an occurrence, its value is only a lower bound. If all values are lower bounds,
        they do not suffice to judge `min`. They suffice to judge `exactly` only if the largest value exceeds the limit.
        """
        measure = self.measure
        if measure.count > measure.cut_off or not measure.series:
            return True
        return which not in ("min", "exactly") or (which == "exactly" and measure.worst > limit)

    def typical(self, start: int = 0) -> Verdict | None:
        """Return the verdict with the least critical value: for `min`, the largest; for other limits, the smallest.

        Return None if the measure has fewer than two values, or one number for the whole run.
        """
        part = self.shown
        measure, worst = part.measure, self.verdict(start)
        low = worst.which == "min"
        value, at = (measure.worst, measure.worst_at) if low else (measure.least, measure.least_at)
        if worst.worst is None or not measure.series or measure.count < 2 or at < 0:
            return None
        return replace(worst, worst=part.show(value), at_s=float(self._timebase.seconds(at - start)), margin=None)

    def values(self, start: int) -> Values | None:
        """Return the values that the measure stored, or None if there are none.

        For a budget with joined conditions, return the values of the judge `shown`.
        start: the tick at which the run began; the ticks of the values count from it.
        """
        shown = self.shown
        kept = shown.measure.kept
        if kept is None or not len(kept[0]):
            return None
        values, at = kept
        return Values(shown.measure.unit, values, at - start, shown.plan.limits)

    def _in_words(self, verdict: Verdict) -> str:
        """Return the measure, the worst value and the limit as text: "age 22.153 ms at 0.025195 s (max 25 ms)"."""
        value = f"{verdict.worst} {verdict.unit}"
        if verdict.unit == "us" and verdict.worst is not None:
            value = self._timebase.show(round(verdict.worst * self._timebase.per_second / 1_000_000))
        at = "" if verdict.at_s is None else f" at {verdict.at_s:.6f} s"
        return f"{self.budget.measure} {value}{at} ({verdict.which} {self.budget.limits()[verdict.which]})"

    def _compared(self, which: str, limit: BigInt) -> tuple[BigInt, BigInt, int]:
        """Compare a limit with the value that is most critical for it. which: the key of the limit.

        Return the distance from the value to the limit, which is negative if the limit is broken, the value, and the
        tick of the value.
        """
        measure = self.measure
        if which == "max":
            return limit - measure.worst, measure.worst, measure.worst_at
        if which == "min":
            return measure.least - limit, measure.least, measure.least_at
        if which == "exactly":
            over, under = measure.worst - limit, limit - measure.least
            if over >= under:
                return -abs(over), measure.worst, measure.worst_at
            return -abs(under), measure.least, measure.least_at
        assert measure.tally is not None
        value, at = measure.tally.percentile(PER_MILLE[which])
        return limit - value, value, at

    def show(self, value: BigInt) -> float | int:
        """Convert a value of the measure to the unit of verdicts, for example ticks to microseconds."""
        if self.measure.unit == "%":
            return value * 100 / MILLIONTHS
        if self.measure.unit == "LSB":
            return value / MILLIONTHS
        if self.measure.unit != "time":
            return value
        tenths, rest = divmod(value * 10_000_000_000, self._timebase.per_second)  # tenths of a nanosecond
        middle = 2 * rest - self._timebase.per_second
        return (tenths + (middle > 0 or (middle == 0 and tenths % 2))) / 10_000  # half a tenth is rounded to even


def combine(measures: list[Measure]) -> list[int]:
    """Drop the values of joined measures at occurrences at which the first measure has no value.

        age            a   b       c    d            the first measure determines which occurrences count
        value error    a   b   x        d   y        x and y are dropped; the value at c is missing: nothing is proven

    Occurrences are the same if they begin at the same tick. All measures must store their values (`Measure.keep`).
    Return one number for each measure: the number of occurrences of the first measure at which this measure has no
    value. If this number is not 0, all values of this measure are dropped.
    """
    import numpy as np  # imported here, because only joined conditions need it

    _, wanted = measures[0].all_kept()
    lacking = [0]
    measure: Measure
    for measure in measures[1:]:
        _, at = measure.all_kept()
        lacking.append(int((~np.isin(wanted, at)).sum()))
        there = np.flatnonzero(np.isin(at, wanted))
        measure.only(there[:0] if lacking[-1] else there)
    return lacking
