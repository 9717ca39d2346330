"""A master that writes a record to an EEPROM through the transmit FIFO, with faults that users ask about.

    two address bytes and the record --refilled | at once--> 16 words of TX FIFO --I2CCNT bytes--> the bus, then STOP

With `count_at_start` = False, I2CCNT is 0 at START, which means 65536 bytes. The right count is written after STT = 1.
After a NACK, firmware writes the values `after_nack` to I2CMDR. The next write waits for the bus, at most PATIENCE.

Source: SPRUG03B sections 2.5.4, 5.10 (I2CCNT); Table 6 (RM, STT, STP), Table 10 (BB), Table 21 (I2CFFTX).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from periph_sim.firmware import Dsp, start_i2c

FREE, STT, STP, MST, TRX, IRS = 0x4000, 0x2000, 0x0800, 0x0400, 0x0200, 0x0020  # masks in I2CMDR
FLAGS = 0x0026  # mask of SCD, ARDY and NACK in I2CSTR, which are cleared by writing ones
DEPTH = 16  # words of the transmit FIFO
PATIENCE = Fraction(10, 1000)  # the longest waits for the bus and for the end of a write, in seconds


@dataclass
class Settings:
    """The settings that a case can give to this program.

    length: bytes of the record, without the two address bytes. fill: "at once" writes all bytes before START.
    after_nack: values that are written to I2CMDR after a NACK, one after the other; by default one value with STP.
    """

    length: int = 32
    fill: Literal["refilled", "at once"] = "refilled"
    count_at_start: bool = True
    after_nack: tuple[int, ...] = (FREE | STP | MST | TRX | IRS,)
    writes: int = 1


def main(dsp: Dsp, settings: Settings) -> None:
    i2c = dsp.module("I2C-A")
    data = [0, 0, *range(settings.length)]

    def write() -> None:
        if not dsp.spin(lambda: i2c.I2CSTR.BB == 0, timeout=PATIENCE):
            return
        i2c.I2CSTR.all = FLAGS
        i2c.I2CFFTX.all = 0x4000  # I2CFFEN; TXFFRST = 0 empties the FIFO
        i2c.I2CFFTX.all = 0x6040  # I2CFFEN, TXFFRST, TXFFINTCLR
        i2c.I2CSAR.all = 0x50
        i2c.I2CCNT.all = len(data) if settings.count_at_start else 0
        first = DEPTH if settings.fill == "refilled" else len(data)
        for byte in data[:first]:
            i2c.I2CDXR.all = byte
        i2c.I2CMDR.all = FREE | STT | STP | MST | TRX | IRS
        i2c.I2CCNT.all = len(data)
        for byte in data[first:]:
            dsp.spin(lambda: i2c.I2CFFTX.TXFFST < DEPTH)
            i2c.I2CDXR.all = byte
        dsp.spin(lambda: i2c.I2CSTR.SCD == 1 or i2c.I2CSTR.NACK == 1, timeout=PATIENCE)
        if i2c.I2CSTR.NACK == 1:
            for command in settings.after_nack:
                i2c.I2CMDR.all = command

    start_i2c(dsp)
    i2c.I2CCLKL.all = i2c.I2CCLKH.all = 45
    i2c.I2CMDR.all = IRS
    for _ in range(settings.writes):
        with dsp.span("write"):
            write()
