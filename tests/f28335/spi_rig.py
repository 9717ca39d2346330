"""Rigs of one SPI module or of several on the same wires, and a simple SPI master and decoder to compare with.

`SpiRig` is one module whose inputs the test drives. `Wires` connects the pins of several modules. `decode` reads the
characters from recorded edges and shares no code with the model.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Self

from periph_sim.core.options import options_from
from periph_sim.f28335.spi.module import Spi
from periph_sim.f28335.spi.options import SpiOptions
from periph_sim.f28335.spi.register_map import SPI_MAP
from tests.f28335.module_rig import ModuleRig

LSPCLK = 4  # SYSCLKOUT cycles
BIT = 4 * LSPCLK  # at SPIBRR = 3
HALF = BIT // 2
PINS = ("SIMO", "SOMI", "CLK", "STE")
HIGH = 0b1111

# Field -> its register. Registers with a single value (SPIBRR, SPITXBUF, ...) are named like registers.
REGISTER_OF = {f.name: r for r in SPI_MAP for f in r.fields}

MASTER = {"SPICHAR": 7, "SPISWRESET": 1, "MASTER_SLAVE": 1, "TALK": 1, "SPIBRR": 3}
SLAVE = {"SPICHAR": 7, "SPISWRESET": 1, "TALK": 1}
FIFO = {"SPIRST": 1, "SPIFFENA": 1, "TXFIFO": 1, "RXFIFORESET": 1}
SCHEMES = [(polarity, phase) for polarity in (0, 1) for phase in (0, 1)]


class SpiRig(ModuleRig):
    """A rig of one module. It begins one cycle before an LSPCLK edge, so a transfer begins in the column of its write.

    options: option -> value.
    setting: MASTER or SLAVE.
    fields: further fields or whole registers, by name.
    """

    chip: Spi
    register_of = REGISTER_OF
    buffer = "SPIRXBUF"

    def __init__(
        self,
        options: dict[str, str | int | bool] | None = None,
        setting: dict[str, int] = MASTER,
        /,
        *,
        fifo: bool = False,
        **fields: int,
    ) -> None:
        super().__init__(Spi(options=options_from(SpiOptions, options or {})))
        self.levels = HIGH
        together = {**setting, **(FIFO if fifo else {}), **fields}
        released = together.pop("SPISWRESET", 0)
        if together.pop("CLKPOLARITY", 0):
            self.set(CLKPOLARITY=1)
        for name, value in together.items():
            ModuleRig.drive(self, self.now, name, value)
        self.set(SPISWRESET=released)
        self.run_until(8 * LSPCLK - 1)
        self.edges = [(self.now, self.chip.out)]  # after the set-up

    # Time.

    def wait(self, bits: float = 0, *, cycles: int = 0) -> None:
        self.run_until(self.now + round(bits * BIT) + cycles)

    # Signals of a diagram.

    def columns(self) -> tuple[int, int]:
        return HALF, self.now

    def drive(self, now: int, signal: str, level: int) -> None:
        """Set a pin, or a signal that every module has.

        The digit of SPITXBUF or SPIDAT is the four upper bits of the word: a character of four bits.
        """
        if signal in PINS:
            self.pin(now, **{signal: level})
        else:
            super().drive(now, signal, level << 12 if signal in ("SPITXBUF", "SPIDAT") else level)

    def pin(self, now: int, **levels: int) -> None:
        """Change inputs of the chip."""
        self.run_until(now - 1)
        self.now = now
        for name, level in levels.items():
            bit = 1 << PINS.index(name)
            self.levels = self.levels & ~bit | level * bit
        self.chip.pins(now, self.levels)
        self.observe()

    def show(self, signal: str) -> int:
        """Return an output, whether it is driven ("SIMO?"), a number of requests (RXINT, TXINT), a field or a register.

        The result is reduced to the lower four bits of fields and registers such as SPIRXBUF and SPIDAT.
        """
        if signal in PINS:
            return self.chip.out >> PINS.index(signal) & 1
        if signal.endswith("?"):
            return self.chip.driven >> PINS.index(signal[:-1]) & 1
        if signal in self.requested:
            return len(self.requested[signal]) % 16
        return self.get(signal) & 0xF

    def send(self, word: int, bits: float) -> None:
        """Write SPITXBUF, and wait for a number of bits."""
        self.write("SPITXBUF", word)
        self.wait(bits)

    # A simple master for a module that is a slave.

    def select(self, low: bool = True) -> None:
        self.pin(self.now + HALF, STE=0 if low else 1)

    def select_idle(self) -> Self:
        """Set SPICLK to 0, its idle level with CLKPOLARITY = 0, and then SPISTE to 0."""
        self.pin(self.now, CLK=0)
        self.select()
        return self

    def clock(self, bits: str, half: int = HALF) -> list[int]:
        """Make a period of SPICLK for each bit of SPISIMO, and return the levels of SPISOMI that a master latches.

        half: cycles of half a period.
        """
        polarity, phase = self.get("CLKPOLARITY"), self.get("CLK_PHASE")
        came = []
        for bit in bits:
            begin, data = self.now, {"SIMO": int(bit)}
            if phase:  # the bit is output half a period before the leading edge
                self.pin(begin + 1, **data)
            self.run_until(begin + half - 1)
            if phase:
                came.append(self.show("SOMI"))
            self.pin(begin + half, CLK=1 - polarity, **({} if phase else data))
            self.run_until(begin + 2 * half - 1)
            if not phase:
                came.append(self.show("SOMI"))
            self.pin(begin + 2 * half, CLK=polarity)
        return came

    def exchange(self, word: int, bits: int = 8, half: int = HALF) -> int:
        """Send a character from the simple master, most significant bit first, and return the one that it receives."""
        came = self.clock(f"{word:0{bits}b}", half)
        return int("".join(map(str, came)), 2)


class Wires:
    """Connected modules: a wire is 0 if any module drives it to 0. history: (time, levels of the wires)."""

    def __init__(self, *rigs: SpiRig) -> None:
        self.rigs = rigs
        self.now = max(rig.now for rig in rigs)
        self.history: list[tuple[int, int]] = []
        self.settle()

    def settle(self) -> None:
        """Pass the levels of the wires to all modules until no module changes its outputs."""
        while True:
            levels = HIGH
            for rig in self.rigs:
                levels &= rig.chip.out
            if self.history and self.history[-1][1] == levels:
                return
            self.history.append((self.now, levels))
            for rig in self.rigs:
                rig.now = self.now
                rig.chip.pins(self.now, levels)
                rig.observe()

    def run_until(self, time: int) -> None:
        while (due := min(rig.chip.next_wake for rig in self.rigs)) <= time:
            self.now = due
            for rig in self.rigs:
                rig.now = due
                if rig.chip.next_wake == due:
                    rig.chip.wake(due)
                    rig.observe()
            self.settle()
        self.now = time
        for rig in self.rigs:
            rig.now = time

    def wait(self, bits: float) -> None:
        self.run_until(self.now + round(bits * BIT))

    def write(self, rig: SpiRig, register: str, value: int) -> None:
        rig.write(register, value)
        self.settle()


def decode(history: Sequence[tuple[int, int]], polarity: int, phase: int, bits: int) -> tuple[list[int], list[int]]:
    """Return the characters on SIMO and on SOMI, like a logic analyser; an incomplete last character is ignored.

    history: (time, levels); bits 0 to 3 of the levels are SIMO, SOMI, CLK and STE. Edges count while STE is 0.
    """
    streams: tuple[list[int], list[int]] = ([], [])
    for (_, before), (_, after) in itertools.pairwise(history):
        clock = after >> 2 & 1
        edge = clock != before >> 2 & 1 and not before >> 3 & 1
        latches = clock == polarity if phase == 0 else clock != polarity
        if edge and latches:
            for i, stream in enumerate(streams):
                stream.append(before >> i & 1)  # the level just before the edge
    words = [[0] * (len(stream) // bits) for stream in streams]
    for stream, found in zip(streams, words, strict=True):
        for n, bit in enumerate(stream[: len(found) * bits]):
            found[n // bits] = found[n // bits] << 1 | bit
    return words[0], words[1]
