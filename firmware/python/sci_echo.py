"""Echo on SCI-A: each received character is sent back. firmware/c28x/sci_echo.asm is the same program in assembly.

It uses neither interrupts nor FIFOs. It polls the receiver, and waits for TXRDY before it sends.
"""

from __future__ import annotations

from dataclasses import dataclass

from periph_sim.firmware import Dsp, start_sci


@dataclass
class Settings:
    """The settings that a case can give to this program. brr: LSPCLK / (8 * rate) - 1."""

    brr: int = 40


def main(dsp: Dsp, settings: Settings) -> None:
    sci = start_sci(dsp, brr=settings.brr, fifo=False)
    while True:
        dsp.spin(lambda: sci.SCIRXST.RXRDY == 1)
        character = sci.SCIRXBUF.all & 0xFF
        dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
        sci.SCITXBUF.all = character
