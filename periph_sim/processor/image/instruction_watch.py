"""Observers of an image, called after each instruction with registers and time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from ...core.records import Kind, Recorder
from ...core.state import State
from ...core.time import Clock
from ..c28x.execution.cpu import Cpu, Operation
from ..image_files.model import Section


class InstructionWatch:
    """Base of the observers of executed instructions, which form a chain. beside: the next observer in the chain."""

    STATE = State("beside")

    def __init__(self) -> None:
        self.beside: InstructionWatch | None = None

    def executed(self, f: Operation, cpu: Cpu, cycle: int) -> None:
        """Receive an executed instruction, or a pass of a repeated one. cycle: begin of the next one."""
        if self.beside is not None:
            self.beside.executed(f, cpu, cycle)


class Coverage(InstructionWatch):
    """Coverage of an image: executions of each instruction, and taken jumps.

    executed_at: executions by address. jumped_at: executions after which the next address did not follow.
    """

    def __init__(self) -> None:
        super().__init__()
        self.executed_at: Counter[int] = Counter()
        self.jumped_at: Counter[int] = Counter()

    def executed(self, f: Operation, cpu: Cpu, cycle: int) -> None:
        if not cpu.passes:  # not a further pass of RPT
            self.executed_at[f.address] += 1
            if cpu.pc != f.next:
                self.jumped_at[f.address] += 1
        super().executed(f, cpu, cycle)


SECTION = ".stack"
STACK = "stack"  # instead of a register's name
CPU = "CPU"  # instead of a module's name


class StackDepth(InstructionWatch):
    """Stack depth of an image: a record of each new maximum, in words.

    The stack is the section `.stack`; SP elsewhere is the stack of a task, which does not count. The 14 words that an
    interrupt saves count from its first instruction on.
    """

    STATE = State("_deepest")

    def __init__(
        self, section: Section, recorder: Recorder, clock: Clock, unit: str, place: Callable[[], str | None]
    ) -> None:
        """place: returns the place of the executed instruction."""
        super().__init__()
        self._place = place
        self._begin, self._end = section.run, section.run + section.size
        self._deepest = section.run
        self._clock = clock
        self._topic = recorder.topic(Kind.FLAG, f"{unit}.{CPU}", STACK)

    def executed(self, f: Operation, cpu: Cpu, cycle: int) -> None:
        if self._deepest < cpu.sp <= self._end:
            self._deepest = cpu.sp
            self._topic.emit(self._clock.tick(cycle), cpu.sp - self._begin, self._place() or "")
        super().executed(f, cpu, cycle)
