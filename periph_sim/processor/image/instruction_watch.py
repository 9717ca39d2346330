"""Who looks at each instruction of an image: what was executed, with registers and time behind it, goes in."""

from __future__ import annotations

from ...c28x.execution.registers import Cpu, Operation
from ...core.state import State


class InstructionWatch:
    """beside: who else looks."""

    STATE = State("beside")

    def __init__(self) -> None:
        self.beside: InstructionWatch | None = None

    def executed(self, f: Operation, cpu: Cpu, cycle: int) -> None:
        """An instruction, or a pass of a repeated one, is done. cycle: when the next one begins."""
        if self.beside is not None:
            self.beside.executed(f, cpu, cycle)
