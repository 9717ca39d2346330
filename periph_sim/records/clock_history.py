"""SYSCLKOUT of a recording that shows how firmware set it up: records of PLLCR and PLLSTS go in; each clock comes out.

Only where the recording begins at the reset's clock, as an image does, of one unit with a crystal of 30 MHz, and where
all its accesses fall on the cycles that follow from that; else the clock is what `Run.cycles` says.

Source: SPRUFB0D Tables 20 to 22.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

OSCCLK_HZ = 30_000_000
DIVIDE = (4, 4, 2, 1)  # by DIVSEL
DIV, DIVSEL, LOCKED, OFF = "PLLCR.DIV", "PLLSTS.DIVSEL", "PLLSTS.PLLLOCKS", "WDCR.WDDIS"
SHOWN = (DIV, DIVSEL, LOCKED, OFF)  # one of them at least is set by whoever begins at the reset's clock


class ClockHistory(NamedTuple):
    """begins: the tick from which each clock holds. periods: ticks of its cycle."""

    begins: tuple[int, ...]
    periods: tuple[Fraction, ...]

    def at(self, tick: int) -> Fraction:
        return self.periods[max(bisect_right(self.begins, tick) - 1, 0)]

    def cycles(self, begin: int, end: int) -> int:
        """Whole cycles between two ticks, rounded to nearest."""
        if end < begin:
            return -self.cycles(end, begin)
        inside = [begin, *(tick for tick in self.begins if begin < tick < end), end]
        return round(sum((after - before) / self.at(before) for before, after in pairwise(inside)))


def history(
    per_second: Fraction, changes: Iterable[tuple[int, str, int]], accesses: Iterable[int]
) -> ClockHistory | None:
    """changes: of SHOWN, as (tick, what, value) in their order. accesses: their ticks. None where it cannot be told."""
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
    """Ticks of a cycle; while the PLL locks, and in bypass, OSCCLK is only divided."""
    ratio = state[DIV] if state[LOCKED] and 1 <= state[DIV] <= 10 else 1
    return per_second * DIVIDE[state[DIVSEL] & 3] / (OSCCLK_HZ * ratio)
