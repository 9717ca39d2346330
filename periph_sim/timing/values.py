"""All values that budgets measured, not only the worst, as arrays.

    Scene(case, keep_values=True) --run--> limits --values_of--> Values each

Each value takes the memory of two int64. Measures that are one number a run (counts, loads) have no values.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .budgets import BudgetJudge


@dataclass(frozen=True, eq=False)
class Values:
    """Values of one budget's measure, in the order in which they were taken.

    values: int64[n], in ticks if `unit` is "time", in millionths if it is "LSB", else counts.
    at: int64[n], the tick of each value, counted from the begin of the run.
    limits: the limits of the budget in the same unit, indexed by key.
    """

    unit: str
    values: NDArray[np.int64]
    at: NDArray[np.int64]
    limits: dict[str, int]


def values_of(limits: Iterable[BudgetJudge], start: int) -> list[Values | None]:
    """Return the values that each budget's measure stored, or None for a budget without values.

    For joined conditions, return the values of the condition that the verdict shows.
    start: the tick at which the run began.
    """
    return [_values(limit, start) for limit in limits]


def _values(limit: BudgetJudge, start: int) -> Values | None:
    shown = limit.shown
    kept = shown.measure.kept
    if kept is None or not len(kept[0]):
        return None
    values, at = kept
    return Values(shown.measure.unit, values, at - start, shown.limits)
