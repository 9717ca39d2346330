"""Waits in progress: the reads of a pass, and the time for which further passes have the same result.

A wait is a loop that reads registers until a condition is true; a pass is one execution of the loop. A pass whose reads
have no side effect has the same result until a bit that it has read changes. So the CPU can sleep in place of further
passes. When a change wakes the CPU, the pass in progress is replayed from its start: its reads before the change return
the values of the executed pass.
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
    """A read in a pass.

    value: the words that were read.
    before: in a replay, the words that this read returns if it is before the cycle of the wake-up.
    where: the statement in the firmware; None if it is not known yet.
    """

    STATE = State("operand value before where", made=True)

    operand: Operand
    value: int
    before: int
    where: SourceLocation | None


@final
class Spin:
    """A wait in progress.

    since: the cycle at which the wait began.
    pass_cycles: the cycles of a whole pass; None to compute them from the reads, their tests and the branch back.
    ends: the cycle at which the wait times out; NEVER if it has no timeout.
    made: the number of reads so far in the present pass.
    reads: the reads of the present pass in their order. Entries after the first `made` are left from earlier passes.
    pure: True if the present pass has made no write and no read with a side effect, and was not delayed by an interrupt
        or a stall.
    bare: True if only the reads of the present pass and their tests have taken time.
    start: the cycle at which the present pass began.
    held_up: the cycles by which interrupts and stalls have delayed the present pass.
    live_from: in a replay, reads before this cycle return the earlier values.
    last: (operand, value) of each read of the previous pass, if passes that could be skipped are executed; else empty.
    """

    STATE = State("pass_cycles made reads pure bare held_up last", cycles="since ends start live_from", made=True)

    def __init__(self, since: int, pass_cycles: int | None = None, ends: int = NEVER) -> None:
        self.since = since
        self.pass_cycles = pass_cycles
        self.ends = ends
        self.made = 0
        self.reads: list[Poll] = []
        self.pure = True
        self.bare = False
        self.start = 0
        self.held_up = 0
        self.live_from = 0
        self.last: list[tuple[Operand, int]] = []

    @property
    def polls(self) -> list[Operand]:
        """The operands that the present pass has read; those of the previous pass if `last` is not empty."""
        return [operand for operand, _ in self.last] or [read.operand for read in self.reads[: self.made]]

    def unchanged(self, cycle: int) -> bool:
        """Return True if a pass in this cycle would read the values in `last`. Return False if `last` is empty."""
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
        """Set `bare`, which is True if only the reads of the present pass and their tests have taken time.

        Call this method after the last read of the pass. cycle: the present cycle.
        """
        place: int
        for place in range(self.made):
            read: Poll = self.reads[place]
            cycle -= read.operand.read_waits + 1
        self.bare = cycle == self.start + (self.made - 1) * cpu_costs.SB_NOT_TAKEN

    def note(self, operand: Operand, value: int, where: SourceLocation | None) -> None:
        """Append a read to the present pass. where: the statement; None if it is not known yet."""
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
        """Prepare a replay: reads of the next pass that are before this cycle return the values of the present pass."""
        if self.made < len(self.reads):
            del self.reads[self.made :]
        read: Poll
        for read in self.reads:
            read.before = read.value
        if cycle > self.live_from:
            self.live_from = cycle

    def hold_up(self, cycles: int) -> None:
        """Add the cycles by which an interrupt or a stall delays the present pass, which is not pure then."""
        self.pure = False
        self.held_up += cycles

    def rest(self, cycle: int, branch: int) -> int:
        """Return the cycles from `cycle` to the end of the present pass. branch: the cycles of the branch back."""
        return branch if self.pass_cycles is None else max(0, self.pass_cycles - (cycle - self.start - self.held_up))

    def waits_for(self) -> str:
        return " and ".join(dict.fromkeys([str(poll) for poll in self.polls]))


NO_SOCKETS: list[Socket] = []  # a shared empty list, which is never changed


@final
class Lease(ChipObserver):
    """The time for which further passes of a wait have the same result: until a bit that the pass has read changes.

    While the CPU sleeps, this object observes the modules that the pass has read, and wakes the CPU at a change.
    """

    STATE = State("_sockets _spin", cycles="_first", results="_spin", expires="_first")

    def __init__(self, time: CpuTime) -> None:
        self._time = time
        self._first = 0
        self._spin: Spin | None = None
        self._sockets = NO_SOCKETS

    def begin(self, spin: Spin) -> bool:
        """Observe the registers that the last pass has read. Return False if a value has changed already."""
        self._first = self._time.cycle
        self._spin = spin
        if self.broken(self._first):
            return False
        place: int
        for place in range(spin.made):
            read: Poll = spin.reads[place]
            socket: Socket = read.operand.socket
            if socket not in self._sockets:
                self._sockets = [*self._sockets, socket]
                socket.watch(self)
        return True

    def broken(self, cycle: int) -> bool:
        """Return True if a pass that begins at `cycle` could have another result."""
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
        """Wake the CPU if a change of an observed module has changed the result of a pass."""
        if self.broken(cycle):
            self._time.resume_by(max(cycle, self._first))
