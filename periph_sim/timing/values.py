"""All values that budgets measured, not only the worst, as arrays.

    Scene(case, keep_values=True) --run--> limits --values_of--> Values each

A value takes two int64. Measures that give one number a run (counts, loads) have none.
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

    values: int64[n], ticks where unit is "time", millionths where it is "LSB", else counts. at: int64[n], ticks from
    the run's begin.
    limits: the budget's, by key, in the same unit.
    """

    unit: str
    values: NDArray[np.int64]
    at: NDArray[np.int64]
    limits: dict[str, int]


def values_of(limits: Iterable[BudgetJudge], start: int) -> list[Values | None]:
    """Return the values that each limit's measure kept, None if there are none. start: the tick at which the run began.

    Of joined conditions, the values of the one that the verdict shows.
    """
    return [_values(limit, start) for limit in limits]


def _values(limit: BudgetJudge, start: int) -> Values | None:
    shown = limit.shown
    kept = shown.measure.kept
    if kept is None or not len(kept[0]):
        return None
    values, at = kept
    return Values(shown.measure.unit, values, at - start, shown.limits)
