"""Worst and least values per scenario: values of some scenarios go in, int64[scenarios] come out."""

from __future__ import annotations

import numpy as np

from .clock import Ints

NO_VALUE = np.iinfo(np.int64).min


class Extremes:
    """worst, least: NO_VALUE where there was no value. count: of values."""

    def __init__(self, scenarios: int) -> None:
        self.worst = np.full(scenarios, NO_VALUE, np.int64)
        self.least = np.full(scenarios, np.iinfo(np.int64).max, np.int64)
        self.count = np.zeros(scenarios, np.int64)

    def take(self, scenarios: Ints, values: Ints) -> None:
        """A value of each of these scenarios, none of which is named twice."""
        self.worst[scenarios] = np.maximum(self.worst[scenarios], values)
        self.least[scenarios] = np.minimum(self.least[scenarios], values)
        self.count[scenarios] += 1
