"""Judges of budgets without a scene."""

from __future__ import annotations

from collections.abc import Sequence

from periph_sim.core.time import Timebase
from periph_sim.timing.budget_plan import plan_of
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.budgets import BudgetJudge
from periph_sim.timing.language.scope import Scope

TIMEBASE = Timebase(150_000_000)


def judge(budget: Budget, scope: Scope | None = None, start: int = 0) -> BudgetJudge:
    """BadBudget where it cannot be judged."""
    return BudgetJudge(budget, TIMEBASE, plan_of(budget, TIMEBASE, scope, start))


def judges(budgets: Sequence[Budget], scope: Scope) -> list[BudgetJudge]:
    """Those of one scene."""
    plans, found = [], []
    for budget in budgets:
        plans.append(plan_of(budget, TIMEBASE, scope, 0, plans))
        found.append(BudgetJudge(budget, TIMEBASE, plans[-1], found))
    return found
