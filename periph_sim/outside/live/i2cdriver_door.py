"""An I2CDriver adapter at a pseudo-terminal, as a door of a session in real time.

client --/dev/pts/N, or LINK--> I2cDriver --> SDA, SCL

A transfer is executed at once and advances the session by its duration on the wires. The loop then waits until real
time has caught up.

If a client does not read its answers, its commands are not executed while a megabyte of answers waits. When the client
leaves, these answers and a command that is not complete are discarded.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..drivers.i2cdriver_adapter import I2cDriver
from ..session import Session
from .backlog import MOST
from .pty_door import TerminalDoor


class I2cDriverDoor(TerminalDoor):
    """Door that connects a pseudo-terminal to an I2CDriver adapter on the bus of a session.

    Raise OutsideError if `link` cannot be created (see `TerminalDoor`), or if the bus does not lead outside.

    pause: the simulated time that passes before each START.
    """

    def __init__(self, session: Session, link: Path | None = None, pause: str = "100 us") -> None:
        self.adapter = I2cDriver(session, session.ticks(pause))
        super().__init__(link)

    def files(self) -> Sequence[int]:
        return [self.file] if len(self.back) < MOST else []

    def turn(self) -> None:
        """Execute received commands, at most a few kilobytes of them. Later calls execute the rest.

        If a client has left and no other has come, execute all of its commands.
        """
        left, came = self._clients(self.adapter.receive)
        if left or came:  # discard the answers to the previous client, and the command that it has not completed
            self.adapter.next_client()
            self._discard_unread()
        if len(self.back) < MOST:
            self.back.add(self.adapter.receive(self._read()))
            self.back.add(self.adapter.captured())
        self.back.flush(self._write)
