"""A bare serial module driven by the test: wake-ups run before each CPU access, outputs are checked after each call."""

from __future__ import annotations

from collections.abc import Mapping

from periph_sim.core.chip import Chip
from periph_sim.core.registers import Register
from tests.waves import DiagramRig


class ModuleRig(DiagramRig):
    """Rig of a serial module.

    register_of: field -> its register. A register with a single value is named like a register.
    requested: interrupt line -> the times of its requests.
    edges: (time, outputs) of each change of the outputs.
    """

    register_of: Mapping[str, Register]
    buffer: str  # the register from which words are received

    def __init__(self, chip: Chip) -> None:
        self.chip = chip
        self.now = 0
        self.requested: dict[str, list[int]] = {"RXINT": [], "TXINT": []}
        self.edges: list[tuple[int, int]] = []
        self._out = chip.out
        chip.gate(0, True)
        self.observe()

    def observe(self) -> None:
        """Record changes of the outputs and requests, as the owner of a chip does after each call."""
        chip = self.chip
        if chip.out != self._out:
            self._out = chip.out
            self.edges.append((self.now, chip.out))
        for i, line in enumerate(self.requested):
            if chip.requests >> i & 1:
                self.requested[line].append(self.now)
        chip.requests = 0

    def run_until(self, time: int) -> None:
        chip = self.chip
        while chip.next_wake <= time:
            due = chip.next_wake
            assert due >= self.now, f"the chip requests a wake-up at {due}, but it is already {self.now}"
            self.now = due
            chip.wake(due)
            self.observe()
            assert chip.next_wake > due, f"the chip requests another wake-up in cycle {due}"
        self.now = max(self.now, time)

    # Signals of a diagram.

    def drive(self, now: int, signal: str, level: int) -> None:
        """Write a register, set a field by read-modify-write, read the receive buffer (READ), SUSPEND or GATE."""
        self.run_until(now)
        if signal == "READ":
            self.read(self.buffer)
        elif signal == "SUSPEND":
            self.chip.suspend(now, bool(level))
        elif signal == "GATE":
            self.chip.gate(now, bool(level))
        elif signal in self.chip.MAP:
            self.write(signal, level)
        else:
            self.set(**{signal: level})
        self.observe()

    def received(self, wait: float = 0, mask: int = 0xFFFF) -> list[int]:
        """Wait for a number of bits, then read all words in the receive FIFO, and return them masked, oldest first."""
        self.wait(wait)
        return [self.read(self.buffer) & mask for _ in range(self.get("RXFFST"))]

    def wait(self, bits: float = 0, *, cycles: int = 0) -> None:
        raise NotImplementedError

    # Registers.

    def write(self, register: str, *values: int) -> None:
        """Write values to a register, one after the other."""
        for value in values:
            self.run_until(self.now)
            self.chip.write(self.now, self.chip.MAP[register].offset, value)
            self.observe()

    def read(self, register: str) -> int:
        self.run_until(self.now)
        value = self.chip.read(self.now, self.chip.MAP[register].offset)
        self.observe()
        return value

    def peek(self, register: str) -> int:
        return self.chip.peek(self.now, self.chip.MAP[register].offset)

    def set(self, **fields: int) -> None:
        """Change fields with one read-modify-write access for each register."""
        for register in self.chip.MAP:
            names = [name for name in fields if self.register_of.get(name) is register]
            if names:
                value = self.peek(register.name)
                for name in names:
                    value = register[name].put(value, fields[name])
                self.write(register.name, value)

    def get(self, name: str) -> int:
        """Return a field or a whole register, read without side effects."""
        if name in self.chip.MAP:
            return self.peek(name)
        register = self.register_of[name]
        return register[name].extract(self.peek(register.name))

    def status(self, name: str) -> int:
        """Return a field from a CPU read of its register, with its side effects."""
        register = self.register_of[name]
        return register[name].extract(self.read(register.name))

    def flags(self, *names: str) -> dict[str, int]:
        return {name: self.get(name) for name in names}

    def count(self, line: str) -> int:
        return len(self.requested[line])

    def notes(self, code: str = "duty") -> list[str]:
        return [note.text for note in self.chip.notes if note.code == code]
