"""The values that a measure has taken: the worst and the least with their ticks, their number, percentiles.

No history is kept, so memory does not grow with the run, unless `keep` asks for all values; a percentile counts equal
ones (`tally`).
"""

# core: compiled

from __future__ import annotations

from array import array
from collections.abc import Callable
from typing import TYPE_CHECKING

from ...core.records import Listener
from ...core.time import NO_TIME
from .tally import Tally

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class TakenValues(Listener):
    """Base of measures. worst, least: the largest and the smallest value. not_before: the first tick that counts.

    occasions: number of times that there was something to measure, counted on the bus and not by the firmware; None
    if the measure has no such count.
    """

    def __init__(self) -> None:
        self.count = 0
        self.worst = 0
        self.least = 0
        self.worst_at = NO_TIME
        self.least_at = NO_TIME
        self.cut_off = 0  # number of these that the end of the run cut off
        self.not_before = NO_TIME
        self.occasions: int | None = None
        self.tap: Callable[[int, int], None] | None = None  # called with each value that is taken
        self._kept: tuple[array[int], array[int]] | None = None
        self._tally: Tally | None = None

    def keep(self) -> None:
        """Keep every value, for distributions and joined conditions."""
        self._kept = array("q"), array("q")

    def tally(self) -> None:
        """Count values that are equal, for percentiles."""
        self._tally = Tally()

    @property
    def tallied(self) -> bool:
        return self._tally is not None

    @property
    def kept(self) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
        """(values, when each was), both int64[count], in order; None unless `keep` was called."""
        if self._kept is None:
            return None
        import numpy as np  # with the first percentile: most runs need none

        values, at = self._kept
        return np.array(values, np.int64), np.array(at, np.int64)

    def all_kept(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return `kept` of a measure that keeps its values."""
        assert self.kept is not None
        return self.kept

    def only(self, places: NDArray[np.int64]) -> None:
        """Keep only the values at these places."""
        values, at = (column[places].tolist() for column in self.all_kept())
        self.count = self.cut_off = 0
        self.occasions = None  # the measure that it is joined to has them
        self.keep()
        if self._tally is not None:
            self.tally()
        for value, when in zip(values, at, strict=True):
            self.take(value, when)

    def percentile(self, per_mille: int) -> tuple[int, int]:
        """Return (value, first tick) of the least value that `per_mille` of the values do not exceed (nearest rank)."""
        assert self._tally is not None
        return self._tally.percentile(per_mille)

    def occasion(self, at: int, number: int = 1) -> None:
        """Count occasions. at: as given to `take`."""
        if at >= self.not_before:
            assert self.occasions is not None
            self.occasions += number

    def take(self, value: int, at: int) -> None:
        if at < self.not_before:
            return
        if not self.count or value > self.worst:
            self.worst, self.worst_at = value, at
        if not self.count or value < self.least:
            self.least, self.least_at = value, at
        self.count += 1
        if self._kept is not None:
            self._kept[0].append(value)
            self._kept[1].append(at)
        if self._tally is not None:
            self._tally.add(value, at)
        if self.tap is not None:
            self.tap(value, at)

    def take_unfinished(self, value: int, at: int) -> None:
        """Take the value of an unfinished occurrence, which exceeds all before."""
        least, least_at, alone = self.least, self.least_at, not self.count
        self.take(value, at)
        self.cut_off += 1
        if not alone:
            self.least, self.least_at = least, least_at
