"""Waits in progress: the reads of a pass, and the time for which further passes have the same result.

A pass whose reads have no side effect repeats until a bit that it looked at changes.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ..core.chip import NEVER
from ..core.socket import ChipObserver, Socket
from ..core.state import State
from ..f28335.cpu import code_costs as cpu_costs
from .cpu_time import CpuTime
from .operand import Operand
from .source_location import SourceLocation


@final
class Poll:
    """A read of a pass: operand and value. before: the value that was read in the pass that is replayed.

    where: the statement in the firmware, if it is already known.
    """

    STATE = State("operand value before where", made=True)

    operand: Operand
    value: int
    before: int
    where: SourceLocation | None


@final
class Spin:
    """A wait in progress. since: the cycle at which it began. made: number of reads in the present pass.

    pass_cycles: all cycles of a pass; None: those of its reads, their tests and the branch back of the unit's code.
    ends: the cycle of its timeout.
    pure: no write, no read with a side effect, no interrupt, no stall in this pass.
    start: cycle at which the present pass began. held_up: cycles of it that interrupts and stalls took.
    bare: the present pass took no time but that of its reads and their tests.
    live_from: reads before this cycle return the earlier values.
    last: operands and values of the previous pass, if passes are executed that could be skipped; else empty.
    """

    STATE = State("pass_cycles made reads pure bare held_up last", cycles="since ends start live_from", made=True)

    def __init__(self, since: int, pass_cycles: int | None = None, ends: int = NEVER) -> None:
        self.since = since
        self.pass_cycles = pass_cycles
        self.ends = ends
        self.made = 0
        self.reads: list[Poll] = []  # of this pass, in order; then the remaining ones of earlier passes
        self.pure = True
        self.bare = False
        self.start = 0
        self.held_up = 0
        self.live_from = 0
        self.last: list[tuple[Operand, int]] = []

    @property
    def polls(self) -> list[Operand]:
        """The operands read by the present pass; by the last one if passes are executed that could be skipped."""
        return [operand for operand, _ in self.last] or [read.operand for read in self.reads[: self.made]]

    def unchanged(self, cycle: int) -> bool:
        """Return True if such a pass would read the same values as the last one."""
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
        """Set `bare` from the cycle at which the reads of the present pass are complete."""
        place: int
        for place in range(self.made):
            read: Poll = self.reads[place]
            cycle -= read.operand.read_waits + 1
        self.bare = cycle == self.start + (self.made - 1) * cpu_costs.SB_NOT_TAKEN

    def note(self, operand: Operand, value: int, where: SourceLocation | None) -> None:
        """Append a read to the present pass. where: its statement, if known."""
        if self.made == len(self.reads):
            self.reads.append(Poll())
        read: Poll = self.reads[self.made]
        read.operand, read.value, read.where = operand, value, where
        self.made += 1
        if not operand.steady:
            self.pure = False

    def answer(self) -> int:
        """Return the value of the next read in a replay."""
        read: Poll = self.reads[self.made]
        return read.before

    def answer_before(self, cycle: int) -> None:
        """Replay the present pass in the next one, up to its reads before this cycle."""
        if self.made < len(self.reads):
            del self.reads[self.made :]
        read: Poll
        for read in self.reads:
            read.before = read.value
        if cycle > self.live_from:
            self.live_from = cycle

    def hold_up(self, cycles: int) -> None:
        """Note cycles that an interrupt or a stall adds to the present pass, which then differs from the others."""
        self.pure = False
        self.held_up += cycles

    def rest(self, cycle: int, branch: int) -> int:
        """Return the cycles from here to the end of the present pass. branch: those of the branch back."""
        return branch if self.pass_cycles is None else max(0, self.pass_cycles - (cycle - self.start - self.held_up))

    def waits_for(self) -> str:
        return " and ".join(dict.fromkeys([str(poll) for poll in self.polls]))


NO_SOCKETS: list[Socket] = []  # stays empty


@final
class Lease(ChipObserver):
    """The time for which further passes have the same result: until a bit that the pass looked at changes."""

    STATE = State("_sockets _spin", cycles="_first")

    def __init__(self, time: CpuTime) -> None:
        self._time = time
        self._first = 0
        self._spin: Spin | None = None
        self._sockets = NO_SOCKETS

    def begin(self, spin: Spin) -> bool:
        """Wait for a change of what this pass, which has just ended, has read. Return False if it has changed already.

        The modules that were read wake the sleeping CPU when a bit changes.
        """
        self._first = self._time.cycle
        self._spin = spin
        if self.broken(self._first):
            return False
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
        return True

    def broken(self, cycle: int) -> bool:
        """Return True if a pass begun at `cycle` could differ."""
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

    def end(self) -> None:
        sockets, self._sockets = self._sockets, NO_SOCKETS
        socket: Socket
        for socket in sockets:
            socket.unwatch(self)

    def look(self, cycle: int) -> None:
        """Wake the CPU if an input of a module that was read has changed the result."""
        if self.broken(cycle):
            self._time.resume_by(max(cycle, self._first))
