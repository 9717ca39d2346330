"""Judges of a case's budgets: they take values and return verdicts.

Case, Scope --plans, kept for the next scene--> BudgetJudge of each budget
"""

from __future__ import annotations

from msgspec import Struct

from ..core.time import Timebase
from ..timing.budget_plan import BadBudget, BudgetPlan, plan_of
from ..timing.budget_schema import Budget
from ..timing.budgets import BudgetJudge
from ..timing.language.scope import Scope
from .case.model import Case

KEPT = 8  # number of cases whose plans are kept


class _Planned(Struct, frozen=True):
    """The plans of budgets, and everything that they were made of."""

    budgets: tuple[Budget, ...]
    scope: Scope
    per_second: int
    start: int
    plans: tuple[BudgetPlan, ...]

    def fits(self, budgets: tuple[Budget, ...], scope: Scope, per_second: int, start: int) -> bool:
        return (
            (per_second, start) == (self.per_second, self.start)
            and budgets == self.budgets
            and scope == self.scope
            and scope.pairs == self.scope.pairs
        )


_planned: list[_Planned] = []  # cached plans, the latest first; they can be reused since no run changes them


def limits_of(case: Case, scope: Scope, timebase: Timebase, start: int) -> list[BudgetJudge]:
    """Return a judge for each budget, in the order of the case. start: the tick at which the run begins.

    Raise BadCase, with its line, for an invalid budget, or if two budgets have the same name.
    """
    judges: list[BudgetJudge] = []
    for budget, plan in zip(case.budget, _plans(case, scope, timebase, start), strict=True):
        judges.append(BudgetJudge(budget, timebase, plan, judges))
    return judges


def _plans(case: Case, scope: Scope, timebase: Timebase, start: int) -> tuple[BudgetPlan, ...]:
    """Return the plans of budgets, from the cache if they are in it.

    They are not cached if they refer to variables of an image, since its file may change.
    """
    if scope.images:
        return _made(case, scope, timebase, start)
    for known in tuple(_planned):
        if known.fits(case.budget, scope, timebase.per_second, start):
            return known.plans
    plans = _made(case, scope, timebase, start)
    _planned.insert(0, _Planned(case.budget, scope, timebase.per_second, start, plans))
    del _planned[KEPT:]
    return plans


def _made(case: Case, scope: Scope, timebase: Timebase, start: int) -> tuple[BudgetPlan, ...]:
    found: list[BudgetPlan] = []
    names: set[str] = set()
    for entry, budget in enumerate(case.budget):
        if budget.name in names:
            what = f"there are two budgets {budget.name!r}; verdicts are known by name, so give one another name"
            raise case.mistake(what, "budget", entry, "name")
        names.add(budget.name)
        try:
            found.append(plan_of(budget, timebase, scope, start, found))
        except BadBudget as error:
            raise case.mistake(str(error), "budget", entry, *error.place) from None
    return tuple(found)
