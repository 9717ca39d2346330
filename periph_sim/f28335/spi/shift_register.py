"""SPIDAT and its bit counter, which shift words out and in at the edges of SPICLK.

    word --load--> SPIDAT: bit 15 --> level        CLK_PHASE   leading edge   trailing edge
    data input --> bit 0                           0           output         latch
                                                   1           latch          output (first bit: before, `present`)

The leading edge leaves the idle level of SPICLK, the trailing edge returns to it.

Source: TI SPRUEU3 sections 1.4.2, 1.4.3 and 2.1.8.
"""

from __future__ import annotations

from ...core.state import State


class SpiShifter:
    """Shift register of both directions.

    dat: SPIDAT.
    level: the serial data output.
    bits: number of latched bits of the present character.
    loaded: SPIDAT holds a character to send.
    length: number of bits of a character.
    delayed: CLK_PHASE.
    """

    STATE = State("dat level length delayed bits loaded")

    def __init__(self) -> None:
        self.dat = self.level = 0
        self.length = 1
        self.delayed = False
        self.bits = 0
        self.loaded = False

    @property
    def busy(self) -> bool:
        """True if the next character has to wait for this one."""
        return self.loaded or self.bits > 0

    @property
    def complete(self) -> bool:
        """True if all bits of the character have been latched."""
        return self.bits >= self.length

    def load(self, word: int) -> None:
        """Load a character to send."""
        self.dat = word
        self.loaded = True

    def present(self) -> None:
        """Put out the first bit before the first edge, if CLK_PHASE = 1."""
        if self.delayed:
            self.level = self.dat >> 15

    def edge(self, leading: bool, data: int) -> None:
        """Shift at an edge of SPICLK, with the level at the data input."""
        if leading == self.delayed:
            self.dat = (self.dat << 1 | data) & 0xFFFF
            self.bits += 1
        else:
            self.level = self.dat >> 15

    def finish(self) -> None:
        """End the character; the bits shifted in stay in SPIDAT."""
        self.bits = 0
        self.loaded = False
