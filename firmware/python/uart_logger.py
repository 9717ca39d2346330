"""A receiver that logs all words received on SCI-A with their error bits, and counts breaks.

    RX --> FIFO --polled--> log of words
    BRKDT (a break) --> wait until RX is high --> SW RESET, without which nothing more is received

If SW RESET is released while the line is low, the receiver takes the rest of the break for a start bit. So the logger
first waits until GPIO28 shows a high line, if the unit has the GPIO module.

Each word is read from SCIRXBUF together with its error bits. The error bits in SCIRXST stay set until SW RESET, so they
do not show which word was wrong.

Source: SPRUFZ5A Tables 2-7 (BRKDT) and 2-8 (SCIFFFE, SCIFFPE).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from periph_sim.firmware import sci_fifo_receiver
from periph_sim.processor.dsp import Dsp

LSPCLK_HZ = 37_500_000  # SYSCLKOUT/4, as after reset
FE, PE = 1 << 15, 1 << 14  # masks in SCIRXBUF
REPLAY = ("baud", "bits", "parity", "stop")  # settings that a replay sets from the capture


@dataclass
class Settings:
    """The settings that a case can give to this program: the format of the line."""

    baud: int = 115_200
    bits: Literal[1, 2, 3, 4, 5, 6, 7, 8] = 8
    parity: Literal["none", "odd", "even"] = "none"
    stop: Literal[1, 2] = 1

    @property
    def brr(self) -> int:
        """The divider for `baud`: LSPCLK / (8 * baud) - 1, rounded, from 1 to 0xFFFF."""
        return max(1, min(0xFFFF, round(Fraction(LSPCLK_HZ, 8 * self.baud)) - 1))

    @property
    def sciccr(self) -> int:
        parity = {"none": 0, "odd": 0x20, "even": 0x60}[self.parity]
        return (self.stop - 1) << 7 | parity | self.bits - 1


class Logger:
    """The receiver with its log. words: the words as read from SCIRXBUF, error bits included."""

    def __init__(self, dsp: Dsp, settings: Settings) -> None:
        self.dsp = dsp
        self.sci = dsp.module("SCI-A")
        self.settings = settings
        self.words: list[int] = []
        self.breaks = 0

    def run(self) -> None:
        dsp, sci = self.dsp, self.sci
        sci_fifo_receiver(dsp, self.settings.brr, 1, self.settings.sciccr)
        while True:
            broken = dsp.spin_either(lambda: sci.SCIFFRX.RXFFST > 0, lambda: sci.SCIRXST.BRKDT == 1)
            while sci.SCIFFRX.RXFFST > 0:
                self.words.append(sci.SCIRXBUF.all)
            if broken:
                self.break_over()

    def break_over(self) -> None:
        dsp, sci = self.dsp, self.sci
        self.breaks += 1
        if dsp.has("GPIO"):
            gpio = dsp.module("GPIO")
            dsp.spin(lambda: gpio.GPADAT.GPIO28 == 1)
        sci.SCICTL1.SWRESET = 0
        sci.SCICTL1.SWRESET = 1


def main(dsp: Dsp, settings: Settings) -> None:
    Logger(dsp, settings).run()
