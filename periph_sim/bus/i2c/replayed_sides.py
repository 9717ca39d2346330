"""One side of an I2C bus, replayed from a list: the controller's moves, or the targets' answers.

    SCL, SDA --> TargetSide --> address known? next answer --> SDA
    moves: SDA 0, SCL 0, SDA 1, SCL 1 ...  -->  the lines
                                   ^--- closed loop: times after a release of SCL count from its actual rise

The player does not interpret bytes and ACKs: it repeats the moves of a controller, right or wrong, including pulses
that violate the protocol. Only the clock is closed-loop: while another party holds SCL low, the player waits, and all
later moves are delayed by the same time.

The targets replace the devices of a bus that are not under test. They stretch the clock if the answer has stretches. An
address without remaining answers is not acknowledged.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ...core.kernel import Kernel
from ...core.sampler import watch
from ...core.time import NO_TIME
from ...core.wire import Wire
from .target_side import Stretches, TargetSide


class Move(NamedTuple):
    """A pull (level 0) or a release (level 1) of one line by the controller.

    after: ticks since the previous move, or since the rise of SCL if the previous move released SCL.
    """

    after: int
    clock: bool  # the line: True for SCL, False for SDA
    level: int


class I2cPlayer:
    """Plays the moves of a controller on SCL and SDA.

    delay: the total time, in ticks, for which other parties have stretched the clock.
    longest: the longest single stretch, in ticks.
    waiting_since: the tick of the player's release of SCL while another party holds SCL low; else NO_TIME.
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
        self._done: Callable[[], None] = lambda: None
        self._lines = watch([scl], self._on_scl)

    def held(self, now: int) -> int:
        """Return the ticks since the player's release of SCL, while another party holds SCL low; otherwise 0."""
        return 0 if self.waiting_since == NO_TIME else now - self.waiting_since

    def play(self, moves: Sequence[Move], done: Callable[[], None]) -> None:
        """Make the moves, the first move `Move.after` ticks from now. `done()` is called after the last move."""
        self._moves, self._next, self._done = moves, 0, done
        self._go_on()

    def _go_on(self) -> None:
        if self._next < len(self._moves):
            self._kernel.call_at(self._kernel.now + self._moves[self._next].after, self._move)
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
                self._lines.request_sample()
                return
        self._go_on()

    def _on_scl(self, now: int, level: int) -> None:
        if level and self.waiting_since != NO_TIME:
            stretch = now - self.waiting_since
            self.waiting_since = NO_TIME
            self.delay += stretch
            self.longest = max(self.longest, stretch)
            self._go_on()


@dataclass(frozen=True, slots=True)
class Answer:
    """Answer to a START with an address.

    ack: True if the address is acknowledged.
    data: the bytes that are sent in a read; 0xFF follows them.
    acks: the acknowledges of written bytes; further bytes are acknowledged.
    stretches: triples (byte, bit, ticks) as in `target_side.Reply`.
    """

    ack: bool
    data: bytes = b""
    acks: tuple[bool, ...] = ()
    stretches: Stretches = ()

    def send_byte(self, byte: int) -> int:
        return self.data[byte] if byte < len(self.data) else 0xFF

    def receive_byte(self, byte: int, value: int) -> bool:
        return byte >= len(self.acks) or self.acks[byte]


class ScriptedTarget(TargetSide):
    """All targets of the replayed bus, as one party: to each address, it gives the listed answers one after the other.

    hold: ticks from a fall of SCL to a change of SDA by this party.
    """

    def __init__(
        self,
        kernel: Kernel,
        scl: Wire,
        sda: Wire,
        answers: Mapping[int, Iterable[Answer]],
        hold: int,
        who: str = "targets",
    ) -> None:
        self._left = {address: deque(of) for address, of in answers.items()}
        super().__init__(kernel, scl, sda, self._next, hold, who)

    def _next(self, address_byte: int) -> Answer | None:
        """Return the next answer to this address byte; None if no answer is left."""
        waiting = self._left.get(address_byte >> 1)
        return waiting.popleft() if waiting else None
