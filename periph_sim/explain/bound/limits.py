"""The case's limits beside its bounds: budgets and bounds go in; by how much each limit is kept, or not, comes out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

from msgspec import Struct

from ...timing.budget_plan import PER_MILLE
from ...timing.budget_schema import Budget, Condition
from ...timing.budgets import BudgetJudge
from .terms import Bound

ONE_SIDED = "'exactly' needs the smallest value and the largest"
NO_FORM = "no closed form is known"
OTHER_SIDE = {False: "only the largest value is calculated", True: "only the smallest value is calculated"}
OF_DATA = {"wrong bytes": "bytes are data, not times"}


class LimitCheck(Struct, frozen=True):
    """One limit of a budget, `key` being its key, and what bounds it. bound: None where nothing does, `reason` is why.

    limit: in ticks, or as the budget counts. unproven: there is a closed form, with a term that is no bound.
    """

    budget: str
    measure: str
    key: str
    limit: int
    bound: Bound | None
    reason: str = ""
    unproven: bool = False

    @property
    def spare(self) -> int | None:
        """What is left before the limit at any phase; negative where the bound is beyond it."""
        if self.bound is None:
            return None
        return self.bound.ticks - self.limit if self.bound.least else self.limit - self.bound.ticks

    @property
    def beyond(self) -> bool:
        return self.spare is not None and self.spare < 0


def compare_with_limits(limits: Iterable[BudgetJudge], bounds: Sequence[Bound]) -> tuple[LimitCheck, ...]:
    """Every limit of these budgets and of the conditions joined to them, in their order."""
    return tuple(
        _check(part, key, ticks, bounds)
        for limit in limits
        for part in limit.parts
        for key, ticks in part.limits.items()
    )


def fitting_bound(budget: Budget | Condition, key: str, bounds: Iterable[Bound]) -> Bound | None:
    """What bounds that which a limit's key limits, the tightest first; None if nothing does.

    A percentile is limited from above, so what bounds every value bounds it; and so does what bounds enough of them.
    """
    whole = getattr(budget, "after", None) is None  # counted from the start of the run
    asked = Fraction(PER_MILLE[key], 1000) if key in PER_MILLE and whole else Fraction(1)
    known = [b for b in bounds if b.measure == budget.measure and b.least == (key == "min") and b.part >= asked]
    return min(known, key=lambda bound: bound.part, default=None) if key != "exactly" else None


def _check(part: BudgetJudge, key: str, ticks: int, bounds: Sequence[Bound]) -> LimitCheck:
    measure = part.budget.measure
    known = [bound for bound in bounds if bound.measure == measure]
    fitting = fitting_bound(part.budget, key, bounds)
    if fitting is None:
        if known:
            reason = ONE_SIDED if key == "exactly" else OTHER_SIDE[known[0].least]
        else:
            reason = OF_DATA.get(measure, NO_FORM)
        return LimitCheck(part.budget.name, measure, key, ticks, None, reason)
    why = fitting.unproven
    return LimitCheck(part.budget.name, measure, key, ticks, None if why else fitting, why, bool(why))
