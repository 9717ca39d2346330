"""Waits in progress: the reads of a pass go in; for how long every further pass comes out the same comes out.

A pass whose reads have no side effect cannot come out otherwise before a bit that it looked at changes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from ..core.chip import NEVER
from ..core.registers import Field, Register
from ..core.socket import Socket
from ..f28335.system.memory_map import WORDS_MASK, ModuleRange

Peek = Callable[[int, int], int]  # cycle and offset to what a debugger reads


class Poll(NamedTuple):
    """One read made in a pass of a spin: where, what, and when its value was taken."""

    place: ModuleRange
    register: Register
    words: int
    field: Field | None  # what firmware looked at; None: all of these words
    cycle: int
    value: int

    @property
    def mask(self) -> int:
        """The bits that firmware looked at."""
        return self.field.mask if self.field is not None else WORDS_MASK[self.words]

    def __str__(self) -> str:
        return f"{self.place.name}.{self.register.name}.{self.field.name if self.field is not None else 'all'}"


@dataclass(slots=True)
class Spin:
    """A wait in progress. since: the cycle at which it began. polls: reads of the present pass.

    pass_cycles: what a pass takes in all; None: its reads, their tests and the branch back of the unit's code.
    ends: the cycle from which on it has timed out.
    """

    since: int
    pass_cycles: int | None = None
    ends: int = NEVER
    polls: list[Poll] = field(default_factory=list)
    pure: bool = True  # no write, no read with a side effect, no interrupt, no stall in this pass
    start: int = 0  # cycle at which the present pass began
    held_up: int = 0  # cycles of it that interrupts and stalls took
    replay: list[Poll] = field(default_factory=list)
    replayed: int = 0
    live_from: int = 0  # reads before this cycle are answered from `replay`

    def begin_pass(self, cycle: int) -> None:
        self.polls = []
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


class Sleeper(Protocol):
    """A CPU that sleeps over passes of a wait."""

    cycle: int

    def resume_by(self, cycle: int) -> None: ...


class Lease:
    """As long as no bit that a pass looked at has changed, every further pass comes out the same."""

    __slots__ = ("_cpu", "_first", "_seen", "sockets")

    def __init__(self, cpu: Sleeper, spin: Spin) -> None:
        self._cpu = cpu
        self._first = cpu.cycle
        self._seen: list[tuple[Peek, int, int, int]] = []  # of what, offset, bits that count, what they were
        self.sockets: list[Socket] = []
        for poll in spin.polls:
            socket, offset, mask, value = poll.place.socket, poll.register.offset, poll.mask, poll.value
            peek = socket.chip.peek if socket.before is None else socket.peek
            if socket not in self.sockets:
                self.sockets.append(socket)
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

    def look(self, cycle: int) -> None:
        """A module that was read has had an input."""
        if self.broken(cycle):
            self._cpu.resume_by(max(cycle, self._first))
