"""A bare serial module as its owner drives it: wake-ups, then the CPU; outputs are looked at after every call."""

from __future__ import annotations

from collections.abc import Mapping

from periph_sim.core.chip import Chip
from periph_sim.core.registers import Register
from tests.waves import DiagramRig


class ModuleRig(DiagramRig):
    """register_of: which register a field is in. Registers of one value are named as registers.

    asked: when each interrupt line was asked for. edges: (time, outputs) of each change of the outputs.
    """

    register_of: Mapping[str, Register]
    buffer: str  # the register from which words are received

    def __init__(self, chip: Chip) -> None:
        self.chip = chip
        self.now = 0
        self.asked: dict[str, list[int]] = {"RXINT": [], "TXINT": []}
        self.edges: list[tuple[int, int]] = []
        self._out = chip.out
        chip.gate(0, True)
        self.look()

    def look(self) -> None:
        """Do what the owner of a chip does after each call."""
        chip = self.chip
        if chip.out != self._out:
            self._out = chip.out
            self.edges.append((self.now, chip.out))
        for i, line in enumerate(self.asked):
            if chip.requests >> i & 1:
                self.asked[line].append(self.now)
        chip.requests = 0

    def run_until(self, time: int) -> None:
        chip = self.chip
        while chip.next_wake <= time:
            due = chip.next_wake
            assert due >= self.now, f"asks to be woken at {due}, but it is already {self.now}"
            self.now = due
            chip.wake(due)
            self.look()
            assert chip.next_wake > due, f"asks to be woken again in cycle {due}"
        self.now = max(self.now, time)

    # Signals of a diagram.

    def drive(self, now: int, signal: str, level: int) -> None:
        """A register (written); a field (read-modify-write); "READ" (the receive buffer); "SUSPEND"; "GATE"."""
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
        self.look()

    def received(self, wait: float = 0, mask: int = 0xFFFF) -> list[int]:
        """All words in the receive FIFO after so many bits, taken out, oldest first; of each the bits of a mask."""
        self.wait(wait)
        return [self.read(self.buffer) & mask for _ in range(self.get("RXFFST"))]

    def wait(self, bits: float = 0, *, cycles: int = 0) -> None:
        raise NotImplementedError

    # Registers.

    def write(self, register: str, *values: int) -> None:
        """One value after the other."""
        for value in values:
            self.run_until(self.now)
            self.chip.write(self.now, self.chip.MAP[register].offset, value)
            self.look()

    def read(self, register: str) -> int:
        self.run_until(self.now)
        value = self.chip.read(self.now, self.chip.MAP[register].offset)
        self.look()
        return value

    def peek(self, register: str) -> int:
        return self.chip.peek(self.now, self.chip.MAP[register].offset)

    def set(self, **fields: int) -> None:
        """One read-modify-write for each register that the fields are in."""
        for register in self.chip.MAP:
            names = [name for name in fields if self.register_of.get(name) is register]
            if names:
                value = self.peek(register.name)
                for name in names:
                    value = register[name].put(value, fields[name])
                self.write(register.name, value)

    def get(self, name: str) -> int:
        """A field or a whole register, looked at without side effects."""
        if name in self.chip.MAP:
            return self.peek(name)
        register = self.register_of[name]
        return register[name].extract(self.peek(register.name))

    def status(self, name: str) -> int:
        """A field as the CPU reads it."""
        register = self.register_of[name]
        return register[name].extract(self.read(register.name))

    def flags(self, *names: str) -> dict[str, int]:
        return {name: self.get(name) for name in names}

    def count(self, line: str) -> int:
        return len(self.asked[line])

    def notes(self, code: str = "duty") -> list[str]:
        return [note.text for note in self.chip.notes if note.code == code]
