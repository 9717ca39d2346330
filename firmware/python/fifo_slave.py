"""A slave that receives by interrupt, with faults that users ask about: lost interrupts and shifted bytes.

    one byte: RRDY --I2CINT1A--> read I2CDRR; write PIEACK (0 if `acknowledge` is False: the fault)
    FIFO:     RXFFST = 4 --I2CINT2A--> read four bytes; with `realign`, AAS empties the FIFO before each message

Source: SPRUG03B section 3 (interrupts), Table 22 (I2CFFRX); SPRUFB0D section 8.3 (PIEACK).
"""

from __future__ import annotations

from dataclasses import dataclass

from periph_sim.firmware import Dsp, start_i2c, start_pie

AAS, RRDY = 0x40, 0x08  # masks in I2CIER
I2C_ACK = 0x80  # mask in PIEACK of group 8, which has both interrupts of I2C-A
LENGTH = 4  # bytes of a message


@dataclass
class Settings:
    """The settings that a case can give to this program."""

    fifo: bool = False
    acknowledge: bool = True
    realign: bool = False


def main(dsp: Dsp, settings: Settings) -> None:
    i2c = dsp.module("I2C-A")
    pie = dsp.module("PIE")

    def status() -> None:
        if i2c.I2CISRC.INTCODE == 4:
            _ = i2c.I2CDRR.all
        else:
            i2c.I2CFFRX.RXFFRST = 0 if settings.realign else 1
            i2c.I2CFFRX.RXFFRST = 1
        pie.PIEACK.all = I2C_ACK if settings.acknowledge else 0

    def message() -> None:
        for _ in range(LENGTH):
            _ = i2c.I2CDRR.all
        i2c.I2CFFRX.RXFFINTCLR = 1
        pie.PIEACK.all = I2C_ACK

    start_i2c(dsp, 0x50)
    i2c.I2CMDR.IRS = 1
    if settings.fifo:
        i2c.I2CFFTX.all = 0x4000  # I2CFFEN
        i2c.I2CFFRX.all = 0x2060 | LENGTH  # RXFFRST, RXFFINTCLR, RXFFIENA
    i2c.I2CIER.all = AAS if settings.fifo else RRDY
    start_pie(dsp, {"I2CINT1A": status, "I2CINT2A": message})
    while True:
        dsp.cpu.idle()
