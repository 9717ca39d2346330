"""`while (!condition()) ;` of Python firmware: a condition goes in; the cycle comes at which polling would have ended.

Waiting is skipped: a pass of a spin whose reads have no side effect is made once; it cannot come out otherwise before a
register that it read changes or an interrupt is due. At that moment the pass in progress is replayed from its start,
reads that lie in the past answering with what was read before, and goes on for real from there. So a spin ends at the
cycle at which polling pass by pass would have ended, at the cost of one event.
"""

from __future__ import annotations

from collections.abc import Callable

from ...core.chip import NEVER
from ...f28335.cpu import instruction_costs as cpu_costs
from ..cpu_time import CpuTime
from ..polling import Lease, Spin
from ..processor import Processor
from ..program import Stop
from .code_records import CodeRecords
from .instructions import Instructions
from .program import PythonProgram


class Waits:
    """skip_polls: False makes every pass of every spin for real (the brute force that the skipping is proven against).

    branch: cycles of the branch back to the begin of a pass.
    """

    __slots__ = ("_branch", "_core", "_instructions", "_program", "_records", "_skip_polls", "_time")

    def __init__(
        self,
        processor: Processor,
        program: PythonProgram,
        instructions: Instructions,
        records: CodeRecords,
        *,
        branch: int,
        skip_polls: bool,
    ) -> None:
        self._branch = branch
        self._core = processor.interrupts.core
        self._instructions = instructions
        self._program = program
        self._records = records
        self._skip_polls = skip_polls
        self._time: CpuTime = processor.time

    def spin(self, condition: Callable[[], object], pass_cycles: int | None = None, timeout: int | None = None) -> bool:
        """`while (!condition()) ;` as the compiler makes it: passes of reads, their tests and the branch back.

        True as soon as the condition holds; False at the end of the first pass by which `timeout` cycles have passed
        since the wait began, interrupts included. pass_cycles: what a pass takes in all, if its reads take no longer.
        """
        time, program, instructions, records = self._time, self._program, self._instructions, self._records
        spin = Spin(time.cycle, pass_cycles, NEVER if timeout is None else time.cycle + timeout)
        outer, program.spin = program.spin, spin
        polled = ""
        while True:
            spin.begin_pass(time.cycle)
            came = bool(condition())
            if came:
                break
            if records.waits and not polled:
                polled = spin.waits_for() or "nothing"
                records.wait(spin.since, polled, 1)
            instructions.instruction(spin.rest(time.cycle, self._branch))
            if self._skip_polls and spin.pure and spin.polls and time.cycle < spin.ends:
                self._skip(spin)
            if time.cycle >= spin.ends:
                break
        if polled:
            records.wait(time.cycle, polled, 0)
        instructions.instruction(cpu_costs.SB_NOT_TAKEN)
        program.spin = outer
        return came

    def _skip(self, spin: Spin) -> None:
        """Sleep over the passes that must come out as this one did, and set up the replay of the one in progress."""
        time, core = self._time, self._core
        if core.earliest() < NEVER or time.lands < NEVER:
            return
        lease = Lease(time, spin)
        if lease.broken(time.cycle):
            return
        first = time.cycle
        period = first - spin.start
        lease.begin()
        if spin.ends < NEVER:
            time.wake_at(first - (first - spin.ends) // period * period)  # the end of the pass that times out
        time.sleep(NEVER)
        try:
            self._program.give_way(Stop.SLEEPS)
        finally:  # a reset ends the firmware here
            lease.end()
        woken = time.cycle
        skipped = (woken - first) // period
        self._program.polls_skipped += skipped
        time.cycle = first + skipped * period
        spin.replay, spin.replayed, spin.live_from = spin.values, 0, woken
        if core.ifr or core.next_wake <= time.cycle:  # the end of the branch back is a boundary, too
            self._instructions.serve()
