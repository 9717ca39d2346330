"""A small case: an SCI that answers each character with the next one."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

from periph_sim.outside import Session
from periph_sim.outside.live.loop import Loop
from periph_sim.outside.live.pacing import Pacer

FIRMWARE = """\
from periph_sim.firmware import start_sci


def main(dsp, settings):
    sci = start_sci(dsp, "SCI-A", 40, 7, fifo=False)
    while True:
        dsp.spin(lambda: sci.SCIRXST.RXRDY == 1)
        word = sci.SCIRXBUF.RXDT
        dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
        sci.SCITXBUF.all = word + 1 & 0xFF
"""
CASE = """\
name = "echo"
duration = "1 s"
[unit.dsp]
firmware = "echo_firmware.py"
modules = ["SCI-A"]
"""


def written(folder: Path) -> Path:
    (folder / "echo_firmware.py").write_text(FIRMWARE)
    (folder / "echo.toml").write_text(CASE)
    return folder / "echo.toml"


class Echo:
    """A session of the case, advanced by the test; a subclass opens a door at its line."""

    door: Any

    def __init__(self, folder: Path) -> None:
        self.session = Session(written(folder), ("RX", "TX"))
        self.line = self.session.serial("scia")

    def passes(self, length: str) -> None:
        pacer = Pacer(self.session.ticks_per_second, Fraction(0))
        Loop(self.session, pacer, [self.door]).run(self.session.now + self.session.ticks(length))
