"""A receiver on SCI-A that reads RXFFST periodically, and then as many characters as this field states.

Source: SPRUFZ5A Table 2-10 (RXFFST counts words in the FIFO; a character enters the FIFO in its stop bit).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from periph_sim.firmware import Dsp, Duration, start_sci


@dataclass
class Settings:
    """The settings that a case can give to this program. period: time before each read of RXFFST."""

    brr: int = 40
    period: Duration = Fraction(1, 1000)


def main(dsp: Dsp, settings: Settings) -> None:
    sci = start_sci(dsp, brr=settings.brr)
    while True:
        dsp.compute(settings.period)
        count = sci.SCIFFRX.RXFFST
        for _ in range(count):
            _ = sci.SCIRXBUF.all
