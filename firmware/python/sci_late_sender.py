"""A sender on SCI-A whose TX pin is low for a time before the SCI takes it over. Then it sends a message periodically.

Source: SPRUFB0D section 6 (GPIO29 is an ordinary pin until GPAMUX2 selects SCITXDA); SPRUFZ5A section 1.2.8.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from periph_sim.firmware import Dsp, Duration, HexBytes, start_pin, start_sci


@dataclass
class Settings:
    """The settings that a case can give to this program. low: time that the pin is low before the SCI takes it over."""

    brr: int = 1
    low: Duration = Fraction(0)
    message: HexBytes = bytes(range(0x10, 0x21))
    period: Duration = Fraction(2, 1000)


def main(dsp: Dsp, settings: Settings) -> None:
    dsp.compute(Fraction(1, 1000))
    if settings.low:
        start_pin(dsp, 29)
        dsp.compute(settings.low)
    sci = start_sci(dsp, brr=settings.brr, fifo=False)
    while True:
        dsp.compute(settings.period)
        for byte in settings.message:
            dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
            sci.SCITXBUF.all = byte
