"""The view as one of a session's doors: puts a snapshot on its board several times a second."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from .board import Board
from .status import Status

EVERY = 0.25  # seconds between two snapshots


class ViewDoor:
    def __init__(self, status: Status, board: Board, clock: Callable[[], float] = time.monotonic) -> None:
        self._status, self._board, self._clock = status, board, clock
        self._due = clock()

    def files(self) -> Sequence[int]:
        return []

    def turn(self) -> None:
        now = self._clock()
        if now >= self._due:
            self._due = now + EVERY
            self._board.put(self._status.snapshot())

    def close(self) -> None:
        """Put the last snapshot, at the end."""
        self._board.put(self._status.snapshot(over=True))
        self._board.close()
