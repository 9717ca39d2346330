"""The server's side of a pseudo-terminal. It remains open when clients come and go.

client --/dev/pts/N, or LINK--> read      write --> client
"""

from __future__ import annotations

import ctypes
import errno
import os
import struct
import termios
import tty
from pathlib import Path

from ..errors import OutsideError
from .backlog import AT_ONCE

OPENED, CLOSED = 0x20, 0x08 | 0x10  # IN_OPEN; IN_CLOSE_WRITE and IN_CLOSE_NOWRITE, in sys/inotify.h
EVENT = struct.Struct("iIII")  # an inotify event: watch, mask, cookie, length of a name
EVENTS_AT_ONCE = 4096  # maximum number of bytes of events that are read in one call


class Openings:
    """Counter of the clients that have a file open. It uses Linux's inotify; on systems without it, it counts none."""

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
        """Return (left, came), which describe the time since the last call.

        left: True if the last remaining client closed the file. came: True if a client opened the file when no other
        client had it open.
        """
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
                data = os.read(self._file, EVENTS_AT_ONCE)
            except BlockingIOError:
                break
            while data:
                _, mask, _, length = EVENT.unpack_from(data)
                data = data[EVENT.size + length :]
                if mask & (OPENED | CLOSED):
                    found.append(mask)
        return found


class PseudoTerminal:
    """A new pseudo-terminal. Raise OutsideError if `link` exists, unless an earlier session left it.

    path: the path that clients open.
    link: the path of a symbolic link to `path`, or None.
    file: the file descriptor of the server's side, which never blocks.
    kept: the file descriptor of the clients' side. It stays open, so that the terminal outlives its last client.
    """

    def __init__(self, link: Path | None) -> None:
        self.file, self.kept = os.openpty()
        tty.setraw(self.kept)
        os.set_blocking(self.file, False)
        self.path = os.ttyname(self.kept)
        self._openings = Openings(self.path)
        self._link = link
        if link is not None:
            try:
                if self._is_left_behind(link):
                    link.unlink()
                link.symlink_to(self.path)
            except OSError as error:
                self._link = None
                self.close()
                found = f"it is a link to {link.readlink()} already" if link.is_symlink() else error.strerror
                raise OutsideError(f"{link}: {found}; give the link another name") from None

    def _is_left_behind(self, link: Path) -> bool:
        """Return True if `link` is from an earlier session: its target is missing, or is the new terminal."""
        if not link.is_symlink():
            return False
        target = link.readlink()
        return target.parent == Path(self.path).parent and (str(target) == self.path or not target.exists())

    def close(self) -> None:
        if self._link is not None and self._link.is_symlink() and str(self._link.readlink()) == self.path:
            self._link.unlink(missing_ok=True)
        self._openings.close()
        os.close(self.file)
        os.close(self.kept)

    def clients(self) -> tuple[bool, bool]:
        """Return (left, came) for the time since the last call: the last client left, and a first client came."""
        return self._openings.passed()

    def read(self) -> bytes:
        """Return some of the received bytes, at most AT_ONCE; b"" if there are none."""
        try:
            return os.read(self.file, AT_ONCE)
        except BlockingIOError:
            return b""
        except OSError as error:
            if error.errno != errno.EIO:  # EIO: no client has opened the terminal
                raise
            return b""

    def discard_unread(self) -> None:
        """Discard the written bytes that no client has read yet."""
        termios.tcflush(self.kept, termios.TCIFLUSH)

    def write(self, data: bytes) -> int:
        """Write bytes, and return how many were accepted. Raise BlockingIOError if none was accepted."""
        return os.write(self.file, data)
