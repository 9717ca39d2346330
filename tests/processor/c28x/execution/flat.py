"""A C28x on memory that is nothing but memory: words go in; registers and memory after a program come out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from periph_sim.processor.c28x.assembler import parse
from periph_sim.processor.c28x.execution.engine import Engine


class Flat(Engine):
    """Memory that nobody wrote is 0."""

    def __init__(self) -> None:
        super().__init__()
        self.memory: dict[int, int] = {}
        self.stopped = False

    def load16(self, address: int) -> int:
        return self.memory.get(address, 0)

    def store16(self, address: int, value: int) -> None:
        assert 0 <= value <= 0xFFFF, f"{value:#x} at {address:#x}"
        self.memory[address] = value
        self.written(address)

    def stop(self) -> None:
        self.stopped = True

    def put_xars(self, values: Mapping[int, int]) -> None:
        """XARn by their numbers. A compiled CPU hands out copies of its register files."""
        self.xar = [values.get(n, before) for n, before in enumerate(self.xar)]

    def put_floats(self, values: Mapping[int, int]) -> None:
        """RnH, as bits, by their numbers."""
        self.r = [values.get(n, before) for n, before in enumerate(self.r)]


def loaded(source: str, at: int = 0x8000) -> Flat:
    """Assembly, a line an instruction, at an address; PC is there."""
    cpu = Flat()
    cpu.pc = at
    for line in filter(None, (line.strip() for line in source.splitlines())):
        words: Sequence[int] = parse(line, at, {}).words(at, {})
        for word in words:
            cpu.memory[at] = word
            at += 1
    return cpu


def ran(source: str, **registers: int) -> tuple[Flat, int]:
    """The CPU when it comes to ESTOP0 behind the source, and the cycles up to there."""
    cpu = loaded(f"{source}\nESTOP0")
    for name, value in registers.items():
        setattr(cpu, name, value)
    cycles = 0
    while not cpu.stopped:
        assert cycles < 100_000
        taken = cpu.step()
        cycles += 0 if cpu.stopped else taken
    return cpu, cycles
