"""Piecewise motion: six values at increasing times, between which they are constant or interpolated linearly.

Before the first and after the last time, the values are constant. The motions `flight`, `servo`, `static` and `steps`
use these classes.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from . import Motion

Rows = Sequence[Sequence[float]]


class Held(Motion):
    """A motion that is constant between given times.

    times: one or more times in seconds, increasing.
    rows: the six values from each time on, until the next time.
    """

    def __init__(self, times: Sequence[float], rows: Rows) -> None:
        self.ends = times[-1]
        self._times = times
        self._rows = rows

    def at(self, seconds: float) -> Sequence[float]:
        return self._rows[max(bisect_right(self._times, seconds) - 1, 0)]

    def rates_at(self, seconds: float) -> Sequence[float]:
        """Return zeros, because a step takes no time and so has no rate."""
        return 0.0, 0.0, 0.0


class Straight(Held):
    """A motion that is linear between given times.

    times: one or more times in seconds, strictly increasing.
    rows: the six values at each time.
    """

    def at(self, seconds: float) -> Sequence[float]:
        before = super().at(seconds)
        since = seconds - self._times[bisect_right(self._times, seconds) - 1]
        return [value + slope * since for value, slope in zip(before, self._slopes(seconds), strict=True)]

    def rates_at(self, seconds: float) -> Sequence[float]:
        return self._slopes(seconds)[:3]

    def _slopes(self, seconds: float) -> Sequence[float]:
        """Return the derivatives of the six values; zeros before the first and after the last time."""
        after = bisect_right(self._times, seconds)
        if not 0 < after < len(self._times):
            return (0.0,) * 6
        length = self._times[after] - self._times[after - 1]
        return [(to - begin) / length for begin, to in zip(self._rows[after - 1], self._rows[after], strict=True)]
