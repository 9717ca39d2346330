"""Ticks of the edges of SCL in seven bits that are skipped.

SCL  _|~|_|~|_ ... _|~|_
      0   1    rises   7, the eighth bit's
        1   2  falls  7
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.time import NO_TIME, Clock

SKIPPED_BITS = 7  # number of bits of a byte that are skipped in one step


class BitTimes:
    """Edges of SCL from a party that clocks in whole ticks.

    since: the tick of the first rise. low, high: the low and the high time of SCL.
    """

    __slots__ = ("high", "low", "since")

    def __init__(self) -> None:
        self.since = NO_TIME
        self.low = self.high = 0

    def rise(self, number: int) -> int:
        """Return the tick of this rise, 0 to 7."""
        return self.since + number * (self.low + self.high)

    def fall(self, number: int) -> int:
        """Return the tick of this fall, 1 to 7."""
        return self.rise(number - 1) + self.high


@final
class CycleTimes(BitTimes):
    """Edges of SCL from a party with a clock of its own. since, low and high are in cycles of that clock."""

    __slots__ = ("_clock",)

    def __init__(self, clock: Clock) -> None:
        BitTimes.__init__(self)
        self._clock = clock

    def rise(self, number: int) -> int:
        return self._clock.tick(self.since + number * (self.low + self.high))

    def fall(self, number: int) -> int:
        return self._clock.tick(self.since + (number - 1) * (self.low + self.high) + self.high)
