"""Exchange of the latest snapshot between the session's thread and threads that wait for the next one."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence

from .status import Snapshot, Status


class Board:
    """The latest snapshot and its number, counted from 1. A slow reader misses snapshots; the writer never waits."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._number = 0
        self._latest: Snapshot | None = None
        self._closed = False

    def put(self, snapshot: Snapshot) -> None:
        with self._changed:
            self._number += 1
            self._latest = snapshot
            self._changed.notify_all()

    def close(self) -> None:
        """Mark the latest snapshot as the last one, so that no reader waits for another."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def after(self, number: int, timeout: float) -> tuple[int, Snapshot | None]:
        """Wait for a snapshot with a higher number than `number`. Return its number and the snapshot.

        Return (`number`, None) if there is none after `timeout` seconds, or if the board is closed.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._number > number or self._closed, timeout)
            return (self._number, self._latest) if self._number > number else (number, None)

    @property
    def closed(self) -> bool:
        return self._closed


EVERY = 0.25  # seconds between two snapshots


class ViewDoor:
    """A door that puts a snapshot of the session on a board several times per second."""

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
        """Put the last snapshot on the board and close the board."""
        self._board.put(self._status.snapshot(over=True))
        self._board.close()
