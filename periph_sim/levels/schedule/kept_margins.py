"""Margins of I2CDXR of a kept read or round: bytes go in as it is kept; worst and least margin of each START come out.

    margin of a byte = ceil((part - r) / den) - taken       taken: the same of all bytes

`part` and r are those of `kept`. The byte of the largest part has the worst margin, and that of the smallest part the
least one. `alone` asks for more than that: no other part within `den` of either.
"""

# core: compiled

from __future__ import annotations

from typing import final

from .one_lane import FAR, Lane
from .value_range import ValueRange


@final
class KeptMargins:
    """most, least: the extreme parts. alone: True if no other part is within `den` of either.

    Of the bytes of both: let_go in ticks from the START, landed in cycles from c, as `Lane.margin`.
    """

    def __init__(self) -> None:
        self._den = 1
        self._most_let_go = self._most_landed = 0
        self._least_let_go = self._least_landed = 0
        self.clear(1)

    def clear(self, den: int) -> None:
        self._den, self.alone = den, True
        self.most, self.least = -FAR, FAR

    def add(self, part: int, let_go: int, landed: int) -> None:
        """Add a byte; the largest part so far may lose its place, but stays close to the new one or far from it."""
        near: bool = -self._den < part - self.most < self._den or -self._den < part - self.least < self._den
        if part > self.most:
            self.most = part
            self._most_let_go, self._most_landed = let_go, landed
        if part < self.least:
            self.least = part
            self._least_let_go, self._least_landed = let_go, landed
        self.alone = self.alone and not near

    def take(self, margins: ValueRange, lane: Lane, start: int, cycle: int) -> None:
        """Compare the worst and the least margin of this START with those so far; they are counted elsewhere."""
        most = lane.margin(start + self._most_let_go, cycle + self._most_landed)
        least = lane.margin(start + self._least_let_go, cycle + self._least_landed)
        margins.take_all(most, least, 0)
