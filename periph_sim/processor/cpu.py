"""Runs firmware written as plain Python functions, and makes it pay its cycles.

    firmware --> accesses, compute, spin --> cycles on this CPU's clock --> kernel, chips
                                        ^--- interrupts at instruction boundaries

Each layer is a file: `cpu_time` lets time pass, `interruptible_cpu` takes interrupts, `register_access` reads and
writes. Here the CPU waits.

Waiting is skipped: a pass of a spin whose reads have no side effect is made once; it cannot come out otherwise before a
register that it read changes or an interrupt is due. At that moment the pass in progress is replayed from its start,
reads that lie in the past answering with what was read before, and goes on for real from there. So a spin ends at the
cycle at which polling pass by pass would have ended, at the cost of one event.
"""

from __future__ import annotations

from collections.abc import Callable

from ..core.chip import NEVER
from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.time import Clock
from ..f28335.cpu import instruction_costs as cpu_costs
from ..f28335.cpu.compiled_code_costs import BARE, CodeCosts
from ..f28335.cpu.interrupts import CpuInterrupts
from ..f28335.cpu.pie import Pie
from ..f28335.system.memory_map import AddressMap
from ..f28335.system.options import SystemOptions
from .polling import Lease, Spin
from .register_access import RegisterAccess


class Cpu(RegisterAccess):
    """One C28x with its firmware. polls_skipped: passes of waits that were not made for real.

    skip_polls: False makes every pass of every spin for real (the brute force that the skipping is proven against).
    """

    __slots__ = ("_branch", "_skip_polls", "polls_skipped")

    def __init__(
        self,
        kernel: Kernel,
        clock: Clock,
        recorder: Recorder,
        name: str,
        memory: AddressMap,
        core: CpuInterrupts,
        pie: Pie,
        options: SystemOptions,
        *,
        code: CodeCosts = BARE,
        skip_polls: bool = True,
        strict: bool = False,
    ) -> None:
        super().__init__(kernel, clock, recorder, name, memory, core, pie, options, code, strict)
        self.polls_skipped = 0
        self._branch = max(0, code.poll_pass - cpu_costs.SIMPLE - options.pf2_read_ws)
        self._skip_polls = skip_polls

    def spin(self, condition: Callable[[], object], pass_cycles: int | None = None, timeout: int | None = None) -> bool:
        """`while (!condition()) ;` as the compiler makes it: passes of reads, their tests and the branch back.

        True as soon as the condition holds; False at the end of the first pass by which `timeout` cycles have passed
        since the wait began, interrupts included. pass_cycles: what a pass takes in all, if its reads take no longer.
        """
        spin = Spin(self.cycle, pass_cycles, NEVER if timeout is None else self.cycle + timeout)
        outer, self.spin_now = self.spin_now, spin
        polled = ""
        while True:
            spin.begin_pass(self.cycle)
            came = bool(condition())
            if came:
                break
            if self._records_wait and not polled:
                polled = spin.waits_for() or "nothing"
                self._record_wait(spin.since, polled, 1)
            self.instruction(spin.rest(self.cycle, self._branch))
            if self._skip_polls and spin.pure and spin.polls and self.cycle < spin.ends:
                self._skip(spin)
            if self.cycle >= spin.ends:
                break
        if polled:
            self._record_wait(self.cycle, polled, 0)
        self.instruction(cpu_costs.SB_NOT_TAKEN)
        self.spin_now = outer
        return came

    def _skip(self, spin: Spin) -> None:
        """Sleep over the passes that must come out as this one did, and set up the replay of the one in progress."""
        if self.core.earliest() < NEVER or self._lands < NEVER:
            return
        lease = Lease(self, spin)
        if lease.broken(self.cycle):
            return
        first = self.cycle
        period = first - spin.start
        for socket in lease.sockets:
            socket.watch(lease.look)
        if spin.ends < NEVER:
            self._wake_at(first - (first - spin.ends) // period * period)  # the end of the pass that times out
        self._interruptible = True
        try:
            self._sleep()
        finally:  # a reset ends the firmware here
            for socket in lease.sockets:
                socket.unwatch(lease.look)
        self._interruptible = False
        woken = max(first, self._clock.cycle_at(self._kernel.now))
        skipped = (woken - first) // period
        self.polls_skipped += skipped
        self.cycle = first + skipped * period
        spin.replay, spin.replayed, spin.live_from = spin.polls, 0, woken
        if self.core.ifr or self.core.next_wake <= self.cycle:  # the end of the branch back is a boundary, too
            self._serve()
