"""A slave that returns any device's data: address, replies and style of flag handling are settings.

    address, replies, busy  -->  polled | interrupt, with or without FIFO  -->  the bus

Each read is answered with the next entry of `replies` (later with the last one again), followed by `filler` bytes. The
device is not reachable for the time `asleep` at the start, and for the time `busy[n]` after write n (from 0) that
ended with a STOP, like an EEPROM that stores data. During these times, firmware holds the I2C module in reset,
so that it does not acknowledge its address.

As slave-transmitter, the module always requests one byte more than the master reads (SPRUG03B Figure 17). This surplus
byte is not sent. When SDIR shows that the next read has begun, firmware writes the first byte of that read over it, so
the read begins with the right byte.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, repeat
from typing import Literal, NamedTuple, NoReturn

from periph_sim.core.table import Duration, HexBytes
from periph_sim.firmware import start_i2c, start_pie
from periph_sim.processor.dsp import Dsp

from .slave_module import SlaveInterrupt

REPLAY = ("address", "replies", "asleep", "busy")  # settings that a replay sets from the capture


@dataclass
class Settings:
    """The settings that a case can give to this program."""

    address: int = 0x50
    replies: tuple[HexBytes, ...] = (bytes(range(1, 17)),)
    style: Literal["polled", "interrupt"] = "polled"
    fifo: bool = False
    filler: int = 0xFF
    asleep: Duration = Fraction(0)
    busy: tuple[Duration, ...] = ()
    ten_bit: bool = False


class Responder(SlaveInterrupt):
    """The slave, with the data that it has received. received: the bytes of each write, in order."""

    def __init__(self, dsp: Dsp, settings: Settings) -> None:
        self.dsp = dsp
        self.settings = settings
        self.i2c = dsp.module("I2C-A")
        self.received: list[bytearray] = []
        self._replies = iter(settings.replies)
        self._busy = iter(settings.busy)
        self._last = settings.replies[-1] if settings.replies else b""
        self._bytes: Iterator[int] = iter(())
        self._writing = self._stored = False  # in interrupt style: a write is in progress; a write was completed
        self.waits = self.conditions()

    def configure(self) -> None:
        i2c, settings = self.i2c, self.settings
        i2c.I2CMDR.IRS = 0
        i2c.I2COAR.all = settings.address
        if settings.ten_bit:
            i2c.I2CMDR.XA = 1
        if settings.fifo:
            i2c.I2CFFTX.all = 0x6000  # I2CFFEN, TXFFRST
            i2c.I2CFFRX.all = 0x2000  # RXFFRST
        i2c.I2CMDR.IRS = 1

    def next_reply(self) -> Iterator[int]:
        """Return the bytes of the next read: its reply, then filler bytes without end."""
        return chain(next(self._replies, self._last), repeat(self.settings.filler))

    def be_busy(self) -> None:
        """Hold the module in reset for the next time in `busy`, so that it does not acknowledge its address."""
        pause = next(self._busy, Fraction(0))
        if pause:
            self.i2c.I2CMDR.IRS = 0
            self.dsp.compute(pause)
            self.configure()

    # Polled ------------------------------------------------------------------

    def poll(self) -> NoReturn:
        i2c, dsp = self.i2c, self.dsp
        while True:
            dsp.spin(self.waits.addressed)
            if i2c.I2CSTR.SDIR == 1:
                self.send()
            else:
                self.receive()

    def send(self) -> None:
        i2c, dsp = self.i2c, self.dsp
        data = self.next_reply()
        if self.settings.fifo:
            i2c.I2CFFTX.TXFFRST = 0
            i2c.I2CFFTX.TXFFRST = 1
            while True:
                i2c.I2CDXR.all = next(data)
                if dsp.spin_either(lambda: i2c.I2CFFTX.TXFFST < 4, self.waits.over):
                    return
        while True:
            i2c.I2CDXR.all = next(data)
            if dsp.spin_either(self.waits.wants_byte, self.waits.over):
                return

    def receive(self) -> None:
        i2c, dsp = self.i2c, self.dsp
        taken = bytearray()
        self.received.append(taken)
        if self.settings.fifo:
            while not dsp.spin_either(lambda: i2c.I2CFFRX.RXFFST > 0, self.waits.over):
                taken.append(i2c.I2CDRR.all)
        else:
            while not dsp.spin_either(self.waits.has_byte, self.waits.over):
                taken.append(i2c.I2CDRR.all)
        if i2c.I2CSTR.BB == 0:  # the write ended with a STOP, not a repeated START
            self.be_busy()

    def conditions(self) -> Waits:
        i2c = self.i2c
        return Waits(
            addressed=lambda: i2c.I2CSTR.AAS == 1,
            over=lambda: i2c.I2CSTR.AAS == 0,
            wants_byte=lambda: i2c.I2CSTR.XRDY == 1,
            has_byte=lambda: i2c.I2CSTR.RRDY == 1,
        )

    # Interrupt-driven ----------------------------------------------------------

    def next_byte(self) -> int:
        return next(self._bytes)

    def receive_byte(self, byte: int) -> None:
        self.received[-1].append(byte)

    def over(self) -> None:
        if self._writing:
            self._writing, self._stored = False, True

    def addressed(self) -> None:
        i2c = self.i2c
        self._writing = i2c.I2CSTR.SDIR == 0
        if not self._writing:
            self._bytes = self.next_reply()
            if self.settings.fifo:
                i2c.I2CFFTX.TXFFRST = 0
                i2c.I2CFFTX.TXFFRST = 1
                for _ in range(16):
                    i2c.I2CDXR.all = next(self._bytes)
                i2c.I2CFFTX.all = 0x6060 | 4  # requests an interrupt when only four bytes are left
            else:
                i2c.I2CDXR.all = next(self._bytes)
                i2c.I2CIER.XRDY = 1
        else:
            self.received.append(bytearray())
            if self.settings.fifo:
                i2c.I2CFFRX.all = 0x2061  # requests an interrupt as soon as there is one byte

    def fifo_interrupt(self) -> None:
        """Serve I2CINT2A: the transmit FIFO level is low, or a byte was received."""
        i2c = self.i2c
        while i2c.I2CFFRX.RXFFST > 0:
            self.received[-1].append(i2c.I2CDRR.all)
        if i2c.I2CSTR.SDIR == 1:
            while i2c.I2CFFTX.TXFFST < 12:
                i2c.I2CDXR.all = next(self._bytes)
        else:
            i2c.I2CFFTX.TXFFIENA = 0
        i2c.I2CFFTX.TXFFINTCLR = 1
        i2c.I2CFFRX.RXFFINTCLR = 1
        self.dsp.module("PIE").PIEACK.all = 0x80

    def run(self) -> None:
        dsp, settings = self.dsp, self.settings
        start_i2c(dsp)
        if settings.asleep:
            dsp.compute(settings.asleep)
        self.configure()
        if settings.style == "polled":
            self.poll()
        i2c = self.i2c
        i2c.I2CIER.all = 0x62 if settings.fifo else 0x6A  # AAS, SCD, NACK; RRDY without FIFO
        handlers = {"I2CINT1A": self.interrupt}
        if settings.fifo:
            handlers["I2CINT2A"] = self.fifo_interrupt
        start_pie(dsp, handlers)
        while True:
            dsp.cpu.idle()
            if self._stored:
                self._stored = False
                self.be_busy()


class Waits(NamedTuple):
    """Conditions of the polled style: functions that return True when a wait is over. FIFO mode uses the first two."""

    addressed: Callable[[], object]
    over: Callable[[], object]
    wants_byte: Callable[[], object]
    has_byte: Callable[[], object]


def main(dsp: Dsp, settings: Settings) -> None:
    Responder(dsp, settings).run()
