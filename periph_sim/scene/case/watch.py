"""Watched wires of a case: [watch.NAME] defines the expected edges; a budget of measure watch:NAME judges them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...core.table import Table
from ...timing.budget_schema import WATCH, Budget
from .scalars import Length
from .serial import in_words


class WatchTable(Table, frozen=True, kw_only=True):
    """A watcher of a wire. kind: a name in `devices.watchers`. Each kind adds keys of its own."""

    OTHERS = "own"

    kind: str
    wire: str
    tolerance: Length
    why: str = ""
    own: dict[str, Any] = {}  # the keys that its kind adds


def with_watches(budgets: tuple[Budget, ...], watches: Mapping[str, WatchTable]) -> tuple[Budget, ...]:
    """Return the budgets of a case, and one more for each watched wire that has no budget of its name."""
    known = {(budget.name, budget.measure) for budget in budgets}
    return budgets + tuple(watch_budget(*one) for one in watches.items() if (one[0], WATCH + one[0]) not in known)


def watch_budget(name: str, watch: WatchTable) -> Budget:
    return Budget(name=name, measure=WATCH + name, max=in_words(watch.tolerance), why=watch.why)
