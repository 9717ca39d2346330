"""Plans of a case's budgets, and a scene's judges, which take the measured values and return verdicts.

Case, Scope --> BudgetPlan of each budget, shared by all scenes of the case --> BudgetJudge of each, for one scene
"""

from __future__ import annotations

from collections.abc import Sequence

from ..core.time import Timebase
from ..timing.budget_plan import BadBudget, BudgetPlan, plan_of
from ..timing.budgets import BudgetJudge
from ..timing.language.scope import Scope
from .case.model import Case
from .context import CaseTicks


def limit_plans(ticks: CaseTicks, scope: Scope) -> tuple[BudgetPlan, ...]:
    """Return the plan of each budget, in the order of the case.

    Raise BadCase, with its line, for an invalid budget, or if two budgets have the same name.
    """
    case = ticks.case
    found: list[BudgetPlan] = []
    names: set[str] = set()
    for entry, budget in enumerate(case.budget):
        if budget.name in names:
            what = f"there are two budgets {budget.name!r}; verdicts are known by name, so give one another name"
            raise case.mistake(what, "budget", entry, "name")
        names.add(budget.name)
        try:
            found.append(plan_of(budget, ticks.timebase, scope, ticks.start, found))
        except BadBudget as error:
            raise case.mistake(str(error), "budget", entry, *error.place) from None
    return tuple(found)


def limits_of(case: Case, plans: Sequence[BudgetPlan], timebase: Timebase) -> list[BudgetJudge]:
    """Return a judge for each budget, in the order of the case."""
    judges: list[BudgetJudge] = []
    for budget, plan in zip(case.budget, plans, strict=True):
        judges.append(BudgetJudge(budget, timebase, plan, judges))
    return judges
