"""An I2CDriver at a pseudo-terminal, in a session that a loop steps: its client's commands go in, its answers come out.

client --/dev/pts/N, or LINK--> I2cDriver --> SDA, SCL

A transfer is done at once, and moves the session's time on by what it takes on the wires; the loop then waits for the
clock. Commands of a client that reads no answers are not executed once a megabyte of answers waits; the answers are
discarded when another client connects.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..drivers.i2cdriver_adapter import I2cDriver
from ..session import Session
from .backlog import MOST, Backlog, left_there
from .pseudo_terminal import PseudoTerminal


class I2cDriverDoor:
    """pause: what passes before each START. OutsideError for a link that is taken, or a bus that is not outside.

    back: what its client has not read yet. unheard: bytes of it that were not taken when this was closed."""

    def __init__(self, session: Session, link: Path | None = None, pause: str = "100 us") -> None:
        self._adapter = I2cDriver(session, session.ticks(pause))
        self._terminal = PseudoTerminal(link)
        self.back = Backlog()
        self.unheard = 0

    @property
    def path(self) -> str:
        return self._terminal.path

    def close(self) -> None:
        self.unheard += left_there(self._terminal.read)
        self._terminal.close()

    def files(self) -> Sequence[int]:
        return [self._terminal.file] if len(self.back) < MOST else []

    def turn(self) -> None:
        """The commands that have come, a few kilobytes of them; what is left is for the next turn."""
        if self._terminal.clients()[1]:  # what the client before did not read is no answer to this one
            self.back.clear()
            self._terminal.discard_unread()
        if len(self.back) < MOST:
            self.back.add(self._adapter.take(self._terminal.read()))
            self.back.add(self._adapter.captured())
        self.back.give(self._terminal.write)
