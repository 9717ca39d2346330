"""A serial line as a pseudo-terminal: what a client writes there goes to an SCI; what the SCI sends is read there.

    client --/dev/pts/N, or LINK--> terminal --bytes--> SerialLine --bits--> RX
                  rate set by the client -------------> bits' length

The client's rate is the line's, so that a mismatch gives framing errors and breaks. A pseudo-terminal carries no parity
and no breaks: the line's format is given when it is made. It survives clients that close it or die.
"""

from __future__ import annotations

import errno
import os
import termios
import tty
from collections.abc import Sequence
from pathlib import Path

from ..errors import OutsideError
from ..serial_line import SerialLine
from .backlog import AT_ONCE, MOST, Backlog

RATES = {value: int(name[1:]) for name, value in vars(termios).items() if name[0] == "B" and name[1:].isdecimal()}


class PtyDoor:
    """path: what clients open. link: a name for it, made as a symbolic link. OutsideError if that is taken.

    A client that is a megabyte ahead of the line waits, as of a port with flow control. back: what it has not read.
    """

    def __init__(self, line: SerialLine, baud: int, form: str, link: Path | None = None) -> None:
        self._line = line
        self._baud, self._form = baud, form
        self._file, self._kept = os.openpty()  # kept open, so that the last client's leaving is no end
        tty.setraw(self._kept)
        os.set_blocking(self._file, False)
        self.path = os.ttyname(self._kept)
        self._link = link
        self.back = Backlog()
        self._set_rate(baud)
        if link is not None:
            try:
                link.symlink_to(self.path)
            except OSError as error:
                self._link = None
                self.close()
                raise OutsideError(f"{link}: {error.strerror}; give the link another name") from None

    def close(self) -> None:
        if self._link is not None:
            self._link.unlink(missing_ok=True)
        os.close(self._file)
        os.close(self._kept)

    def files(self) -> Sequence[int]:
        return [self._file] if self._line.waiting < MOST else []

    def turn(self) -> None:
        self._follow_rate()
        while self._line.waiting < MOST:
            data = self._read()
            if not data:
                break
            self._line.write(data)
        self.back.add(self._line.read())
        self.back.give(lambda data: os.write(self._file, data))

    def _read(self) -> bytes:
        try:
            return os.read(self._file, AT_ONCE)
        except BlockingIOError:
            return b""
        except OSError as error:
            if error.errno != errno.EIO:  # nobody has it open
                raise
            return b""

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
