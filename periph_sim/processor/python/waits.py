"""`while (!condition()) ;` of Python firmware: a condition goes in; the cycle comes at which polling would have ended.

    condition --first pass--> what it read --Lease--> sleep --wake--> reads alone --a bit differs--> condition

Waiting is skipped: a pass of a spin whose reads have no side effect is made once; it cannot come out otherwise before a
register that it read changes or an interrupt is due. At that moment the pass in progress is made from its start, reads
that lie in the past answering with what was read before. As long as the reads bring what they brought, nobody asks the
condition. So a spin ends at the cycle at which polling pass by pass would have ended, at the cost of one event.

A condition is a function, or a `Condition` on one register, which makes its passes without Python; a function that was
recognised as one is taken for it.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, final

from ...core.chip import NEVER
from ...core.options import IntOption
from ...core.records import Topic
from ...f28335.cpu import instruction_costs as cpu_costs
from ..bus import Bus
from ..cpu_time import CpuTime
from ..polling import Lease, Spin
from ..processor import Processor
from ..program import Stop
from .code_records import CodeRecords
from .conditions import Condition
from .instructions import Instructions
from .program import PythonProgram
from .recognised import Recogniser

if TYPE_CHECKING:
    from ..operand import Operand
    from ..polling import Poll

NEITHER, READY, OVER = range(3)  # what ended a wait
SLEEPS = Stop.SLEEPS


@final
class Waits:
    """skip_polls: False makes every pass of every spin for real (the brute force that the skipping is proven against).

    branch: cycles of the branch back to the begin of a pass.
    """

    __slots__ = (
        "_branch",
        "_branch_listed",
        "_bus",
        "_core",
        "_instructions",
        "_lease",
        "_pf2_read_ws",
        "_program",
        "_recogniser",
        "_records",
        "_skip_polls",
        "_spare",
        "_time",
    )

    _branch: int

    def __init__(
        self,
        processor: Processor,
        program: PythonProgram,
        instructions: Instructions,
        records: CodeRecords,
        *,
        poll_pass: int,
        pf2_read_ws: IntOption,
        skip_polls: bool,
    ) -> None:
        self._branch = max(0, poll_pass - cpu_costs.SIMPLE - pf2_read_ws.unrecorded())
        self._branch_listed = False
        self._pf2_read_ws = pf2_read_ws
        self._bus: Bus = processor.bus
        self._core = processor.interrupts.core
        self._instructions = instructions
        self._program = program
        self._records = records
        self._skip_polls = skip_polls
        self._time: CpuTime = processor.time
        self._lease = Lease(processor.time)
        self._recogniser = Recogniser(program)
        self._spare: Spin | None = None  # of a wait that is over

    def spin(self, condition: Callable[[], object], pass_cycles: int | None = None, timeout: int | None = None) -> bool:
        """`while (!condition()) ;` as the compiler makes it: passes of reads, their tests and the branch back.

        True as soon as the condition holds; False at the end of the first pass by which `timeout` cycles have passed
        since the wait began, interrupts included. pass_cycles: what a pass takes in all, if its reads take no longer.
        """
        return self._wait(condition, None, pass_cycles, timeout) == READY

    def spin_either(
        self, ready: Callable[[], object], over: Callable[[], object], pass_cycles: int | None = None
    ) -> bool:
        """`while (!ready()) if (over()) break;`: True if `over` ended the wait."""
        return self._wait(ready, over, pass_cycles, None) == OVER

    def _wait(
        self,
        ready: Callable[[], object],
        over: Callable[[], object] | None,
        pass_cycles: int | None,
        timeout: int | None,
    ) -> int:
        """Which of the conditions ended the wait: READY, OVER or, after a timeout, neither."""
        time, program, instructions, records = self._time, self._program, self._instructions, self._records
        spin = self._begun(pass_cycles, NEVER if timeout is None else time.cycle + timeout)
        outer, program.spin = program.spin, spin
        recogniser = self._recogniser
        asked: Condition | None
        asked_else: Condition | None
        asked = ready if isinstance(ready, Condition) else recogniser.condition(ready)
        asked_else = over if over is None or isinstance(over, Condition) else recogniser.condition(over)
        waited: Topic | None = None
        came, again = NEITHER, False
        while True:
            if not again or not self._repeats(spin):
                spin.begin_pass(time.cycle)
                if asked.holds() if asked is not None else ready():
                    came = READY
                elif over is not None and (asked_else.holds() if asked_else is not None else over()):
                    came = OVER
                if came:
                    break
                spin.take_length(time.cycle)
                if records.waits and waited is None:
                    waited = records.waited_for(spin)
                    records.tell(waited, spin.since, 1)
            if pass_cycles is None and not self._branch_listed:
                self._branch_listed = True  # it is what `poll_pass` leaves to it; the list of the CPU keeps what it has
                self._pf2_read_ws.assume(self._core.touched)
            instructions.instruction(spin.rest(time.cycle, self._branch))
            again = spin.pure and time.cycle < spin.ends and self._skip(spin)
            if time.cycle >= spin.ends:
                break
        if waited is not None:
            records.tell(waited, time.cycle, 0)
        instructions.instruction(cpu_costs.SB_NOT_TAKEN)
        program.spin = outer
        self._spare = None if records.kept else spin
        return came

    def _begun(self, pass_cycles: int | None, ends: int) -> Spin:
        """A wait that begins now: the object of an earlier one that is over, unless somebody may have kept that."""
        spin, self._spare = self._spare, None
        if spin is None:
            return Spin(self._time.cycle, pass_cycles, ends)
        spin.since = self._time.cycle
        spin.pass_cycles = pass_cycles
        spin.ends = ends
        spin.bare = False
        spin.live_from = 0
        if spin.last:
            spin.last = []
        return spin

    def _skip(self, spin: Spin) -> bool:
        """Sleep over the passes that must come out as this one did, and set up the replay of the one in progress.

        Where they are executed, `Spin.last` tells that they could have been skipped.
        True if nothing but reads can make the next pass come out otherwise.
        """
        time, core = self._time, self._core
        if not spin.made or time.lands < NEVER or core.earliest() < NEVER:
            return False
        if not self._skip_polls:
            spin.executes_next()
            return False
        lease = self._lease
        lease.take(spin)
        if lease.broken(time.cycle):
            return False
        first = time.cycle
        period = first - spin.start
        lease.begin()
        if spin.ends < NEVER:
            time.wake_at(first - (first - spin.ends) // period * period)  # the end of the pass that times out
        time.sleep(NEVER)
        try:
            self._program.give_way(SLEEPS)
        finally:  # a reset ends the firmware here
            lease.end()
        woken = time.cycle
        skipped = (woken - first) // period
        self._program.polls_skipped += skipped
        time.cycle = first + skipped * period
        spin.answer_before(woken)
        if core.ifr or core.next_wake <= time.cycle:  # the end of the branch back is a boundary, too
            self._instructions.serve()
        return spin.bare and spin.pure

    def _repeats(self, spin: Spin) -> bool:
        """The next pass as far as its reads bring what they brought in the last one. True if all of them do.

        False: the pass is the condition's to make, from its start on; reads that were made are answered from memory.
        """
        time, instructions = self._time, self._instructions
        cycle: int
        start = cycle = time.cycle
        place: int
        for place in range(spin.made):
            read: Poll = spin.reads[place]
            operand: Operand = read.operand
            if place:
                cycle += cpu_costs.SB_NOT_TAKEN  # the test of the value before, in the same pass
                if not self._passes(cycle):
                    break
            if not operand.looks or (operand.placed and read.where is None) or cycle < self._bus.free(operand):
                break
            cycle += operand.read_waits
            if cycle >= spin.live_from:
                if cycle >= time.lease:
                    instructions.go_to(cycle)
                value: int = operand.chip.see(cycle, operand.offset)
                if (value ^ read.value) & operand.mask:
                    break
                if operand.recorded:
                    self._bus.tell_look(cycle, operand, value, read.where)
            cycle += 1
            if not self._passes(cycle):
                break
        else:
            spin.start = start
            return True
        time.cycle = start
        spin.answer_before(cycle)
        return False

    def _passes(self, cycle: int) -> bool:
        """Let time pass to a boundary between two instructions. False if an interrupt may be taken there."""
        time, core = self._time, self._core
        if cycle < time.lease:
            time.cycle = cycle
        else:
            self._instructions.go_to(cycle)
        return core.next_wake > cycle and not core.owes_instruction and not (core.ifr and core.earliest() < NEVER)
