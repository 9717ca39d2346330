"""Bytes that an SCI has sent and that no client has read yet.

The last megabyte is kept for a client that is not connected or does not read. Older bytes are discarded and counted.
"""

from __future__ import annotations

from collections.abc import Callable

MOST = 1 << 20  # maximum number of bytes that wait for a client, and of bytes that wait for an SCI
AT_ONCE = 4096  # maximum number of bytes of one read or write call
MOST_HELD = 16 * MOST  # `left_there` stops after this number of bytes, because a client may go on sending


class Backlog:
    """The bytes that wait for a client. lost: number of bytes discarded by `add`, because too many were waiting."""

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

    def flush(self, write: Callable[[bytes], int]) -> None:
        """Pass the bytes to `write` until it accepts no more.

        write: a function that returns the number of accepted bytes, or raises BlockingIOError if it accepts none.
        """
        while self._bytes:
            try:
                taken = write(bytes(self._bytes[:AT_ONCE]))
            except BlockingIOError:
                return
            if not taken:
                return
            del self._bytes[:taken]

    def read(self, count: int) -> bytes:
        """Remove and return up to `count` bytes."""
        taken = bytes(self._bytes[:count])
        del self._bytes[:count]
        return taken

    def clear(self) -> None:
        """Discard all bytes."""
        self._bytes.clear()


def left_there(read: Callable[[], bytes]) -> int:
    """Discard the bytes that the operating system has received from a client. Return their number.

    read: a function that returns some of these bytes, or b"" if none is left.
    """
    count = 0
    while count < MOST_HELD and (data := read()):
        count += len(data)
    return count
