"""Piecewise motion: six values at rising times, which hold, or are linearly interpolated, in between.

Before the first time and after the last the values hold. Parts of `flight`, `servo`, `static` and `steps`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import Motion

Floats = NDArray[np.float64]


class Held(Motion):
    """times: rising, shape (n,), n > 0. values: shape (n, 6), each row holds from its time on."""

    def __init__(self, times: Floats, values: Floats) -> None:
        self.ends = float(times[-1])
        self._times = times
        self._values = values

    def attitude(self, times: Floats) -> Floats:
        return self._at(times, slice(0, 3))

    def acceleration(self, times: Floats) -> Floats:
        return self._at(times, slice(3, 6))

    def rates(self, times: Floats) -> Floats:
        """Return zeros: a step takes no time, and has no rate."""
        return np.zeros((len(times), 3))

    def _at(self, times: Floats, columns: slice) -> Floats:
        piece = np.searchsorted(self._times, times, side="right") - 1
        return self._values[np.maximum(piece, 0), columns]


class Straight(Held):
    """times: strictly rising, shape (n,), n > 0. values: shape (n, 6), reached at their times."""

    def __init__(self, times: Floats, values: Floats) -> None:
        super().__init__(times, values)
        slopes = np.diff(values[:, :3], axis=0) / np.diff(times)[:, np.newaxis]
        still = np.zeros((1, 3))
        self._slopes = np.vstack([still, slopes, still])

    def rates(self, times: Floats) -> Floats:
        return self._slopes[np.searchsorted(self._times, times, side="right")]

    def _at(self, times: Floats, columns: slice) -> Floats:
        return np.stack([np.interp(times, self._times, column) for column in self._values.T[columns]], axis=1)
