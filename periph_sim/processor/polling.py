"""Waits in progress: the reads of a pass go in; for how long every further pass comes out the same comes out.

A pass whose reads have no side effect cannot come out otherwise before a bit that it looked at changes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from ..core.chip import NEVER
from ..core.socket import Onlooker, Socket
from .cpu_time import CpuTime
from .operand import Operand

Peek = Callable[[int, int], int]  # cycle and offset to what a debugger reads


@dataclass(slots=True)
class Spin:
    """A wait in progress. since: the cycle at which it began. polls, values: what the present pass read, what came.

    pass_cycles: what a pass takes in all; None: its reads, their tests and the branch back of the unit's code.
    ends: the cycle from which on it has timed out.
    """

    since: int
    pass_cycles: int | None = None
    ends: int = NEVER
    polls: list[Operand] = field(default_factory=list)
    values: list[int] = field(default_factory=list)
    pure: bool = True  # no write, no read with a side effect, no interrupt, no stall in this pass
    start: int = 0  # cycle at which the present pass began
    held_up: int = 0  # cycles of it that interrupts and stalls took
    replay: list[int] = field(default_factory=list)
    replayed: int = 0
    live_from: int = 0  # reads before this cycle are answered by the values of `replay`

    def begin_pass(self, cycle: int) -> None:
        self.polls = []
        self.values = []
        self.pure = True
        self.start = cycle
        self.held_up = 0

    def hold_up(self, cycles: int) -> None:
        """An interrupt or a stall takes time from the present pass, which so is not as the others."""
        self.pure = False
        self.held_up += cycles

    def rest(self, cycle: int, branch: int) -> int:
        """Cycles from here to the end of the present pass. branch: those of the branch back."""
        return branch if self.pass_cycles is None else max(0, self.pass_cycles - (cycle - self.start - self.held_up))

    def waits_for(self) -> str:
        return " and ".join(dict.fromkeys(str(poll) for poll in self.polls))


class Lease(Onlooker):
    """As long as no bit that a pass looked at has changed, every further pass comes out the same."""

    __slots__ = ("_first", "_seen", "_sockets", "_time")

    def __init__(self, time: CpuTime, spin: Spin) -> None:
        self._time = time
        self._first = time.cycle
        self._seen: list[tuple[Peek, int, int, int]] = []  # of what, offset, bits that count, what they were
        self._sockets: list[Socket] = []
        for operand, value in zip(spin.polls, spin.values, strict=True):
            socket, offset, mask = operand.socket, operand.offset, operand.mask
            peek = operand.chip.peek if socket.before is None else socket.peek
            if socket not in self._sockets:
                self._sockets.append(socket)
            if mask & 0xFFFF:
                self._seen.append((peek, offset, mask & 0xFFFF, value & mask & 0xFFFF))
            if mask >> 16:
                self._seen.append((peek, offset + 1, mask >> 16, (value & mask) >> 16))

    def broken(self, cycle: int) -> bool:
        """Whether a pass begun at `cycle` could come out otherwise."""
        for peek, offset, mask, value in self._seen:  # noqa: SIM110 (a generator would cost more than the looks)
            if peek(cycle, offset) & mask != value:
                return True
        return False

    def begin(self) -> None:
        """From now on the modules that were read wake the sleeping CPU when a bit changes."""
        for socket in self._sockets:
            socket.watch(self)

    def end(self) -> None:
        for socket in self._sockets:
            socket.unwatch(self)

    def look(self, cycle: int) -> None:
        """A module that was read has had an input."""
        if self.broken(cycle):
            self._time.resume_by(max(cycle, self._first))
