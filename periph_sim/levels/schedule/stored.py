"""Rows of numbers of all scenarios, kept in 32 bits where they fit: fetching memory takes longer than the arithmetic.

A number is named by its place, row * scenarios + scenario; those of the next row are `scenarios` places on.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .clock import Ints

NARROW = np.iinfo(np.uint32).max


class Stored:
    """rows: of them. scenarios: numbers in a row. last_row: the first place of the last one."""

    def __init__(self, rows: int, scenarios: int, most: int) -> None:
        """most: a number that none reaches, and none is negative. `put_far` puts one beyond."""
        self.rows, self.scenarios, self.last_row = rows, scenarios, (rows - 1) * scenarios
        kind: type[np.integer[Any]] = np.uint32 if most < NARROW else np.int64
        self._values: NDArray[np.integer[Any]] = np.empty((rows, scenarios), kind)
        self._flat = self._values.reshape(-1)

    @classmethod
    def of(cls, rows: Ints) -> Stored:
        made = cls(rows.shape[0], rows.shape[1], int(rows.max()))
        made._values[:] = rows
        return made

    def put(self, row: int, values: Ints | int) -> None:
        self._values[row] = values

    def put_far(self, row: int, far: int) -> None:
        """A number that is never reached."""
        self._values[row] = min(far, int(np.iinfo(self._values.dtype).max))

    def at(self, places: Ints) -> Ints:
        """The numbers at these places."""
        return self._flat.take(places, mode="clip").astype(np.int64, copy=False)
