"""The case's limits beside its bounds: budgets and bounds go in; by how much each limit is kept, or not, comes out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..timing.budgets import Limit
from .terms import Bound

ONE_SIDED = "'exactly' needs a bound from either side"
NO_FORM = "no closed form"


@dataclass(frozen=True)
class LimitCheck:
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


def compare_with_limits(limits: Iterable[Limit], bounds: Sequence[Bound]) -> tuple[LimitCheck, ...]:
    """Every limit of these budgets and of the conditions joined to them, in their order."""
    return tuple(
        _check(part, key, ticks, bounds)
        for limit in limits
        for part in limit.parts
        for key, ticks in part.limits.items()
    )


def _check(part: Limit, key: str, ticks: int, bounds: Sequence[Bound]) -> LimitCheck:
    """A percentile is limited from above, so what bounds every value bounds it."""
    measure = part.budget.measure
    known = [bound for bound in bounds if bound.measure == measure]
    fitting = next((bound for bound in known if bound.least == (key == "min") and key != "exactly"), None)
    if fitting is None:
        return LimitCheck(
            part.budget.name, measure, key, ticks, None, ONE_SIDED if key == "exactly" and known else NO_FORM
        )
    why = fitting.unproven
    return LimitCheck(part.budget.name, measure, key, ticks, None if why else fitting, why, bool(why))
