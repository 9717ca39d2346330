"""History of the SYSCLKOUT frequency of a unit, read from a recording."""

from __future__ import annotations

from bisect import bisect_right
from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.phrases import counted

MAX_LISTED = 3  # maximum number of frequencies that `in_words` lists


class ClockHistory(NamedTuple):
    """The successive SYSCLKOUT frequencies of a unit during a run. Each frequency is called a clock here.

    begins: for each clock, the tick from which the clock is in effect.
    periods: for each clock, the length of a cycle in ticks.
    """

    begins: tuple[int, ...]
    periods: tuple[Fraction, ...]

    def at(self, tick: int) -> Fraction:
        return self.periods[max(bisect_right(self.begins, tick) - 1, 0)]

    def cycles(self, begin: int, end: int) -> int:
        """Return the number of cycles from tick `begin` to tick `end`, rounded to the nearest integer.

        The number is negative if `end` is earlier than `begin`.
        """
        if end < begin:
            return -self.cycles(end, begin)
        inside = [begin, *(tick for tick in self.begins if begin < tick < end), end]
        return round(sum((after - before) / self.at(before) for before, after in pairwise(inside)))

    def of_distances(self, ticks: NDArray[np.int64], at: NDArray[np.int64]) -> NDArray[np.int64]:
        """Convert distances in ticks to the nearest numbers of cycles.

        at: for each distance, a tick; the clock in effect at this tick is used.
        """
        periods = np.array([float(period) for period in self.periods])
        cycles: NDArray[np.int64] = (ticks / periods[self._now(at)] + 0.5).astype(np.int64)
        return cycles

    def ticks_of(self, cycles: int, at: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the length of `cycles` cycles in ticks, rounded down, for the clock in effect at each tick in `at`."""
        lengths = np.array([int(cycles * period) for period in self.periods], np.int64)
        return lengths[self._now(at)]

    def numbers(self, ticks: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return, for each tick, the number of the cycle that begins nearest to this tick.

        Cycle 0 is the first cycle of the first clock.
        """
        periods = np.array([float(period) for period in self.periods])
        now = self._now(ticks)
        since = ticks - np.array(self.begins, np.int64)[now]
        found: NDArray[np.int64] = np.array(self._firsts, np.int64)[now] + (since / periods[now] + 0.5).astype(np.int64)
        return found

    def tick(self, number: int) -> int:
        """Return the tick at which the cycle with this number begins, rounded down."""
        firsts = self._firsts
        now = max(bisect_right(firsts, number) - 1, 0)
        return self.begins[now] + int((number - firsts[now]) * self.periods[now])

    @property
    def _firsts(self) -> list[int]:
        """For each clock, the number of its first cycle."""
        found = [0]
        for begin, end, period in zip(self.begins, self.begins[1:], self.periods, strict=False):
            found.append(found[-1] + round((end - begin) / period))
        return found

    def _now(self, at: NDArray[np.int64]) -> NDArray[np.intp]:
        """Return the index of the clock that is in effect at each of these ticks."""
        return np.maximum(np.searchsorted(self.begins, at, "right") - 1, 0)

    def in_words(self, per_second: Fraction) -> str:
        """Return the SYSCLKOUT frequencies as text, such as "7.5 MHz, from 4.373 ms on 150 MHz".

        In this example, the frequency changes from 7.5 MHz to 150 MHz at 4.373 ms. If there are more than three
        frequencies, the text has only the last one and the number of changes.
        """
        clocks = [f"{float(per_second / period / 1_000_000):.8g} MHz" for period in self.periods]
        if len(clocks) > MAX_LISTED:
            return f"{clocks[-1]} at last, changed {counted(len(clocks) - 1, 'time')}"
        since = [f"from {float(tick / per_second * 1000):.3f} ms on" for tick in self.begins[1:]]
        return ", ".join([clocks[0], *map(" ".join, zip(since, clocks[1:], strict=True))])
