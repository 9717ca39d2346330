"""A growing buffer of positions: arrays are appended in pieces and returned as one int64 array without a copy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .capture import Positions

LEAST = 1 << 10


class PositionBuffer:
    """An int64 array that grows at its end; the allocator enlarges it in place."""

    def __init__(self) -> None:
        self._room = np.empty(LEAST, np.int64)
        self._used = 0

    def __len__(self) -> int:
        return self._used

    def append(self, more: NDArray[np.integer], offset: int = 0) -> None:
        """Append `more`, with `offset` added to each value."""
        end = self._used + len(more)
        if end > len(self._room):
            self._room.resize(max(end, len(self._room) * 5 // 4), refcheck=False)
        np.add(more, offset, out=self._room[self._used : end])
        self._used = end

    def cut(self, length: int) -> None:
        """Drop all but the first `length` positions."""
        self._used = min(self._used, length)

    def done(self) -> Positions:
        """Return all positions; nothing may be appended afterwards."""
        self._room.resize(self._used, refcheck=False)
        return self._room
