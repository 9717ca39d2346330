"""Plans of budgets. A plan contains the function that makes the budget's measure, and the checked limits as numbers.

    Budget, Scope --> BudgetPlan --> BudgetJudge, one in each scene

A run does not change a plan, so all scenes of one case share it. `make` returns a new measure for each scene.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import combinations

from msgspec import Struct

from ..core.exact_number import exact_number
from ..core.table import duration, share
from ..core.time import NO_TIME, Timebase, TimeError, round_ratio
from .budget_schema import Budget
from .language.scope import BadEvent, Scope
from .measures.event import EventMeasure
from .measures.factory import expanded, maker_of
from .measures.measure import MILLIONTHS, Measure

PER_MILLE = {"p50": 500, "p95": 950, "p99": 990, "p99_9": 999}
WANTED = {"%": "a part of the time; write for instance '40 %'", "LSB": "in LSB; write for instance '2.5 LSB'"}
SIGNED = ("value", "cycles")  # units of whole numbers that may be negative


class BadBudget(ValueError):
    """Error: the measure of a budget does not exist, or the limits do not fit the measure or each other.

    The message is one sentence. place: the keys and indices that lead from the budget's table to the wrong value.
    """

    def __init__(self, what: str, *place: str | int) -> None:
        super().__init__(what)
        self.place = place


class BudgetPlan(Struct, frozen=True):
    """Plan for measuring and judging one budget in a scene.

    text: the text of the measure, in which the names of other measures are replaced by their texts.
    make: a function that returns a new measure.
    limits: the limits of the budget in ticks, millionths or counts.
    not_before: the tick of the key `after` of the budget. Occurrences that began earlier are left out. NO_TIME if no
        occurrence is left out.
    joined: the plans of the conditions under the key `and`.
    same_as: the index of the first earlier budget that has the same measure and the same `not_before`; -1 if there is
        none. A budget with joined conditions is the same as no other.
    """

    budget: Budget
    text: str
    make: Callable[[], Measure]
    limits: dict[str, int]
    not_before: int
    joined: tuple[BudgetPlan, ...]
    same_as: int


def plan_of(
    budget: Budget,
    timebase: Timebase,
    scope: Scope | None = None,
    start: int = 0,
    others: Sequence[BudgetPlan] = (),
) -> BudgetPlan:
    """Return the plan of a budget.

    Raise BadBudget if the budget cannot be judged, or if `after` has too many ticks.

    scope: the names that a measure of events may contain. start: the tick at which the run begins. others: the plans of
    the earlier budgets in the same scene.
    """
    scope = scope or Scope()
    try:
        text = expanded(budget.measure, scope.measures)
        make = maker_of(text, scope)
    except BadEvent as error:
        raise BadBudget(str(error), "measure") from None
    measure = make()
    limits = {key: _limit(budget, measure, timebase, key, limit) for key, limit in budget.limits().items()}
    _check(budget, measure, limits)
    not_before = NO_TIME
    if budget.after is not None:
        if not measure.series:
            raise BadBudget(f"{budget.measure!r} is one number a run, so none of it can be left out", "after")
        try:
            not_before = start + timebase.ticks(budget.after, "nearest")
        except TimeError as error:
            raise BadBudget(str(error), "after") from None
    joined = tuple(_joined(budget, measure, entry, timebase, scope, start) for entry in range(len(budget.also)))
    same = (  # a budget with joined conditions never shares its measure
        place
        for place, other in enumerate(others)
        if other.same_as < 0 and (other.text, other.not_before) == (text, not_before) and not (joined or other.joined)
    )
    return BudgetPlan(budget, text, make, limits, not_before, joined, next(same, -1))


def _joined(
    budget: Budget, measure: Measure, entry: int, timebase: Timebase, scope: Scope | None, start: int
) -> BudgetPlan:
    """Return the plan of a condition under the budget's key `and`, as that of a budget of its own.

    measure: the measure of the budget. entry: the index of the condition.

    Raise BadBudget if the condition cannot be judged, or if one of the two measures does not take one value for each
    addressed phase (`Measure.occurrence`).
    """
    given = budget.also[entry]
    table = {"name": f"{budget.name} and {given.measure}", "measure": given.measure, **given.limits()}
    condition = Budget.model_validate(table)
    try:
        part = plan_of(condition, timebase, scope, start)
    except BadBudget as error:
        raise BadBudget(str(error), "and", entry, *error.place) from None
    places: tuple[tuple[str | int, ...], ...] = ("measure",), ("and", entry, "measure")
    for of, each, place in zip((budget, condition), (measure, part.make()), places, strict=True):
        if not each.occurrence or each.occurrence != measure.occurrence:
            what = f"{of.measure!r} is not measured read by read, so nothing can be joined to it; "
            raise BadBudget(f"{what}age, model age, stretch and value error are", *place)
    return part


def _limit(budget: Budget, measure: Measure, timebase: Timebase, which: str, given: str | int) -> int:
    """Return a limit as a whole number of ticks, millionths or counts, according to the unit of the measure.

    which: the key of the limit. given: the limit as written in the table: a share as "40 %", a value in LSB as 2 or
    "2.5 LSB". Raise BadBudget if the limit has another unit than the measure, or if the limit is negative although
    values of the measure cannot be negative.
    """
    unit = measure.unit
    try:
        if unit == "time":
            return _nearest_tick(given, timebase.per_second)
        if unit == "%":
            return round(share(given) * MILLIONTHS)
        if unit == "LSB":
            text = str(given)
            steps = exact_number(text.removesuffix("LSB"))
            if steps >= 0 and (isinstance(given, int) or text.endswith("LSB")):
                return round(steps * MILLIONTHS)
        elif isinstance(given, int):
            is_signed = unit in SIGNED or (isinstance(measure, EventMeasure) and measure.weighs)
            if is_signed or given >= 0:
                return given
    except ValueError as error:
        if unit == "time":
            raise BadBudget(str(error), which) from None
    counted = "a number" if unit in ("count", "value") else f"a number of {unit}"
    wanted = "never negative; write 0 or more" if isinstance(given, int) else f"{counted}; write a whole number"
    raise BadBudget(f"{given!r}, but {budget.measure!r} is {WANTED.get(unit, wanted)}", which)


def _check(budget: Budget, measure: Measure, limits: dict[str, int]) -> None:
    """Raise BadBudget for limits that do not fit the measure, that no run can keep, or that are redundant."""
    given = budget.limits()
    others = [key for key in limits if key != "exactly"]
    if "exactly" in limits and others:
        raise BadBudget(f"exactly says all that {' and '.join(others)} could; leave one of them out", "exactly")
    percentiles = [key for key in PER_MILLE if key in limits]
    if percentiles and not measure.series:
        key = percentiles[0]
        raise BadBudget(f"{budget.measure!r} is one number a run and has no percentiles; write max", key)
    in_order = [key for key in ("min", *percentiles, "max") if key in limits]
    for low, high in combinations(in_order, 2):
        if limits[low] > limits[high]:
            why, remedy = "which says more already", f"lower {low} or leave it out"
            if low == "min":
                why, remedy = "so no run can keep both", f"raise {high} or lower min"
            elif high == "max":
                why = "which no value may exceed"
            raise BadBudget(f"{low} {given[low]} is above {high} {given[high]}, {why}; {remedy}", low)
    if isinstance(measure, EventMeasure) and measure.proves_no_zero:
        for key in limits:
            if key != "min" and limits[key] == 0:
                what = "a span's name is free text, so that none was seen proves nothing"
                raise BadBudget(f"{what}; limit what the run does instead", key)


@lru_cache(maxsize=1024)  # the scenes of one case repeat the same limits
def _nearest_tick(given: str | int, per_second: int) -> int:
    """Return a duration in ticks, rounded to nearest. Raise ValueError if the text is not a duration."""
    return round_ratio(duration(given) * per_second, "nearest")
