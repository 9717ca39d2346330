"""A program other than Python firmware: steps of code by address, executed in a loop without greenlets."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

from periph_sim.core.chip import NEVER
from periph_sim.processor.processor import Processor, Program

ST0, AL, PC_LOW, PC_HIGH = 0, 2, 12, 13  # words of the context


class Op(Enum):
    WORK = "cycles pass"
    LOAD = "AL is loaded"
    LOAD_LONG = "AL is loaded with the low half of 32 bits"
    STORE = "a value is written"
    SET = "AL is set to a value"
    IRET = "the service routine returns"


class Step(NamedTuple):
    """A step of the code.

    number: cycles, or the value.
    width: of the access.
    """

    op: Op
    address: int = 0
    number: int = 1


BOUNDARY, ACCESS, END = range(3)


class ScriptedProgram(Program):
    """A program for a processor.

    code: steps by address.
    pc, al, st0: its registers.
    seen: loaded values, with their cycles.
    entered: vectors, with their cycles.
    runs: the cycles in which `run` returned.
    """

    def __init__(self, processor: Processor, code: dict[int, list[Step]], pc: int) -> None:
        super().__init__()
        self.pc = pc
        self.al = self.st0 = 0
        self.seen: list[tuple[int, int]] = []
        self.entered: list[tuple[int, int]] = []
        self.runs: list[int] = []
        self._code = {begin + i: step for begin, steps in code.items() for i, step in enumerate(steps)}
        self._processor = processor
        self._doing = BOUNDARY

    def run(self) -> None:
        self._execute()
        self.runs.append(self._processor.time.cycle)

    def _execute(self) -> None:
        processor, time = self._processor, self._processor.time
        while True:
            if self._doing == BOUNDARY:
                number = processor.core.next_taken(time.cycle)
                if number:
                    if not processor.take_interrupt(number):
                        return
                    continue
                if self.pc not in self._code:
                    self._end()
                    return
                self._doing = ACCESS
                if not processor.reach(self._access_at(self._code[self.pc])):
                    return
            if self._doing == ACCESS:
                step = self._code[self.pc]
                self._doing = END
                if step.op is Op.IRET:
                    self._doing = BOUNDARY
                    if not processor.iret():
                        return
                    continue
                if not processor.reach(time.cycle + self._make(step)):
                    return
            self.pc += 1
            self._doing = BOUNDARY
            processor.core.owes_instruction = False

    def _access_at(self, step: Step) -> int:
        bus, cycle = self._processor.bus, self._processor.time.cycle
        if step.op in (Op.LOAD, Op.LOAD_LONG):
            return bus.reads_at(cycle, step.address, 32 if step.op is Op.LOAD_LONG else 16)
        return bus.writes_at(cycle, step.address) if step.op is Op.STORE else cycle

    def _make(self, step: Step) -> int:
        """Make the step's access and have its effect; return the cycles that it still takes."""
        bus, time = self._processor.bus, self._processor.time
        if step.op in (Op.LOAD, Op.LOAD_LONG):
            time.meet()
            value = bus.read(time.cycle, step.address, 32 if step.op is Op.LOAD_LONG else 16)
            self.al = value & 0xFFFF
            self.seen.append((value, time.cycle))
        elif step.op is Op.STORE:
            bus.write(time.cycle, step.address, step.number)
        elif step.op is Op.SET:
            self.al = step.number
        return step.number if step.op is Op.WORK else 1

    def _end(self) -> None:
        """End the program when all posted writes have landed."""
        time = self._processor.time
        while time.lands < NEVER:
            if not self._processor.reach(time.lands + 1):
                return
        self.returned_at = time.cycle

    def place(self) -> None:
        """Return None, since there is no statement of Python firmware."""

    def enter(self, vector: int) -> str:
        self.entered.append((vector, self._processor.time.cycle))
        self.pc = vector
        return ""

    def context(self) -> Sequence[int]:
        words = list(super().context())
        words[ST0], words[AL] = self.st0, self.al
        words[PC_LOW], words[PC_HIGH] = self.pc & 0xFFFF, self.pc >> 16
        return words

    def restore(self, words: Sequence[int]) -> None:
        self.st0, self.al = words[ST0], words[AL]
        self.pc = words[PC_LOW] | words[PC_HIGH] << 16
