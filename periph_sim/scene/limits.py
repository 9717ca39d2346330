"""A case's budgets as judges: a case goes in; what takes values and says verdicts comes out."""

from __future__ import annotations

from ..core.time import Timebase
from ..timing.budgets import BadBudget, BudgetJudge
from ..timing.language.scope import Scope
from .case.model import Case


def limits_of(case: Case, scope: Scope, timebase: Timebase, start: int) -> list[BudgetJudge]:
    """One of each budget, in their order. scope: of the case. start: the tick at which the run begins.

    BadCase, with its line, for a budget that is none, or has the name of another.
    """
    found: list[BudgetJudge] = []
    names: set[str] = set()
    for entry, budget in enumerate(case.budget):
        if budget.name in names:
            what = f"there are two budgets {budget.name!r}; verdicts are known by name, so give one another name"
            raise case.mistake(what, "budget", entry, "name")
        names.add(budget.name)
        try:
            found.append(BudgetJudge(budget, timebase, scope, start, found))
        except BadBudget as error:
            raise case.mistake(str(error), "budget", entry, *error.place) from None
    return found
