"""Waits in progress: the reads of a pass go in; for how long every further pass comes out the same comes out.

A pass whose reads have no side effect cannot come out otherwise before a bit that it looked at changes.
"""

from __future__ import annotations

from ..core.chip import NEVER
from ..core.socket import Onlooker, Socket
from ..f28335.cpu import instruction_costs as cpu_costs
from .cpu_time import CpuTime
from .operand import Operand


class Spin:
    """A wait in progress. since: the cycle at which it began. polls, values: what the present pass read, what came.

    pass_cycles: what a pass takes in all; None: its reads, their tests and the branch back of the unit's code.
    ends: the cycle from which on it has timed out.
    pure: no write, no read with a side effect, no interrupt, no stall in this pass.
    start: cycle at which the present pass began. held_up: cycles of it that interrupts and stalls took.
    bare: its present pass took nothing but its reads and their tests.
    live_from: reads before this cycle are answered by the values of `replay`, of which `replayed` have been.
    """

    __slots__ = (
        "bare",
        "ends",
        "held_up",
        "live_from",
        "pass_cycles",
        "polls",
        "pure",
        "replay",
        "replayed",
        "since",
        "start",
        "values",
    )

    def __init__(self, since: int, pass_cycles: int | None = None, ends: int = NEVER) -> None:
        self.since = since
        self.pass_cycles = pass_cycles
        self.ends = ends
        self.polls: list[Operand] = []
        self.values: list[int] = []
        self.pure = True
        self.bare = False
        self.start = 0
        self.held_up = 0
        self.replay: list[int] = []
        self.replayed = 0
        self.live_from = 0

    def begin_pass(self, cycle: int) -> None:
        self.polls.clear()
        if self.replay is self.values:
            self.values = []
        else:
            self.values.clear()
        self.pure = True
        self.start = cycle
        self.held_up = 0

    def take_length(self, cycle: int) -> None:
        """The reads of the present pass are over at this cycle."""
        for operand in self.polls:
            cycle -= operand.read_waits + 1
        self.bare = cycle == self.start + (len(self.polls) - 1) * cpu_costs.SB_NOT_TAKEN

    def answer_before(self, cycle: int) -> None:
        """The next pass is a replay of the present one as far as its reads lie before this cycle."""
        self.replay = self.values
        self.replayed = 0
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


class Lease(Onlooker):
    """As long as no bit that a pass looked at has changed, every further pass comes out the same."""

    __slots__ = ("_first", "_polls", "_sockets", "_time", "_values")

    def __init__(self, time: CpuTime) -> None:
        self._time = time
        self._first = 0
        self._polls: list[Operand] = []
        self._values: list[int] = []
        self._sockets: list[Socket] = []

    def take(self, spin: Spin) -> None:
        """From now on it is about the pass that has ended now."""
        self._first = self._time.cycle
        self._polls = spin.polls
        self._values = spin.values
        self._sockets.clear()
        for operand in spin.polls:
            if operand.socket not in self._sockets:
                self._sockets.append(operand.socket)

    def broken(self, cycle: int) -> bool:
        """Whether a pass begun at `cycle` could come out otherwise."""
        for place, operand in enumerate(self._polls):
            seen = self._values[place]
            value = operand.chip.see(cycle, operand.offset) if operand.plain else operand.see(cycle)
            if (value ^ seen) & operand.mask:
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
