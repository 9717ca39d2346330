"""An SPI module, or several on the same wires, as their owner drives them; and an SPI of a few lines to compare with.

`SpiRig` is one module whose inputs the test drives. `Wires` joins modules pin to pin. `decode` reads recorded edges
and shares no code with the model.
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

# Which register a field is in. Registers of one value (SPIBRR, SPITXBUF, ...) are named as registers.
REGISTER_OF = {f.name: r for r in SPI_MAP for f in r.fields}

MASTER = {"SPICHAR": 7, "SPISWRESET": 1, "MASTER_SLAVE": 1, "TALK": 1, "SPIBRR": 3}
SLAVE = {"SPICHAR": 7, "SPISWRESET": 1, "TALK": 1}
FIFO = {"SPIRST": 1, "SPIFFENA": 1, "TXFIFO": 1, "RXFIFORESET": 1}
SCHEMES = [(polarity, phase) for polarity in (0, 1) for phase in (0, 1)]


class SpiRig(ModuleRig):
    """options: open questions by name. setting: MASTER or SLAVE. fields: fields or whole registers, beside these.

    The rig begins one cycle before an LSPCLK edge, so that a transfer begins in the column of its write.
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
        """A pin, or as for any module.

        SPITXBUF and SPIDAT take the digit as their upper four bits: a character of four bits.
        """
        if signal in PINS:
            self.pin(now, **{signal: level})
        else:
            super().drive(now, signal, level << 12 if signal in ("SPITXBUF", "SPIDAT") else level)

    def pin(self, now: int, **levels: int) -> None:
        """Drive inputs."""
        self.run_until(now - 1)
        self.now = now
        for name, level in levels.items():
            bit = 1 << PINS.index(name)
            self.levels = self.levels & ~bit | level * bit
        self.chip.pins(now, self.levels)
        self.look()

    def show(self, signal: str) -> int:
        """An output; "SIMO?" whether it is driven; RXINT or TXINT: how often asked for; a field; a register.

        Of SPIRXBUF and SPIDAT the lower four bits.
        """
        if signal in PINS:
            return self.chip.out >> PINS.index(signal) & 1
        if signal.endswith("?"):
            return self.chip.driven >> PINS.index(signal[:-1]) & 1
        if signal in self.asked:
            return len(self.asked[signal]) % 16
        return self.get(signal) & 0xF

    def send(self, word: int, bits: float) -> None:
        """Write SPITXBUF, and wait for so many bits."""
        self.write("SPITXBUF", word)
        self.wait(bits)

    # A master that is no module, for a slave.

    def select(self, low: bool = True) -> None:
        self.pin(self.now + HALF, STE=0 if low else 1)

    def select_idle(self) -> Self:
        """SPICLK goes to 0, its idle level with CLKPOLARITY = 0; then SPISTE falls."""
        self.pin(self.now, CLK=0)
        self.select()
        return self

    def clock(self, bits: str, half: int = HALF) -> list[int]:
        """Make a period of SPICLK for each bit, which SPISIMO has; return SPISOMI as a master would latch it.

        half: cycles of half a period.
        """
        polarity, phase = self.get("CLKPOLARITY"), self.get("CLK_PHASE")
        came = []
        for bit in bits:
            begin, data = self.now, {"SIMO": int(bit)}
            if phase:  # the bit is there half a period before the leading edge
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
        """One character from a master that is no module, most significant bit first: what it gets back."""
        came = self.clock(f"{word:0{bits}b}", half)
        return int("".join(map(str, came)), 2)


class Wires:
    """Modules joined pin to pin: a wire is 0 if any of them drives it to 0. history: (time, levels) of the wires."""

    def __init__(self, *rigs: SpiRig) -> None:
        self.rigs = rigs
        self.now = max(rig.now for rig in rigs)
        self.history: list[tuple[int, int]] = []
        self.settle()

    def settle(self) -> None:
        """Show the wires to all modules until none changes its outputs."""
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
                rig.look()

    def run_until(self, time: int) -> None:
        while (due := min(rig.chip.next_wake for rig in self.rigs)) <= time:
            self.now = due
            for rig in self.rigs:
                rig.now = due
                if rig.chip.next_wake == due:
                    rig.chip.wake(due)
                    rig.look()
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
    """The characters on SIMO and on SOMI, as a logic analyser reads them while STE is 0; bits over at the end are left.

    history: (time, levels), levels as bits SIMO, SOMI, CLK, STE from bit 0 on.
    """
    streams: tuple[list[int], list[int]] = ([], [])
    for (_, before), (_, after) in itertools.pairwise(history):
        clock = after >> 2 & 1
        edge = clock != before >> 2 & 1 and not before >> 3 & 1
        latches = clock == polarity if phase == 0 else clock != polarity
        if edge and latches:
            for i, stream in enumerate(streams):
                stream.append(before >> i & 1)  # as it was up to the edge
    words = [[0] * (len(stream) // bits) for stream in streams]
    for stream, found in zip(streams, words, strict=True):
        for n, bit in enumerate(stream[: len(found) * bits]):
            found[n // bits] = found[n // bits] << 1 | bit
    return words[0], words[1]
