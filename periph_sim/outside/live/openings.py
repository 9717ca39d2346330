"""Detection, by Linux's inotify, that the last client closed a file or a first one opened it."""

from __future__ import annotations

import ctypes
import os
import struct

OPENED, CLOSED = 0x20, 0x08 | 0x10  # IN_OPEN; IN_CLOSE_WRITE and IN_CLOSE_NOWRITE, in sys/inotify.h
EVENT = struct.Struct("iIII")  # watch, mask, cookie, length of a name
AT_ONCE = 4096  # maximum number of bytes of events that are read in one call


class Openings:
    """Counter of a file's clients. Without inotify, as on macOS, no client is noticed."""

    def __init__(self, path: str) -> None:
        self._open = 0
        self._file = -1
        try:
            library = ctypes.CDLL(None, use_errno=True)
            self._file = library.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
            library.inotify_add_watch(self._file, path.encode(), OPENED | CLOSED)
        except AttributeError:
            return

    def close(self) -> None:
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def passed(self) -> tuple[bool, bool]:
        """Return, since the last call: True if the last client left, and True if a client came when there was none."""
        left = came = False
        for mask in self._masks():
            before = self._open
            self._open = max(0, before + (1 if mask & OPENED else -1))
            left |= before == 1 and not self._open
            came |= not before and self._open == 1
        return left, came

    def _masks(self) -> list[int]:
        found: list[int] = []
        while self._file >= 0:
            try:
                data = os.read(self._file, AT_ONCE)
            except BlockingIOError:
                break
            while data:
                _, mask, _, length = EVENT.unpack_from(data)
                data = data[EVENT.size + length :]
                if mask & (OPENED | CLOSED):
                    found.append(mask)
        return found
