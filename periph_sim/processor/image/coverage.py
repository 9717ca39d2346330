"""Coverage of an image: executions of each instruction, and taken jumps."""

from __future__ import annotations

from collections import Counter

from ..c28x.execution.cpu import Cpu, Operation
from .instruction_watch import InstructionWatch


class Coverage(InstructionWatch):
    """executed_at: executions by address. jumped_at: executions after which the next address did not follow."""

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
