"""A serial line as a real port of this computer: what comes in there goes to an SCI, what the SCI sends goes out there.

    SCI <--bits--> SerialLine <--bytes--> /dev/ttyUSB0 <--> a board, a host

Needs pyserial. A character that comes with a wrong parity or stop bit is not told apart by the port's driver.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..errors import OutsideError
from ..serial_line import SerialLine, parts_of_format
from .backlog import MOST, Backlog


class PortDoor:
    """OutsideError for a port that cannot be opened, or is open elsewhere."""

    def __init__(self, line: SerialLine, port: str, baud: int, form: str) -> None:
        try:
            import serial
        except ImportError:
            raise OutsideError("a real port needs pyserial: pip install 'periph-sim[live]'") from None
        self._line = line
        bits, parity, stop = parts_of_format(form)
        try:
            self._port: Any = serial.Serial(
                port,
                baud,
                bytesize=bits,
                parity=parity.upper(),
                stopbits=stop,
                timeout=0,
                write_timeout=0,
                exclusive=True,
            )
        except (serial.SerialException, ValueError) as error:
            raise OutsideError(f"{port}: {error}") from None
        self.back = Backlog()

    @property
    def path(self) -> str:
        return str(self._port.port)

    def close(self) -> None:
        self._port.close()

    def files(self) -> Sequence[int]:
        return [self._port.fileno()] if self._line.waiting < MOST else []

    def turn(self) -> None:
        import serial

        try:
            waiting = self._port.in_waiting
            if waiting and self._line.waiting < MOST:
                self._line.write(self._port.read(waiting))
            self.back.add(self._line.read())
            self.back.give(self._port.write)
        except (serial.SerialException, OSError) as error:
            raise OutsideError(f"{self._port.port}: {error}; it was unplugged, or another program took it") from None
