"""A second master on the bus: it writes one byte every period, at the same instant as another master.

    other master  START 0x50 ...          wins, because its address is lower
    this one      START 0x57 ...  AL = 1  loses: it releases both lines, and tries again when the bus is free

Source: SPRUG03B section 2.8 (arbitration), Table 10 (AL).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from periph_sim.core.table import Duration
from periph_sim.firmware import start_i2c
from periph_sim.processor.dsp import Dsp

AL, NACK, ARDY, SCD = 0x01, 0x02, 0x04, 0x20  # masks in I2CSTR; the flags are cleared by writing ones


@dataclass
class Settings:
    """The settings that a case can give to this program."""

    address: int = 0x57
    byte: int = 0x77
    begin: Duration = Fraction(1, 1000)  # time from the end of start-up to the first write of STT
    period: Duration = Fraction(2, 1000)  # time between writes
    low: int = 45  # I2CCLKL: SCL is low for 45 + 5 cycles of 10 MHz, which gives 100 kHz
    high: int = 45


def main(dsp: Dsp, settings: Settings) -> None:
    start_i2c(dsp)
    i2c = dsp.module("I2C-A")
    i2c.I2CCLKL.all = settings.low
    i2c.I2CCLKH.all = settings.high
    i2c.I2CMDR.all = 0x0020  # IRS
    wait = settings.begin
    while True:
        dsp.compute(wait)
        while True:
            i2c.I2CSAR.all = settings.address
            i2c.I2CCNT.all = 1
            i2c.I2CDXR.all = settings.byte
            i2c.I2CMDR.all = 0x6E20  # FREE, STT, STP, MST, TRX, IRS: START, address, byte, STOP
            lost = dsp.spin_either(lambda: i2c.I2CSTR.SCD == 1, lambda: i2c.I2CSTR.AL == 1)
            i2c.I2CSTR.all = AL | NACK | ARDY | SCD
            if not lost:
                break
            dsp.spin(lambda: i2c.I2CSTR.BB == 0)
        wait = settings.period
