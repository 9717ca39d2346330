"""SCI-A echo: what comes in goes out. firmware/c28x/sci_echo.asm is the same program in machine code.

TXRDY is waited for before each character is sent; the receiver is asked in turn, without interrupts or FIFO.
"""

from __future__ import annotations

from dataclasses import dataclass

from periph_sim.firmware import Dsp, start_sci


@dataclass
class Settings:
    """What a case may change. brr: LSPCLK / (8 * rate) - 1."""

    brr: int = 40


def main(dsp: Dsp, settings: Settings) -> None:
    sci = start_sci(dsp, brr=settings.brr, fifo=False)
    while True:
        dsp.spin(lambda: sci.SCIRXST.RXRDY == 1)
        character = sci.SCIRXBUF.all & 0xFF
        dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
        sci.SCITXBUF.all = character
