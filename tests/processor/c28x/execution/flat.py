"""A C28x with plain memory and nothing else, to run a few instructions and examine registers and memory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from periph_sim.processor.c28x.assembler import parse
from periph_sim.processor.c28x.execution.engine import Engine


class Flat(Engine):
    """A CPU whose memory reads as 0 where nothing was written."""

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
        """Set XARn by number; a compiled CPU returns copies of its register files, so they are assigned as a whole."""
        self.xar = [values.get(n, before) for n, before in enumerate(self.xar)]

    def put_floats(self, values: Mapping[int, int]) -> None:
        """Set RnH, as bits, by number."""
        self.r = [values.get(n, before) for n, before in enumerate(self.r)]


def loaded(source: str, at: int = 0x8000) -> Flat:
    """Return a CPU with this assembly, one instruction per line, in memory at `at`, where its PC is."""
    cpu = Flat()
    cpu.pc = at
    for line in filter(None, (line.strip() for line in source.splitlines())):
        words: Sequence[int] = parse(line, at, {}).words(at, {})
        for word in words:
            cpu.memory[at] = word
            at += 1
    return cpu


def ran(source: str, **registers: int) -> tuple[Flat, int]:
    """Run the source up to the ESTOP0 behind it; return the CPU and the cycles that it took."""
    cpu = loaded(f"{source}\nESTOP0")
    for name, value in registers.items():
        setattr(cpu, name, value)
    cycles = 0
    while not cpu.stopped:
        assert cycles < 100_000
        taken = cpu.step()
        cycles += 0 if cpu.stopped else taken
    return cpu, cycles
