"""A case of a few lines: an SCI that answers each character with the next one."""

from __future__ import annotations

from pathlib import Path

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
