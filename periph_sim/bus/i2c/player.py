"""The controller's half of an I2C bus, played from a list: moves go in, SCL and SDA edges come out.

    moves: SDA 0, SCL 0, SDA 1, SCL 1 ...  -->  the lines
                                   ^--- closed loop: SCL let go counts from when SCL really rose

It knows no bytes and no ACKs: what a controller once did, it does again, right or wrong, also a pulse no
protocol asks for. Only the clock is a conversation: while somebody else holds SCL low it waits, and all that
follows comes later by as much.

Source: UM10204 section 3.1.9 (clock stretching).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from ...core.kernel import Kernel
from ...core.time import NO_TIME
from ...core.wire import Wire


class Move(NamedTuple):
    """after: ticks since the move before, or since SCL's rise where that let SCL go. level: 0 pulls, 1 lets go."""

    after: int
    clock: bool  # SCL, else SDA
    level: int


class I2cPlayer:
    """delay: ticks lost to stretches that are over. longest: the longest of them.

    waiting_since: SCL is let go and somebody else holds it low; NO_TIME otherwise.
    """

    def __init__(self, kernel: Kernel, scl: Wire, sda: Wire, who: str = "controller") -> None:
        self.who = who
        self.delay = 0
        self.longest = 0
        self.waiting_since = NO_TIME
        self._kernel = kernel
        self._scl = scl.attach(who)
        self._sda = sda.attach(who)
        self._moves: Sequence[Move] = ()
        self._next = 0
        self._done: Callable[[], None] = _nothing
        self._lines = scl.watch(self._on_scl)

    @property
    def busy(self) -> bool:
        return self._next < len(self._moves)

    def held(self, now: int) -> int:
        """Ticks for which others have held SCL low so far since it was let go; 0 if they do not."""
        return 0 if self.waiting_since == NO_TIME else now - self.waiting_since

    def play(self, moves: Sequence[Move], done: Callable[[], None]) -> None:
        """Make the moves, the first one `after` from now; `done()` comes with the last."""
        if self.busy:
            raise ValueError(f"{self.who}: asked to play while {len(self._moves) - self._next} moves are left")
        self._moves, self._next, self._done = moves, 0, done
        self._go_on()

    def _go_on(self) -> None:
        if self._next < len(self._moves):
            self._kernel.at(self._kernel.now + self._moves[self._next].after, self._move)
        else:
            self._done()

    def _move(self) -> None:
        _, clock, level = self._moves[self._next]
        self._next += 1
        if not clock:
            self._sda.drive(level)
        else:
            self._scl.drive(level)
            if level:
                self.waiting_since = self._kernel.now
                self._lines.ask()
                return
        self._go_on()

    def _on_scl(self, now: int, level: int) -> None:
        if level and self.waiting_since != NO_TIME:
            stretch = now - self.waiting_since
            self.waiting_since = NO_TIME
            self.delay += stretch
            self.longest = max(self.longest, stretch)
            self._go_on()


def _nothing() -> None:
    """Nobody asked to be told."""
