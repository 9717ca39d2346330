"""A receiver on SCI-A with an interrupt for each character, to show effects of FE and BRKDT that users ask about.

    RX --qualifier of GPIO28--> SCI-A --SCIRXINTA--> read SCIRXBUF; after a break SW RESET, if `recover` is True

Without FIFO, BRKDT requests the interrupt too (RXBKINTENA). With FIFO, only a character does.

Source: SPRUFZ5A Tables 2-4, 2-6, 2-7 (SW RESET, RX/BK INT ENA, BRKDT); SPRUFB0D section 6.4.3 (qualification).
"""

from __future__ import annotations

from dataclasses import dataclass

from periph_sim.firmware import Dsp, sci_fifo_receiver, start_pie, start_sci

SCIRXINTA_ACK = 0x100  # mask of group 9 in PIEACK


@dataclass
class Settings:
    """The settings that a case can give to this program.

    brr: LSPCLK / (8 * rate) - 1.
    qualify: sampling period of the qualifier of GPIO28 (3 samples), in units of 2 SYSCLKOUT cycles; 0: no qualifier.
    recover: True to toggle SW RESET after BRKDT.
    """

    brr: int = 40
    fifo: bool = False
    qualify: int = 0
    recover: bool = True


def main(dsp: Dsp, settings: Settings) -> None:
    sci = dsp.module("SCI-A")

    def received() -> None:
        broken = sci.SCIRXST.BRKDT
        _ = sci.SCIRXBUF.all
        if broken and settings.recover:
            sci.SCICTL1.SWRESET = 0
            sci.SCICTL1.SWRESET = 1
        sci.SCIFFRX.RXFFINTCLR = 1
        dsp.module("PIE").PIEACK.all = SCIRXINTA_ACK

    if settings.fifo:
        sci_fifo_receiver(dsp, settings.brr, 1)
    else:
        start_sci(dsp, brr=settings.brr, fifo=False).SCICTL2.RXBKINTENA = 1
    if settings.qualify:
        gpio = dsp.module("GPIO")
        dsp.eallow()
        gpio.GPACTRL.QUALPRD3 = settings.qualify
        gpio.GPAQSEL2.GPIO28 = 1
        dsp.edis()
    start_pie(dsp, {"SCIRXINTA": received})
    while True:
        dsp.cpu.idle()
