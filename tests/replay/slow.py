"""Firmware that computes before it answers a read, as a case in a folder, and a capture to replay against it."""

from __future__ import annotations

from pathlib import Path

from periph_sim.traces.formats import Capture
from tests.traces.formats.writers import I2cWave

FIRMWARE = """
from dataclasses import dataclass
from fractions import Fraction

from periph_sim.firmware import sci_fifo_receiver, start_i2c


@dataclass
class Settings:
    address: int = 0x50
    wait: int = 0
    byte: int = 0xA7


def main(dsp, settings):
    i2c = dsp.module("I2C-A")
    start_i2c(dsp, settings.address)
    if dsp.has("SCI-A"):
        sci_fifo_receiver(dsp, 40, 16)
    i2c.I2CMDR.IRS = 1
    while True:
        dsp.spin(lambda: i2c.I2CSTR.AAS == 1 and i2c.I2CSTR.SDIR == 1)
        dsp.compute(Fraction(settings.wait, 10**6), "thinking")
        i2c.I2CDXR.all = settings.byte
        dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
        i2c.I2CSTR.SCD = 1
"""


def firmware_case(folder: Path, name: str, firmware: str, modules: str = '"I2C-A"', more: str = "") -> Path:
    """Write the case file of one unit, with the text of its firmware in a file beside it, and return its path."""
    (folder / f"{name}.py").write_text(firmware)
    case = folder / f"{name}.toml"
    unit = f'[unit.dsp]\nfirmware = "{folder / name}.py"\nmodules = [{modules}]\n'
    case.write_text(f'name = "{name}"\nduration = "1 s"\n{unit}{more}')
    return case


def slow_case(folder: Path, modules: str = '"I2C-A"', more: str = "") -> Path:
    """Write a case file in which `unit.dsp.settings.wait` is the time, in us, that the firmware computes."""
    return firmware_case(folder, "slow", FIRMWARE, modules, more)


def one_read(stretched: int = 0, byte: int = 0xA7) -> Capture:
    """Return a capture of a read of one byte from 0x50 at 100 kHz and 4 MHz samples.

    stretched: samples for which SCL is low in addition before the byte.
    """
    return I2cWave(20, 4, idle=400).play(f"S A1+ ~{stretched} {byte:02X}- P .400").capture(4_000_000)
