"""Observer of each instruction of an image, called after it with registers and time."""

from __future__ import annotations

from ...core.state import State
from ..c28x.execution.cpu import Cpu, Operation


class InstructionWatch:
    """beside: the next observer."""

    STATE = State("beside")

    def __init__(self) -> None:
        self.beside: InstructionWatch | None = None

    def executed(self, f: Operation, cpu: Cpu, cycle: int) -> None:
        """Receive an executed instruction, or a pass of a repeated one. cycle: begin of the next one."""
        if self.beside is not None:
            self.beside.executed(f, cpu, cycle)
