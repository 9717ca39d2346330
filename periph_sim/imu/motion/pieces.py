"""Piecewise motion: six values at increasing times, between which they are constant or interpolated linearly.

Before the first and after the last time, the values are constant. `flight`, `servo`, `static` and `steps` use this.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import Motion

Floats = NDArray[np.float64]


class Held(Motion):
    """A motion that is constant between given times.

    times: increasing, shape (n,), n > 0.
    values: the values from each time on, shape (n, 6).
    """

    def __init__(self, times: Floats, values: Floats) -> None:
        self.ends = float(times[-1])
        self._times = times
        self._values = values

    def attitude(self, times: Floats) -> Floats:
        return self._at(times, slice(0, 3))

    def acceleration(self, times: Floats) -> Floats:
        return self._at(times, slice(3, 6))

    def rates(self, times: Floats) -> Floats:
        """Return zeros, because a step takes no time and so has no rate."""
        return np.zeros((len(times), 3))

    def _at(self, times: Floats, columns: slice) -> Floats:
        piece = np.searchsorted(self._times, times, side="right") - 1
        return self._values[np.maximum(piece, 0), columns]


class Straight(Held):
    """A motion that is linear between given times.

    times: strictly increasing, shape (n,), n > 0.
    values: the values at each time, shape (n, 6).
    """

    def __init__(self, times: Floats, values: Floats) -> None:
        super().__init__(times, values)
        slopes = np.diff(values[:, :3], axis=0) / np.diff(times)[:, np.newaxis]
        still = np.zeros((1, 3))
        self._slopes = np.vstack([still, slopes, still])

    def rates(self, times: Floats) -> Floats:
        return self._slopes[np.searchsorted(self._times, times, side="right")]

    def _at(self, times: Floats, columns: slice) -> Floats:
        return np.stack([np.interp(times, self._times, column) for column in self._values.T[columns]], axis=1)
