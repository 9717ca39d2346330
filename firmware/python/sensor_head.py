"""The sensor head with the F28335 as I2C master: three chips per period, read with repeated START.

    timer 0 --> round: gyroscope, accelerometer, magnetometer --> values

For a read, firmware sends the pointer byte with STT and without STP (RM = 0), and waits for ARDY. Then it sets STT and
STP as master-receiver, reads I2CCNT bytes when RRDY is set, and waits until SCD shows the STOP. After a NACK of the
write address or pointer, firmware sets STP to free the bus. After one of the read address, it waits for RRDY forever.

Source: SPRUG03B Table 6 (RM, STT, STP) and section 2.5.4; TI's i2c_eeprom example for the settings.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from periph_sim.core.table import Duration
from periph_sim.firmware import start_i2c, start_pie
from periph_sim.processor.dsp import Dsp

CHIPS = {0x68: 0x1D, 0x53: 0x32, 0x1E: 0x03}  # maps the address of each chip to its first data register


@dataclass
class Settings:
    """The settings that a case can give to this program."""

    period: Duration = Fraction(20, 1000)
    count: int = 6
    low: int = 45  # I2CCLKL: SCL is low for 45 + 5 cycles of 10 MHz, which gives 100 kHz
    high: int = 45
    order: tuple[int, ...] = (0x68, 0x53, 0x1E)


class Head:
    """The sensor head. rounds: the data of each round, by address; None after a NACK of write address or pointer."""

    def __init__(self, dsp: Dsp, settings: Settings) -> None:
        self.dsp = dsp
        self.settings = settings
        self.i2c = dsp.module("I2C-A")
        self.due = 0
        self.rounds: list[dict[int, bytes | None]] = []

    def tick(self) -> None:
        """Serve TINT0: one more round is due."""
        self.due += 1
        self.dsp.module("PIE").PIEACK.all = 1

    def read(self, address: int, pointer: int) -> bytes | None:
        i2c, dsp = self.i2c, self.dsp
        dsp.spin(lambda: i2c.I2CMDR.STP == 0)
        dsp.spin(lambda: i2c.I2CSTR.BB == 0)
        i2c.I2CSAR.all = address
        i2c.I2CCNT.all = 1
        i2c.I2CDXR.all = pointer
        i2c.I2CMDR.all = 0x6620  # FREE, STT, MST, TRX, IRS: START, address, pointer, then hold the bus
        dsp.spin(lambda: i2c.I2CSTR.ARDY == 1)
        if i2c.I2CSTR.NACK == 1:
            i2c.I2CMDR.STP = 1
            i2c.I2CSTR.all = 0x0002  # NACK
            return None
        i2c.I2CCNT.all = self.settings.count
        i2c.I2CMDR.all = 0x6C20  # FREE, STT, STP, MST, IRS: repeated START, read I2CCNT bytes, STOP
        got = bytearray()
        for _ in range(self.settings.count):
            dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
            got.append(i2c.I2CDRR.all)
        dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
        i2c.I2CSTR.all = 0x0020  # SCD
        return bytes(got)

    def run(self) -> None:
        dsp, settings = self.dsp, self.settings
        start_i2c(dsp)
        i2c = self.i2c
        i2c.I2CCLKL.all = settings.low
        i2c.I2CCLKH.all = settings.high
        i2c.I2CMDR.all = 0x0020
        timer = dsp.module("TIMER0")
        period = int(settings.period * dsp.control.sysclk_hz) - 1
        timer.PRD.all = period
        timer.TCR.all = 0x4020  # TIE, TRB
        start_pie(dsp, {"TINT0": self.tick})
        done = 0
        while True:
            while self.due == done:
                dsp.cpu.idle()
            done = self.due
            with dsp.span("round"):
                self.rounds.append({chip: self.read(chip, CHIPS[chip]) for chip in settings.order})


def main(dsp: Dsp, settings: Settings) -> None:
    Head(dsp, settings).run()
