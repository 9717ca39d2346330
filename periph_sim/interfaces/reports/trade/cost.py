"""The CPU time of a row of a comparison, as the median of several runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from statistics import quantiles


@dataclass(frozen=True)
class Cost:
    """The CPU time of a row.

    cpu_s: CPU seconds per simulated second, the median of all runs.
    spread_s: the interquartile range divided by the square root of the number of runs. This is about the standard error
        of the median.
    runs: the number of runs.
    """

    cpu_s: float
    spread_s: float
    runs: int

    def is_below(self, other: Cost) -> bool:
        """Return True if this cost is lower than another cost by more than the sum of both spreads."""
        return other.cpu_s - self.cpu_s > self.spread_s + other.spread_s

    @property
    def cells(self) -> tuple[str, str]:
        """The cells of a table row: the cost and its spread in percent."""
        return f"{self.cpu_s:.3g}", f"{self.spread_s / self.cpu_s:.1%}"


def cost_of(seconds: Sequence[float]) -> Cost:
    """Return the cost of runs that took these CPU seconds per simulated second."""
    low, median, high = quantiles(seconds, n=4, method="inclusive")
    return Cost(median, (high - low) / sqrt(len(seconds)), len(seconds))
