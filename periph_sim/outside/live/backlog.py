"""Bytes that an SCI has sent and no client has taken: they go in as they come, and out as far as there is room.

A client that is away, or reads nothing, finds the last megabyte; what is older is given up, and counted.
"""

from __future__ import annotations

from collections.abc import Callable

MOST = 1 << 20  # bytes that wait at most, either way
AT_ONCE = 4096  # bytes
MOST_HELD = 16 * MOST  # that a system holds for us at most, as far as it is counted


class Backlog:
    """lost: bytes that were given up."""

    def __init__(self, most: int = MOST) -> None:
        self.lost = 0
        self._most = most
        self._bytes = bytearray()

    def __len__(self) -> int:
        return len(self._bytes)

    def add(self, data: bytes) -> None:
        self._bytes += data
        beyond = len(self._bytes) - self._most
        if beyond > 0:
            self.lost += beyond
            del self._bytes[:beyond]

    def give(self, take: Callable[[bytes], int]) -> None:
        """As much as there is room for. take: gives how many of these bytes it took; BlockingIOError for none."""
        while self._bytes:
            try:
                taken = take(bytes(self._bytes[:AT_ONCE]))
            except BlockingIOError:
                return
            if not taken:
                return
            del self._bytes[:taken]

    def take(self, count: int) -> bytes:
        """Up to so many of them."""
        taken = bytes(self._bytes[:count])
        del self._bytes[:count]
        return taken

    def clear(self) -> None:
        """A client wants none of it."""
        self._bytes.clear()


def left_there(read: Callable[[], bytes]) -> int:
    """Bytes that the system took from a client, and nobody read: they are given up. read: b"" where none is left."""
    count = 0
    while count < MOST_HELD and (data := read()):
        count += len(data)
    return count
