"""Instructions of Python firmware between two accesses: cycles, and interrupts at their boundaries.

    instruction, run, idle --boundary--> Processor.take_interrupt --> vector --> service routine --> Processor.iret

A service routine is called on the firmware's own stack, at the instruction boundary at which the chip would take the
interrupt.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER
from ...f28335.cpu import instruction_costs as cpu_costs
from ...f28335.cpu.compiled_code_costs import CodeCosts
from ...f28335.cpu.interrupts import CpuInterrupts
from ..cpu_time import CpuTime
from ..processor import Processor
from ..program import Stop
from .program import PythonProgram

SLEEPS = Stop.SLEEPS


@final
class Instructions:
    """busy_cycles: cycles of computations and service routines, not of waits."""

    __slots__ = ("_core", "_epilogue", "_processor", "_program", "_prologue", "_time", "busy_cycles")

    _prologue: int
    _epilogue: int

    def __init__(self, processor: Processor, program: PythonProgram, code: CodeCosts) -> None:
        self.busy_cycles = 0
        self._processor = processor
        self._program = program
        self._time: CpuTime = processor.time
        self._core: CpuInterrupts = processor.interrupts.core
        self._prologue = code.isr_prologue
        self._epilogue = code.isr_epilogue

    def instruction(self, cycles: int) -> None:
        """Execute one instruction, or an inseparable group: interrupts wait for its end."""
        time, core = self._time, self._core
        cycle = time.cycle + cycles
        if cycle >= time.lease and not self._processor.reach(cycle):
            self._program.yield_turn()
        time.cycle = cycle
        if core.ifr or core.next_wake <= cycle or core.owes_instruction:
            self.serve()

    def go_to(self, cycle: int) -> None:
        """Let time pass to `cycle`, without interrupts."""
        if not self._processor.reach(cycle):
            self._program.yield_turn()

    def run(self, cycles: int) -> None:
        """Execute straight-line code, interruptible at each cycle."""
        time, core = self._time, self._core
        end = time.cycle + cycles
        if end < time.lease and core.next_wake > end and not core.ifr and not core.owes_instruction:
            time.cycle = end
            return
        left = cycles
        while left > 0:
            if time.lands < NEVER:  # one by one until the posted writes have landed
                self.instruction(1)
                left -= 1
                continue
            began = time.cycle
            self._rest_until(began + left)
            left -= time.cycle - began
            if core.ifr or core.next_wake <= time.cycle:
                self.serve()

    def idle(self) -> None:
        """Wait in IDLE for an interrupt that IER enables; with INTM = 0 the caller serves it next."""
        time, core = self._time, self._core
        core.idle(time.cycle)
        self.go_to(time.cycle + cpu_costs.IDLE)
        while not core.idle_ends(time.cycle):
            self._rest_until(max(time.cycle, core.next_wake))
        if core.ready > time.cycle:
            self.go_to(core.ready)

    def after_main(self) -> None:
        """Run the run-time library's endless loop of exit(), a branch to itself; service routines still run."""
        time = self._time
        while True:
            began = time.cycle
            self._rest_until(NEVER)
            passes = max(1, -(-(time.cycle - began) // cpu_costs.SB_ALWAYS))
            self.go_to(began + passes * cpu_costs.SB_ALWAYS)
            self.serve()

    def _rest_until(self, cycle: int) -> None:
        """Sleep to `cycle`, or to the boundary at which an interrupt can be taken."""
        if not self._processor.rest(cycle):
            self._program.yield_turn(SLEEPS)

    def serve(self) -> None:
        """Take every interrupt that can be taken at this instruction boundary."""
        time, core = self._time, self._core
        if core.owes_instruction:
            core.instruction_done()
        number = core.next_taken(time.cycle)
        while number:
            self._call_routine(number)
            number = core.next_taken(time.cycle)

    def _call_routine(self, number: int) -> None:
        processor, program, time = self._processor, self._program, self._time
        spin, program.spin = program.spin, None
        began, busy = time.cycle, self.busy_cycles
        if not processor.take_interrupt(number):
            program.yield_turn()
        routine = program.entered
        assert routine is not None
        self.run(self._prologue)
        routine()
        self.run(self._epilogue)
        if not processor.iret():
            program.yield_turn()
        self.busy_cycles = busy + time.cycle - began
        program.spin = spin
        if spin is not None:
            spin.hold_up(time.cycle - began)
