"""Waits in progress: the reads of a pass go in; for how long every further pass comes out the same comes out.

A pass whose reads have no side effect cannot come out otherwise before a bit that it looked at changes.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ..core.chip import NEVER
from ..core.socket import Onlooker, Socket
from ..core.state import State
from ..f28335.cpu import instruction_costs as cpu_costs
from .cpu_time import CpuTime
from .operand import Operand
from .source_location import SourceLocation


@final
class Poll:
    """A read of a pass: of what, and the value that came. before: the value that came in the pass that is replayed.

    where: in the firmware, if that is known without looking.
    """

    STATE = State("operand value before where", made=True)

    __slots__ = ("before", "operand", "value", "where")

    operand: Operand
    value: int
    before: int
    where: SourceLocation | None


@final
class Spin:
    """A wait in progress. since: the cycle at which it began. made: reads that the present pass has made.

    pass_cycles: what a pass takes in all; None: its reads, their tests and the branch back of the unit's code.
    ends: the cycle from which on it has timed out.
    pure: no write, no read with a side effect, no interrupt, no stall in this pass.
    start: cycle at which the present pass began. held_up: cycles of it that interrupts and stalls took.
    bare: its present pass took nothing but its reads and their tests.
    live_from: reads before this cycle are answered by what came before.
    last: operands and values of the pass before, where passes are executed that could be skipped; else empty.
    """

    STATE = State("pass_cycles made reads pure bare held_up last", cycles="since ends start live_from", made=True)

    __slots__ = (
        "bare",
        "ends",
        "held_up",
        "last",
        "live_from",
        "made",
        "pass_cycles",
        "pure",
        "reads",
        "since",
        "start",
    )

    def __init__(self, since: int, pass_cycles: int | None = None, ends: int = NEVER) -> None:
        self.since = since
        self.pass_cycles = pass_cycles
        self.ends = ends
        self.made = 0
        self.reads: list[Poll] = []  # those made, in order; behind them, of earlier passes, those to come
        self.pure = True
        self.bare = False
        self.start = 0
        self.held_up = 0
        self.live_from = 0
        self.last: list[tuple[Operand, int]] = []

    @property
    def polls(self) -> list[Operand]:
        """The operands read by the present pass; by the last one, if passes are executed that could be skipped."""
        return [operand for operand, _ in self.last] or [read.operand for read in self.reads[: self.made]]

    def executes_next(self) -> None:
        """The present pass is over, and one that could be skipped is executed."""
        self.last = [(read.operand, read.value) for read in self.reads[: self.made]]

    def unchanged(self, cycle: int) -> bool:
        """True if such a pass would still read what the last one read."""
        operand: Operand
        value: int
        for operand, value in self.last:
            if (operand.see(cycle) ^ value) & operand.mask:
                return False
        return len(self.last) > 0

    def begin_pass(self, cycle: int) -> None:
        self.made = 0
        self.pure = True
        self.start = cycle
        self.held_up = 0

    def take_length(self, cycle: int) -> None:
        """The reads of the present pass are over at this cycle."""
        place: int
        for place in range(self.made):
            read: Poll = self.reads[place]
            cycle -= read.operand.read_waits + 1
        self.bare = cycle == self.start + (self.made - 1) * cpu_costs.SB_NOT_TAKEN

    def note(self, operand: Operand, value: int, where: SourceLocation | None) -> None:
        """The present pass has read this, in this place if that is known."""
        if self.made == len(self.reads):
            self.reads.append(Poll())
        read: Poll = self.reads[self.made]
        read.operand, read.value, read.where = operand, value, where
        self.made += 1
        if not operand.steady:
            self.pure = False

    def answer(self) -> int:
        """What the next read of the present pass brings, as it is a replay."""
        read: Poll = self.reads[self.made]
        return read.before

    def answer_before(self, cycle: int) -> None:
        """The next pass is a replay of the present one as far as its reads lie before this cycle."""
        if self.made < len(self.reads):
            del self.reads[self.made :]
        read: Poll
        for read in self.reads:
            read.before = read.value
        if cycle > self.live_from:
            self.live_from = cycle

    def hold_up(self, cycles: int) -> None:
        """An interrupt or a stall takes time from the present pass, which so is not as the others."""
        self.pure = False
        self.held_up += cycles

    def rest(self, cycle: int, branch: int) -> int:
        """Cycles from here to the end of the present pass. branch: those of the branch back."""
        return branch if self.pass_cycles is None else max(0, self.pass_cycles - (cycle - self.start - self.held_up))

    def waits_for(self) -> str:
        return " and ".join(dict.fromkeys([str(poll) for poll in self.polls]))


NO_SOCKETS: list[Socket] = []  # never added to


@final
class Lease(Onlooker):
    """As long as no bit that a pass looked at has changed, every further pass comes out the same."""

    STATE = State("_sockets _spin", cycles="_first")

    __slots__ = ("_first", "_sockets", "_spin", "_time")

    def __init__(self, time: CpuTime) -> None:
        self._time = time
        self._first = 0
        self._spin: Spin | None = None
        self._sockets = NO_SOCKETS

    def take(self, spin: Spin) -> None:
        """From now on it is about the pass that has ended now."""
        self._first = self._time.cycle
        self._spin = spin

    def broken(self, cycle: int) -> bool:
        """Whether a pass begun at `cycle` could come out otherwise."""
        spin = self._spin
        assert spin is not None
        place: int
        for place in range(spin.made):
            read: Poll = spin.reads[place]
            operand: Operand = read.operand
            value: int = operand.chip.see(cycle, operand.offset) if operand.looks else operand.see(cycle)
            if (value ^ read.value) & operand.mask:
                return True
        return False

    def begin(self) -> None:
        """From now on the modules that were read wake the sleeping CPU when a bit changes."""
        spin = self._spin
        assert spin is not None
        place: int
        for place in range(spin.made):
            read: Poll = spin.reads[place]
            socket: Socket = read.operand.socket
            if not self._sockets:
                self._sockets = [socket]
                socket.watch(self)
            elif socket not in self._sockets:
                self._sockets.append(socket)
                socket.watch(self)

    def end(self) -> None:
        sockets, self._sockets = self._sockets, NO_SOCKETS
        socket: Socket
        for socket in sockets:
            socket.unwatch(self)

    def look(self, cycle: int) -> None:
        """A module that was read has had an input."""
        if self.broken(cycle):
            self._time.resume_by(max(cycle, self._first))
