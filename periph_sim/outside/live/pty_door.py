"""A serial line at a pseudo-terminal. An SCI receives the client's bytes, and the client reads the SCI's bytes.

    client --/dev/pts/N, or LINK--> terminal --bytes--> SerialLine --bits--> RX
                  rate set by the client -------------> length of a bit

The line uses the client's rate. A mismatch with the SCI's rate therefore causes framing errors and breaks. A
pseudo-terminal transfers neither parity nor breaks, so the format of the line is an argument. The terminal remains open
when clients close it or end.
"""

from __future__ import annotations

import termios
from collections.abc import Callable, Sequence
from pathlib import Path

from ..serial_line import SerialLine
from .backlog import MOST, Backlog, left_there
from .pseudo_terminal import PseudoTerminal

RATES = {value: int(name[1:]) for name, value in vars(termios).items() if name[0] == "B" and name[1:].isdecimal()}


class PtyDoor:
    """Passes bytes between a pseudo-terminal and a line. Raise OutsideError if `link` exists already.

    If a client is a megabyte ahead of the line, its writes wait, as at a port with flow control. When the next client
    comes, unsent bytes of the previous one are discarded and reported, unless the line can send them in a short time.

    path: the path that clients open.
    link: the path of a symbolic link to `path`, or None.
    back: bytes from the SCI that the terminal has not accepted yet.
    unread: number of bytes from clients that were not read when the door was closed.
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
        self._terminal = PseudoTerminal(link)
        self.back = Backlog()
        self.unread = 0
        self._set_rate(baud)

    @property
    def path(self) -> str:
        return self._terminal.path

    def close(self) -> None:
        self.unread += left_there(self._terminal.read)
        self._terminal.close()

    def files(self) -> Sequence[int]:
        return [self._terminal.file] if self._line.waiting < MOST else []

    def turn(self) -> None:
        self._follow_rate()
        left, came = self._terminal.clients()
        if left and not came:  # all bytes in the terminal were written by the client that has left
            while data := self._terminal.read():
                self._line.write(data)
        if came and (discarded := self._line.next_client()):
            self._notify(f"a client connected: {discarded} unsent bytes of the one before are discarded")
        while self._line.waiting < MOST:
            data = self._terminal.read()
            if not data:
                break
            self._line.write(data)
        self.back.add(self._line.read())
        self.back.flush(self._terminal.write)

    def _set_rate(self, baud: int) -> None:
        code = next((value for value, rate in RATES.items() if rate == baud), None)
        if code is not None:
            attributes = termios.tcgetattr(self._terminal.kept)
            attributes[4] = attributes[5] = code
            termios.tcsetattr(self._terminal.kept, termios.TCSANOW, attributes)

    def _follow_rate(self) -> None:
        baud = RATES.get(termios.tcgetattr(self._terminal.kept)[5], self._baud)
        if baud and baud != self._baud:
            self._baud = baud
            self._line.set(baud, self._form)
