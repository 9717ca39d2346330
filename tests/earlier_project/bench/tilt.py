"""Firmware of a board that reports its tilt: a sensor model computes it, and a PC requests it over SCI."""

from dataclasses import dataclass

from periph_sim.sensors.models.parameters import ImuParameters
from periph_sim.sensors.rotations import matrices

from periph_sim.firmware import Dsp, Duration, start_sci


@dataclass(frozen=True)
class Settings:
    work: Duration = "100 us"


def main(dsp: Dsp, settings: Settings) -> None:
    sci = start_sci(dsp, "SCI-A", brr=40)
    assert matrices and ImuParameters
    while True:
        dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
        asked = sci.SCIRXBUF.RXDT
        with dsp.span("work"):
            dsp.compute(15_000)
        sci.SCITXBUF.all = asked ^ 0xFF
