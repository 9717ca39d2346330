"""A serial line at a real port of this computer: an SCI receives the port's bytes, and the port sends the SCI's bytes.

    SCI <--bits--> SerialLine <--bytes--> /dev/ttyUSB0 <--> a board, a host

pyserial is required. The port's driver does not report which characters have a wrong parity or stop bit. If the port
vanishes, this is reported, and the port is opened again when it returns. Meanwhile the SCI's bytes wait.
"""

from __future__ import annotations

import errno
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from io import UnsupportedOperation
from typing import Any

from ..errors import OutsideError
from ..serial_line import SerialLine, port_settings
from .backlog import MOST, Backlog

HELD = "another program has it open; close it there first"
FORBIDDEN = "no permission to open it; join the group that has it, often dialout"
GONE = "it is gone: unplugged, closed at its other end, or read by another program, too"
NO_PORT = "it is no serial port"
# Beginnings of pyserial's messages for a port that fails while it is open.
USED = ("read failed", "write failed", "device reports readiness")
WHY = {
    errno.ENOENT: "there is no such port",
    errno.ENXIO: "there is no such port",
    errno.ENODEV: "there is no such port",
    errno.EACCES: FORBIDDEN,
    errno.EPERM: FORBIDDEN,
    errno.EAGAIN: HELD,
    errno.EBUSY: HELD,
    errno.ENOTTY: NO_PORT,
    errno.EISDIR: NO_PORT,
    errno.ECONNREFUSED: "no server is listening; start it first",
}


def in_our_words(port: str, error: BaseException) -> str:
    """Return a message for an error of a port: "PORT: reason".

    The reason is GONE, NO_PORT or a text in WHY if one of them fits; else the text of the operating system or pyserial.
    """
    text = str(error)
    if (isinstance(error, OSError) and error.errno == errno.EIO) or text.startswith(USED):
        return f"{port}: {GONE}"
    if text.startswith("Could not configure port"):
        return f"{port}: {NO_PORT}"
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, OSError) and cause.errno in WHY:
            return f"{port}: {WHY[cause.errno]}"
        cause = None if cause.__suppress_context__ else cause.__context__
    return text if text.startswith(port) else f"{port}: {text}"


AGAIN = 1.0  # seconds between attempts to open the port


class PortDoor:
    """Door that passes bytes between a port and a line.

    Raise OutsideError if the port cannot be opened or is in use, the format is invalid, or pyserial is missing.

    notify: callback that receives a sentence if the port vanishes or returns.
    unread: number of bytes that the port had received but the door had not read, when the door was closed.
    """

    def __init__(
        self,
        line: SerialLine,
        port: str,
        baud: int,
        form: str,
        notify: Callable[[str], None] = lambda sentence: None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        try:
            import serial
        except ImportError:
            raise OutsideError("a real port needs pyserial: pip install 'periph-sim[live]'") from None
        self.path = port
        self.back = Backlog()
        self.unread = 0
        self._line = line
        self._notify = notify
        self._clock = clock
        self._again = 0.0  # time of the next attempt to open the port
        self._errors = (serial.SerialException, OSError)
        self._given = port_settings(baud, form)
        try:
            self._port: Any = self._opened()
        except (*self._errors, ValueError) as error:
            raise OutsideError(in_our_words(port, error)) from None

    def _opened(self) -> Any:
        import serial

        return serial.Serial(self.path, **self._given, timeout=0, write_timeout=0, exclusive=True)

    def close(self) -> None:
        if self._port is not None:
            with suppress(*self._errors):
                self.unread += self._port.in_waiting
            self._port.close()

    def files(self) -> Sequence[int]:
        if self._port is None or self._line.waiting >= MOST:
            return []
        try:
            return [self._port.fileno()]
        except UnsupportedOperation:  # on Windows, a port has no file number; `turn` polls it at each step
            return []

    def turn(self) -> None:
        self.back.add(self._line.read())
        if self._port is None:
            self._try_again()
            return
        try:
            waiting = self._port.in_waiting
            if waiting and self._line.waiting < MOST:
                self._line.write(self._port.read(waiting))
            self.back.flush(self._port.write)
        except self._errors as error:
            self._notify(f"{in_our_words(self.path, error)}; it will be opened again once it is back")
            self._port.close()
            self._port = None
            self._again = self._clock() + AGAIN

    def _try_again(self) -> None:
        if self._clock() < self._again:
            return
        self._again = self._clock() + AGAIN
        try:
            self._port = self._opened()
        except (*self._errors, ValueError):
            return
        self._notify(f"{self.path} is back")
