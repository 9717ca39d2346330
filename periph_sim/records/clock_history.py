"""SYSCLKOUT of a unit over a recording, from the file's clocks or from records of PLLCR and PLLSTS.

A file without clocks may still show them: a unit with a 30 MHz crystal begins at the reset's clock, as an image does,
and all accesses fall on the cycles that follow from that. Otherwise the clock is that of `Run.cycles`.

Source: SPRUFB0D Tables 20 to 22.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.counted import counted

OSCCLK_HZ = 30_000_000
DIVIDE = (4, 4, 2, 1)  # by DIVSEL
MOST_TOLD = 3
DIV, DIVSEL, LOCKED, OFF = "PLLCR.DIV", "PLLSTS.DIVSEL", "PLLSTS.PLLLOCKS", "WDCR.WDDIS"
SHOWN = (DIV, DIVSEL, LOCKED, OFF)  # firmware that begins at the reset's clock sets at least one of them


class ClockHistory(NamedTuple):
    """The clocks of a unit. begins: the tick from which each one is in effect. periods: the ticks of its cycle."""

    begins: tuple[int, ...]
    periods: tuple[Fraction, ...]

    @classmethod
    def told(cls, per_second: Fraction, clock: Sequence[tuple[int, Fraction]]) -> ClockHistory:
        """Return the history of pairs of a tick and the frequency from there on."""
        return cls(tuple(tick for tick, _ in clock), tuple(per_second / hz for _, hz in clock))

    def at(self, tick: int) -> Fraction:
        return self.periods[max(bisect_right(self.begins, tick) - 1, 0)]

    def cycles(self, begin: int, end: int) -> int:
        """Return the whole cycles between two ticks, rounded to nearest."""
        if end < begin:
            return -self.cycles(end, begin)
        inside = [begin, *(tick for tick in self.begins if begin < tick < end), end]
        return round(sum((after - before) / self.at(before) for before, after in pairwise(inside)))

    def of_distances(self, ticks: NDArray[np.int64], at: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return distances in whole cycles, each in the clock of its tick, rounded to nearest."""
        periods = np.array([float(period) for period in self.periods])
        cycles: NDArray[np.int64] = (ticks / periods[self._now(at)] + 0.5).astype(np.int64)
        return cycles

    def ticks_of(self, cycles: int, at: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the length of `cycles` cycles in ticks, at each of these ticks, rounded down."""
        lengths = np.array([int(cycles * period) for period in self.periods], np.int64)
        return lengths[self._now(at)]

    def numbers(self, ticks: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the number of the cycle that begins at or next to each of these ticks since the first clock began."""
        periods = np.array([float(period) for period in self.periods])
        now = self._now(ticks)
        since = ticks - np.array(self.begins, np.int64)[now]
        found: NDArray[np.int64] = np.array(self._firsts, np.int64)[now] + (since / periods[now] + 0.5).astype(np.int64)
        return found

    def tick(self, number: int) -> int:
        """Return the tick at which a cycle begins."""
        firsts = self._firsts
        now = max(bisect_right(firsts, number) - 1, 0)
        return self.begins[now] + int((number - firsts[now]) * self.periods[now])

    @property
    def _firsts(self) -> list[int]:
        """The number of each clock's first cycle."""
        found = [0]
        for begin, end, period in zip(self.begins, self.begins[1:], self.periods, strict=False):
            found.append(found[-1] + round((end - begin) / period))
        return found

    def _now(self, at: NDArray[np.int64]) -> NDArray[np.intp]:
        """Return the index of the clock that is in effect at each of these ticks."""
        return np.maximum(np.searchsorted(self.begins, at, "right") - 1, 0)

    def in_words(self, per_second: Fraction) -> str:
        """Return the clocks as text: "7.5 MHz, from 4.373 ms on 150 MHz".

        Of more than three clocks it names only the last, with the number of changes.
        """
        clocks = [f"{float(per_second / period / 1_000_000):.8g} MHz" for period in self.periods]
        if len(clocks) > MOST_TOLD:
            return f"{clocks[-1]} at last, changed {counted(len(clocks) - 1, 'time')}"
        since = [f"from {float(tick / per_second * 1000):.3f} ms on" for tick in self.begins[1:]]
        return ", ".join([clocks[0], *map(" ".join, zip(since, clocks[1:], strict=True))])


def history(
    per_second: Fraction, changes: Iterable[tuple[int, str, int]], accesses: Iterable[int]
) -> ClockHistory | None:
    """Return the clocks that the changes of registers show; None if the accesses do not fit them.

    changes: of SHOWN, as (tick, what, value) in order; without any the result is None, too. accesses: their ticks.
    """
    told = list(changes)
    if not told:
        return None
    first = next((value for _, what, value in told if what == DIVSEL), 2)
    state = {DIV: 0, DIVSEL: 0 if first else 2, LOCKED: 1, OFF: 0}
    begins, periods = [0], [_period(per_second, state)]
    for tick, what, value in told:
        state[what] = value
        period = _period(per_second, state)
        if period != periods[-1]:
            if tick == begins[-1]:
                periods[-1] = period
            else:
                begins.append(tick)
                periods.append(period)
    found = ClockHistory(tuple(begins), tuple(periods))
    before: dict[int, int] = {}  # the first access under each clock
    for tick in accesses:
        number = bisect_right(begins, tick)
        if (tick - before.setdefault(number, tick)) % found.at(tick):
            return None
    return found


def _period(per_second: Fraction, state: dict[str, int]) -> Fraction:
    """Return the ticks of a cycle; while the PLL locks, and in bypass, OSCCLK is only divided."""
    ratio = state[DIV] if state[LOCKED] and 1 <= state[DIV] <= 10 else 1
    return per_second * DIVIDE[state[DIVSEL] & 3] / (OSCCLK_HZ * ratio)
