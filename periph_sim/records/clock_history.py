"""History of a unit's SYSCLKOUT, taken from the file or inferred from records of PLLCR and PLLSTS.

A file may lack clocks. They can be inferred for a unit with a 30 MHz crystal: it starts with the clock after reset, and
changes of PLLCR and PLLSTS give the later clocks. The inferred history is accepted only if all accesses fall on its
cycles. Otherwise `Run.cycles` determines the clock.

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

from ..core.phrases import counted

OSCCLK_HZ = 30_000_000
DIVIDE = (4, 4, 2, 1)  # divider from the PLL's output to SYSCLKOUT, by DIVSEL
MOST_TOLD = 3
DIV, DIVSEL, LOCKED, OFF = "PLLCR.DIV", "PLLSTS.DIVSEL", "PLLSTS.PLLLOCKS", "WDCR.WDDIS"
# The fields that determine the clock. The clock is unknown if a recording has no change of any of these fields.
SHOWN = (DIV, DIVSEL, LOCKED, OFF)


class ClockHistory(NamedTuple):
    """The clocks that a unit had during a run.

    begins: the tick from which each clock is in effect.
    periods: the length of a cycle of each clock, in ticks.
    """

    begins: tuple[int, ...]
    periods: tuple[Fraction, ...]

    @classmethod
    def told(cls, per_second: Fraction, clock: Sequence[tuple[int, Fraction]]) -> ClockHistory:
        """Return the history for pairs of a tick and the frequency in Hz from that tick on."""
        return cls(tuple(tick for tick, _ in clock), tuple(per_second / hz for _, hz in clock))

    def at(self, tick: int) -> Fraction:
        return self.periods[max(bisect_right(self.begins, tick) - 1, 0)]

    def cycles(self, begin: int, end: int) -> int:
        """Return the number of cycles between two ticks, rounded to the nearest integer; it is negative if `end` is
        earlier.
        """
        if end < begin:
            return -self.cycles(end, begin)
        inside = [begin, *(tick for tick in self.begins if begin < tick < end), end]
        return round(sum((after - before) / self.at(before) for before, after in pairwise(inside)))

    def of_distances(self, ticks: NDArray[np.int64], at: NDArray[np.int64]) -> NDArray[np.int64]:
        """Convert distances from ticks to the nearest number of cycles, each with the clock in effect at its tick in
        `at`.
        """
        periods = np.array([float(period) for period in self.periods])
        cycles: NDArray[np.int64] = (ticks / periods[self._now(at)] + 0.5).astype(np.int64)
        return cycles

    def ticks_of(self, cycles: int, at: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the length of `cycles` cycles in ticks, rounded down, for the clock in effect at each tick in `at`."""
        lengths = np.array([int(cycles * period) for period in self.periods], np.int64)
        return lengths[self._now(at)]

    def numbers(self, ticks: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return for each tick the number of the cycle that begins nearest to it.

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
        """The number of the first cycle of each clock."""
        found = [0]
        for begin, end, period in zip(self.begins, self.begins[1:], self.periods, strict=False):
            found.append(found[-1] + round((end - begin) / period))
        return found

    def _now(self, at: NDArray[np.int64]) -> NDArray[np.intp]:
        """Return the index of the clock that is in effect at each of these ticks."""
        return np.maximum(np.searchsorted(self.begins, at, "right") - 1, 0)

    def in_words(self, per_second: Fraction) -> str:
        """Return the clocks as text: "7.5 MHz, from 4.373 ms on 150 MHz".

        If there are more than three clocks, the text has only the last one and the number of changes.
        """
        clocks = [f"{float(per_second / period / 1_000_000):.8g} MHz" for period in self.periods]
        if len(clocks) > MOST_TOLD:
            return f"{clocks[-1]} at last, changed {counted(len(clocks) - 1, 'time')}"
        since = [f"from {float(tick / per_second * 1000):.3f} ms on" for tick in self.begins[1:]]
        return ", ".join([clocks[0], *map(" ".join, zip(since, clocks[1:], strict=True))])


def history(
    per_second: Fraction, changes: Iterable[tuple[int, str, int]], accesses: Iterable[int]
) -> ClockHistory | None:
    """Return the clocks inferred from changes of registers; None if there is no change or the accesses do not fit.

    changes: changes of the fields in SHOWN as (tick, field, value), in order.
    accesses: the ticks of all accesses, each of which must be the begin of a cycle.
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
    before: dict[int, int] = {}  # maps the index of a clock to the tick of the first access under it
    for tick in accesses:
        number = bisect_right(begins, tick)
        if (tick - before.setdefault(number, tick)) % found.at(tick):
            return None
    return found


def _period(per_second: Fraction, state: dict[str, int]) -> Fraction:
    """Return the length of a cycle in ticks. While the PLL locks, and in bypass, SYSCLKOUT is the divided OSCCLK."""
    ratio = state[DIV] if state[LOCKED] and 1 <= state[DIV] <= 10 else 1
    return per_second * DIVIDE[state[DIVSEL] & 3] / (OSCCLK_HZ * ratio)
