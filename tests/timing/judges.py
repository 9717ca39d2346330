"""Judges of budgets, made without a scene."""

from __future__ import annotations

from collections.abc import Sequence

from periph_sim.core.time import Timebase
from periph_sim.timing.budget_plan import plan_of
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.budgets import BudgetJudge
from periph_sim.timing.language.scope import Scope
from periph_sim.timing.verdict import Verdict
from tests.timing.events_by_hand import ONE

TIMEBASE = Timebase(150_000_000)
US = 3000  # ticks, with SYSCLKOUT at 150 MHz


def judge(budget: Budget, scope: Scope | None = None, start: int = 0) -> BudgetJudge:
    """Return the judge of a budget. Raise BadBudget if the budget cannot be judged."""
    return BudgetJudge(plan_of(budget, TIMEBASE, scope, start), TIMEBASE)


def limit(measure: str, scope: Scope = ONE, start: int = 0, **limits: str | int) -> BudgetJudge:
    """Return the judge of a budget with these limits. Raise BadBudget if they do not fit the measure."""
    return judge(Budget(name="b", measure=measure, **limits), scope, start)


def judges(budgets: Sequence[Budget], scope: Scope) -> list[BudgetJudge]:
    """Return the judges of these budgets, which belong to one scene."""
    plans, found = [], []
    for budget in budgets:
        plans.append(plan_of(budget, TIMEBASE, scope, 0, plans))
        found.append(BudgetJudge(plans[-1], TIMEBASE, found))
    return found


def judged(of: BudgetJudge, *values_us: float) -> Verdict:
    """Return the verdict of a budget whose measure takes these values, one per second."""
    for n, value in enumerate(values_us):
        of.measure.take(round(value * US), n * 1_000_000 * US)
    return of.verdict()
