"""pyserial's miniterm on a case. It sends keys to an SCI and shows the SCI's output.

Source: pyserial 3.5, serial.tools.miniterm.
"""

from __future__ import annotations

from serial import SerialException
from serial.tools.miniterm import Miniterm

from .protocol_f28335 import Serial


class Terminal(Miniterm):  # type: ignore[misc]
    """A miniterm on a session. failed: the reason why the session ended by itself; "" if the user has ended it."""

    def __init__(self, port: Serial, echo: bool, eol: str, shown: str, encoding: str) -> None:
        super().__init__(port, echo, eol, (shown,))
        self.failed = ""
        self.set_rx_encoding(encoding)
        self.set_tx_encoding(encoding)

    def talk(self, greeting: str) -> None:
        """Show the greeting, and run until the user presses Ctrl-] or the session ends."""
        self.start()
        self.console.write(f"{greeting}\r\n")
        try:
            self.join(True)
        except KeyboardInterrupt:
            self.stop()
        finally:
            self.console.cleanup()
        self.join()

    def reader(self) -> None:
        try:
            super().reader()
        except (
            SerialException,
            OSError,
        ) as error:  # OSError: this system does not let miniterm interrupt its wait for a key
            self.failed = str(error.__context__ or error)
            self.console.write("\r\nthe session has ended; press a key\r\n")

    def writer(self) -> None:
        try:
            super().writer()
        except SerialException as error:
            self.failed = self.failed or str(error)
