"""A master that stores a record in an EEPROM page by page, polls until each page is stored, and reads the record back.

    every period:  START, address, word address, bytes of one page, STOP     --> each part of the record
                   START, address, STOP                                      --> until the EEPROM acknowledges
                   START, address, word address, repeated START, read, STOP  --> the record

With page = 0, the record is sent in one write, across page boundaries. Each byte is written to I2CDXR when XRDY is set.
After a NACK, the module holds the bus, so firmware sets STP to end the transfer.

Source: SPRUG03B Table 6 (RM, STT, STP), section 2.5.4; Microchip DS20001189 sections 6 and 7 (page write, polling).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from periph_sim.firmware import Dsp, Duration, HexBytes, start_i2c, start_pie

STT, STP, MST, TRX, RM, IRS = 0x2000, 0x0800, 0x0400, 0x0200, 0x0080, 0x0020  # masks in I2CMDR
FREE = 0x4000
FLAGS = 0x0026  # mask of SCD, ARDY and NACK in I2CSTR, which are cleared by writing ones


@dataclass
class Settings:
    """The settings that a case can give to this program."""

    address: int = 0x50
    record_at: int = 0x0038  # the record's word address in the EEPROM
    record: HexBytes = bytes(range(0xA0, 0xB0))
    page: int = 32  # number of bytes in a page; 0: writes are not divided
    period: Duration = Fraction(20, 1000)
    low: int = 45  # I2CCLKL: SCL is low for 45 + 5 cycles of 10 MHz, which gives 100 kHz
    high: int = 45


class Log:
    def __init__(self, dsp: Dsp, settings: Settings) -> None:
        self.dsp = dsp
        self.settings = settings
        self.i2c = dsp.module("I2C-A")
        self.due = 0  # number of records that have become due after the first

    def tick(self) -> None:
        """Serve TINT0: one more record is due."""
        self.due += 1
        self.dsp.module("PIE").PIEACK.all = 1

    def parts(self) -> Iterator[tuple[int, bytes]]:
        """Yield the word address and the bytes of each write. If `page` > 0, no write crosses the end of a page."""
        at, left = self.settings.record_at, self.settings.record
        while left:
            room = len(left) if self.settings.page == 0 else self.settings.page - at % self.settings.page
            yield at, left[:room]
            at, left = at + room, left[room:]

    def begin(self, command: int, count: int = 0) -> None:
        """Wait until the bus is free, then send START and address. command: further bits of I2CMDR. count: I2CCNT."""
        i2c = self.i2c
        self.dsp.spin(lambda: i2c.I2CMDR.STP == 0)
        self.dsp.spin(lambda: i2c.I2CSTR.BB == 0)
        i2c.I2CSTR.all = FLAGS
        i2c.I2CSAR.all = self.settings.address
        i2c.I2CCNT.all = count
        i2c.I2CMDR.all = FREE | STT | MST | IRS | command

    def send(self, data: bytes) -> None:
        i2c = self.i2c
        for byte in data:
            if self.dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.NACK == 1):
                return
            i2c.I2CDXR.all = byte

    def end(self) -> None:
        """Wait for the STOP; after a NACK, set STP first."""
        i2c = self.i2c
        if self.dsp.spin_either(lambda: i2c.I2CSTR.SCD == 1, lambda: i2c.I2CSTR.NACK == 1):
            i2c.I2CMDR.STP = 1
            self.dsp.spin(lambda: i2c.I2CSTR.SCD == 1)

    def write(self, at: int, data: bytes) -> None:
        self.begin(TRX | STP, 2 + len(data))
        self.send(bytes([at >> 8, at & 0xFF]) + data)
        self.end()

    def is_ready(self) -> bool:
        """Return True if the EEPROM acknowledges its address, which means that it has stored the page."""
        i2c = self.i2c
        self.begin(TRX | RM)
        self.dsp.spin(lambda: i2c.I2CMDR.STT == 0)
        i2c.I2CMDR.STP = 1
        self.end()
        ready: bool = i2c.I2CSTR.NACK == 0
        return ready

    def read(self, at: int, count: int) -> bytes:
        i2c = self.i2c
        self.begin(TRX, 2)
        self.send(bytes([at >> 8, at & 0xFF]))
        self.dsp.spin(lambda: i2c.I2CSTR.ARDY == 1 or i2c.I2CSTR.NACK == 1)
        if i2c.I2CSTR.NACK == 1:
            i2c.I2CMDR.STP = 1
            return b""
        i2c.I2CCNT.all = count
        i2c.I2CMDR.all = FREE | STT | STP | MST | IRS
        got = bytearray()
        for _ in range(count):
            if self.dsp.spin_either(lambda: i2c.I2CSTR.RRDY == 1, lambda: i2c.I2CSTR.NACK == 1):
                break
            got.append(i2c.I2CDRR.all)
        self.end()
        return bytes(got)

    def run(self) -> None:
        dsp, settings = self.dsp, self.settings
        start_i2c(dsp)
        self.i2c.I2CCLKL.all = settings.low
        self.i2c.I2CCLKH.all = settings.high
        self.i2c.I2CMDR.all = IRS
        timer = dsp.module("TIMER0")
        timer.PRD.all = int(settings.period * dsp.control.sysclk_hz) - 1
        timer.TCR.all = 0x4020  # TIE, TRB
        start_pie(dsp, {"TINT0": self.tick})
        stored = 0
        while True:
            for at, data in self.parts():
                with dsp.span("store"):
                    self.write(at, data)
                    while not self.is_ready():
                        pass
            with dsp.span("read back"):
                self.read(settings.record_at, len(settings.record))
            stored += 1
            while self.due < stored:
                dsp.cpu.idle()


def main(dsp: Dsp, settings: Settings) -> None:
    Log(dsp, settings).run()
