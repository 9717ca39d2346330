"""CPU time of rows after the start of their scenes, repeated until the rows differ significantly."""

from __future__ import annotations

import gc
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import sqrt
from statistics import quantiles
from time import process_time

from ....scene.case.model import Case
from .observe import built

FEWEST, MOST = 5, 15  # minimum and maximum number of runs of each row
PATIENCE = 20.0  # seconds of CPU time after which repeating stops


@dataclass(frozen=True)
class Cost:
    """The CPU time of a row.

    cpu_s: CPU seconds per simulated second, the median of all runs.
    spread_s: the interquartile range divided by the square root of the number of runs, which is about the standard
    error of the median.
    """

    cpu_s: float
    spread_s: float
    runs: int

    def is_below(self, other: Cost) -> bool:
        """True if this one is cheaper by more than both spreads."""
        return other.cpu_s - self.cpu_s > self.spread_s + other.spread_s


def costs_of(rows: Mapping[str, tuple[Case, str]], start: Fraction, length: Fraction) -> dict[str, Cost]:
    """Return the cost of each row, by name. Each pass runs every row once, so that changes of load affect all rows.

    rows: the case of each row, and the suffix of its recording or "".
    start: simulated seconds that are not counted. length: the simulated seconds after them, which are counted.
    """
    seconds: dict[str, list[float]] = {name: [] for name in rows}
    began = process_time()
    while True:
        for name, (case, record) in rows.items():
            seconds[name].append(_cpu_s(case, record, start, length))
        runs = len(next(iter(seconds.values())))
        if runs >= FEWEST:
            costs = {name: _cost(found) for name, found in seconds.items()}
            if are_apart([*costs.values()]) or runs >= MOST or process_time() - began > PATIENCE:
                return costs


def are_apart(costs: Sequence[Cost]) -> bool:
    """Return True if any two differ by more than their spreads."""
    return all(one.is_below(other) for one, other in pairwise(sorted(costs, key=lambda cost: cost.cpu_s)))


def _cpu_s(case: Case, record: str, start: Fraction, length: Fraction) -> float:
    with built(case, record) as scene:
        scene.advance(scene.start + scene.timebase.ticks(start, "nearest"))
        gc.collect()
        began = process_time()
        scene.run(length)
    return (process_time() - began) / float(length)


def _cost(seconds: Sequence[float]) -> Cost:
    low, median, high = quantiles(seconds, n=4, method="inclusive")
    return Cost(median, (high - low) / sqrt(len(seconds)), len(seconds))
