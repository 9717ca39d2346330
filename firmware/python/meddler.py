"""A slave whose firmware disturbs its I2C module in the middle of a byte, a set time after the first START.

    START --(after)--> act --> receive the other bytes, one by one
                       clear: clear NACK by its bit field, which reads the whole of I2CSTR and writes it back
                       gate:  switch the module's clock off for `length`, so that the module misses edges
                       look:  set a pin if SDA is high
                       reset: set IRS to 0, then to 1

Each wait for a byte has a timeout, in case a flag was lost.

Source: SPRUG03B sections 5.3 (I2CSTR: write 1 to clear) and 5.9 (IRS); SPRUFB0D section 5.1 (PCLKCR0).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from periph_sim.core.table import Duration
from periph_sim.firmware import start_i2c, start_pin
from periph_sim.processor.dsp import Dsp


@dataclass
class Settings:
    """The settings that a case can give to this program."""

    address: int = 0x50
    act: Literal["clear", "gate", "look", "reset", "nothing"] = "nothing"
    after: Duration = Fraction(0)  # time from the START to the action
    length: Duration = Fraction(10, 1_000_000)  # time for which the clock is gated
    patience: Duration = Fraction(150, 1_000_000)  # maximum time to wait for a byte
    pin: int = 0


def meddle(dsp: Dsp, settings: Settings) -> None:
    i2c = dsp.module("I2C-A")
    dsp.compute(settings.after)
    if settings.act == "clear":
        i2c.I2CSTR.NACK = 1
    elif settings.act == "reset":
        i2c.I2CMDR.IRS = 0
        i2c.I2CMDR.IRS = 1
    elif settings.act == "look":
        if dsp.module("GPIO").GPBDAT.GPIO32 == 1:  # GPIO32 is the pin SDAA
            dsp.set_pin(settings.pin)
    elif settings.act == "gate":
        clocks = dsp.module("SYS")
        dsp.eallow()
        clocks.PCLKCR0.I2CAENCLK = 0
        dsp.compute(settings.length)
        clocks.PCLKCR0.I2CAENCLK = 1
        dsp.edis()


def main(dsp: Dsp, settings: Settings) -> None:
    start_pin(dsp, settings.pin)
    start_i2c(dsp, settings.address)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    received = bytearray()
    dsp.spin(lambda: i2c.I2CSTR.BB == 1)
    if settings.act != "nothing":
        meddle(dsp, settings)
    while True:
        if dsp.spin(lambda: i2c.I2CSTR.RRDY == 1, timeout=settings.patience):
            received.append(i2c.I2CDRR.all)
