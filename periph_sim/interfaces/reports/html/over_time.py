"""The values of a budget over the run, reduced to the resolution of a screen; up to MOST values beyond a limit are kept
with their instants.

    columns   | .   .      |          a column has the least and the greatest value of its part of the run,
              |   .   : .  | .        so a single outlier is visible
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....timing.values import Values
from ....timing.verdict import Verdict

COLUMNS = 240
MOST = 2_000  # maximum number of violations that are kept with their instants
SHOWN = 6  # violations besides the worst that get waves
PARTS = SHOWN - SHOWN // 2


@dataclass(frozen=True)
class Column:
    """One part of the run.

    at: its begin, in ticks from the start of the run.
    low, high: the least and the greatest value in this part.
    beyond: True if some of its values are beyond a limit.
    """

    at: int
    low: int
    high: int
    beyond: bool = False


@dataclass(frozen=True)
class OverTime:
    """The values of a budget over the run, in the unit of `Values`.

    end: the end of the run, in ticks from its start.
    which: the limit that the verdict names.
    violations: instant and value of the first MOST violations, in order of time.
    """

    unit: str
    end: int
    columns: tuple[Column, ...]
    limits: tuple[tuple[str, int], ...]
    which: str
    violations: tuple[tuple[int, int], ...]
    violation_count: int
    count: int


def over_time(values: Values, verdict: Verdict, end: int) -> OverTime:
    """Return the values over time. end: the end of the run, in ticks from its start."""
    order = np.argsort(values.at, kind="stable")
    at, data = values.at[order], values.values[order]
    beyond = _beyond(data, verdict, values.limits)
    wrong = np.flatnonzero(beyond)
    return OverTime(
        unit=values.unit,
        end=end,
        columns=tuple(_columns(at, data, beyond, end)),
        limits=tuple(values.limits.items()),
        which=verdict.which,
        violations=tuple((int(at[n]), int(data[n])) for n in wrong[:MOST]),
        violation_count=len(wrong),
        count=len(data),
    )


def _beyond(data: NDArray[np.int64], verdict: Verdict, limits: Mapping[str, int]) -> NDArray[np.bool_]:
    """Mark values beyond a limit; for a percentile's limit only if it is broken."""
    found = np.zeros(len(data), bool)
    for key, limit in limits.items():
        if key == "min":
            found |= data < limit
        elif key == "exactly":
            found |= data != limit
        elif key == "max" or (verdict.broken and key == verdict.which):
            found |= data > limit
    return found


def _columns(at: NDArray[np.int64], data: NDArray[np.int64], beyond: NDArray[np.bool_], end: int) -> list[Column]:
    if len(at) <= COLUMNS:
        return [Column(t, v, v, b) for t, v, b in zip(at.tolist(), data.tolist(), beyond.tolist(), strict=True)]
    of = np.minimum(at * COLUMNS // max(end, 1), COLUMNS - 1)
    firsts = np.flatnonzero(np.diff(of, prepend=-1))
    low, high = np.minimum.reduceat(data, firsts), np.maximum.reduceat(data, firsts)
    some = np.logical_or.reduceat(beyond, firsts)
    middles = (2 * of[firsts] + 1) * end // (2 * COLUMNS)
    found = zip(middles.tolist(), low.tolist(), high.tolist(), some.tolist(), strict=True)
    return [Column(*one) for one in found]


def shown_violations(over: OverTime, worst_at: int) -> tuple[tuple[int, int], ...]:
    """Choose the violations besides the worst to show with waves: the first ones, then the worst of each part of the
    rest, SHOWN in all, in order of time."""
    others = [one for one in over.violations if one[0] != worst_at]
    first, rest = others[: SHOWN // 2], others[SHOWN // 2 :]
    parts = [rest[n * len(rest) // PARTS : (n + 1) * len(rest) // PARTS] for n in range(PARTS)]
    pick = min if over.which == "min" else max
    return (*first, *(pick(part, key=lambda one: one[1]) for part in parts if part))
