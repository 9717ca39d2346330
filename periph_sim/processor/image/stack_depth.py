"""Stack depth of an image: a record of each new maximum, in words.

The stack is the section `.stack`; SP elsewhere is the stack of a task, which does not count. The 14 words that an
interrupt saves count from its routine's first instruction on.
"""

from __future__ import annotations

from collections.abc import Callable

from ...core.records import Kind, Recorder
from ...core.state import State
from ...core.time import Clock
from ..c28x.execution.cpu import Cpu, Operation
from ..image_files.model import Section
from .instruction_watch import InstructionWatch

SECTION = ".stack"
STACK = "stack"  # instead of a register's name
CPU = "CPU"  # instead of a module's name


class StackDepth(InstructionWatch):
    STATE = State("_deepest")

    def __init__(
        self, section: Section, recorder: Recorder, clock: Clock, unit: str, place: Callable[[], str | None]
    ) -> None:
        """place: returns that of the executed instruction."""
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
