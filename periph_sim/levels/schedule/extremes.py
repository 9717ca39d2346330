"""Worst and least values per scenario: values of some scenarios go in, int64[scenarios] come out."""

from __future__ import annotations

import numpy as np

from .clock import IntOrInts, Ints

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

    def take_rows(self, scenarios: Ints, rows: Ints) -> None:
        """Values of each of these scenarios, int64[values, scenarios]."""
        self.worst[scenarios] = np.maximum(self.worst[scenarios], rows.max(axis=0))
        self.least[scenarios] = np.minimum(self.least[scenarios], rows.min(axis=0))
        self.count[scenarios] += len(rows)

    def take_unfinished(self, scenarios: Ints, values: Ints) -> None:
        """What each has come to as the run ends: it counts where it is more than any before, and is no least value."""
        more = values > self.worst[scenarios]
        who, values = scenarios[more], values[more]
        alone = self.least[who] == np.iinfo(np.int64).max
        self.worst[who] = values
        self.least[who[alone]] = values[alone]
        self.count[who] += 1

    def take_all(self, values: IntOrInts, but: Ints) -> None:
        """A value of each scenario but of these, which others count."""
        self.take_range(values, values, but)

    def take_range(self, worst: IntOrInts, least: IntOrInts, but: Ints) -> None:
        """The largest and the smallest of some values of each scenario but of these."""
        kept = self.worst[but], self.least[but]
        np.maximum(self.worst, worst, out=self.worst)
        np.minimum(self.least, least, out=self.least)
        self.worst[but], self.least[but] = kept
