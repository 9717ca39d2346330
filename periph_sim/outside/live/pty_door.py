"""Doors at a pseudo-terminal. A door connects a session with clients, as `loop.Door` describes.

The serial door, `PtyDoor`, connects an SCI: the SCI receives what a client writes, and sends to this client.

    client --/dev/pts/N, or LINK--> terminal --bytes--> SerialLine --bits--> RX
                  rate set by the client -------------> length of a bit

The line uses the client's rate. A mismatch with the SCI's rate therefore causes framing errors and breaks. A
pseudo-terminal transfers neither parity nor breaks, so the format of the line is an argument. The terminal remains open
when clients close it or end.
"""

from __future__ import annotations

import ctypes
import errno
import os
import struct
from collections.abc import Callable, Sequence
from pathlib import Path

from ..errors import OutsideError
from ..serial_line import SerialLine
from .backlog import AT_ONCE, MOST, Backlog, left_there

try:
    import termios
    import tty
except ImportError:
    raise OutsideError(
        "a pseudo-terminal needs Linux or macOS; serve an SCI at --port or --rfc2217, which every system has"
    ) from None

RATES = {value: int(name[1:]) for name, value in vars(termios).items() if name[0] == "B" and name[1:].isdecimal()}


OPENED, CLOSED = 0x20, 0x08 | 0x10  # masks of events: IN_OPEN; IN_CLOSE_WRITE or IN_CLOSE_NOWRITE
EVENT = struct.Struct("iIII")  # an inotify event: watch, mask, cookie, length of a name (0 for a watched file)
EVENTS_AT_ONCE = 4096  # maximum number of bytes of inotify events that one read returns


class Openings:
    """Counter of the clients that have a file open. It uses Linux's inotify; on other systems, the count remains 0."""

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
            found += [mask for _, mask, _, _ in EVENT.iter_unpack(data) if mask & (OPENED | CLOSED)]
        return found


class TerminalDoor:
    """A connection between a session and clients that open a new pseudo-terminal (see `loop.Door`).

    path: the path that clients open.
    link: the path of a symbolic link to `path`, or None.
    file: the file descriptor of the server's side of the terminal, which never blocks.
    back: waiting bytes for the client, which the terminal has not accepted yet.
    unread: number of bytes from clients that were not read when the door was closed.

    Raise OutsideError if `link` cannot be created. A link that an earlier session left is replaced.
    """

    def __init__(self, link: Path | None) -> None:
        self.back = Backlog()
        self.unread = 0
        # `_kept` is the file descriptor of the clients' side. It stays open, so that the terminal outlives its last
        # client.
        self.file, self._kept = os.openpty()
        tty.setraw(self._kept)
        os.set_blocking(self.file, False)
        self.path = os.ttyname(self._kept)
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
        """Return True if `link` is from an earlier session: it leads to the new terminal, or to one that is missing."""
        if not link.is_symlink():
            return False
        target = link.readlink()
        return target.parent == Path(self.path).parent and (str(target) == self.path or not target.exists())

    def close(self) -> None:
        self.unread += left_there(self._read)
        if self._link is not None and self._link.is_symlink() and str(self._link.readlink()) == self.path:
            self._link.unlink(missing_ok=True)
        self._openings.close()
        os.close(self.file)
        os.close(self._kept)

    def _clients(self, receive: Callable[[bytes], object]) -> tuple[bool, bool]:
        """Return (left, came) as `Openings.passed` does.

        If a client has left and no other has come, pass its last bytes to `receive`.
        """
        left, came = self._openings.passed()
        if left and not came:  # all bytes in the terminal were written by the client that has left
            while data := self._read():
                receive(data)
        return left, came

    def _read(self) -> bytes:
        """Return some of the received bytes, at most AT_ONCE; b"" if there are none."""
        try:
            return os.read(self.file, AT_ONCE)
        except OSError as error:
            if error.errno not in (errno.EAGAIN, errno.EIO):  # EIO: no client has opened the terminal
                raise
            return b""

    def _discard_unread(self) -> None:
        """Discard the bytes that no client has read yet, those in `back` included."""
        self.back.clear()
        termios.tcflush(self._kept, termios.TCIFLUSH)

    def _write(self, data: bytes) -> int:
        """Write bytes, and return how many were accepted. Raise BlockingIOError if none was accepted."""
        return os.write(self.file, data)


class PtyDoor(TerminalDoor):
    """Door that passes bytes between a pseudo-terminal and a serial line. It raises errors like `TerminalDoor`.

    If a client is a megabyte ahead of the line, its writes wait, as at a port with flow control. When another client
    opens the terminal, the unsent bytes of the previous client are discarded and reported. They are sent instead if the
    line needs at most a tenth of a second for them.

    link: the path of a symbolic link to the path of the door, or None.
    """

    def __init__(
        self,
        line: SerialLine,
        baud: int,
        form: str,
        link: Path | None = None,
        notify: Callable[[str], None] = lambda sentence: None,
    ) -> None:
        self._line = line
        self._notify = notify
        self._baud, self._form = baud, form
        super().__init__(link)
        self._set_rate(baud)

    def files(self) -> Sequence[int]:
        return [self.file] if self._line.waiting < MOST else []

    def turn(self) -> None:
        self._follow_rate()
        _, came = self._clients(self._line.write)
        if came and (discarded := self._line.next_client()):
            self._notify(f"a client connected: {discarded} unsent bytes of the one before are discarded")
        while self._line.waiting < MOST:
            data = self._read()
            if not data:
                break
            self._line.write(data)
        self.back.add(self._line.read())
        self.back.flush(self._write)

    def _set_rate(self, baud: int) -> None:
        code = next((value for value, rate in RATES.items() if rate == baud), None)
        if code is not None:
            attributes = termios.tcgetattr(self._kept)
            attributes[4] = attributes[5] = code
            termios.tcsetattr(self._kept, termios.TCSANOW, attributes)

    def _follow_rate(self) -> None:
        baud = RATES.get(termios.tcgetattr(self._kept)[5], self._baud)
        if baud and baud != self._baud:
            self._baud = baud
            self._line.set(baud, self._form)
