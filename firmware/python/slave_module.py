"""A slave on the I2C module by interrupts: a target goes in, and is told of what the bus asks of it.

    I2CINT1A --code--> AAS: a read loads the first byte anew; RRDY: a byte came; XRDY: the next byte; SCD: it is over

The module asks for each byte of a read while the one before is sent, so that one more than was read is in I2CDXR at the
end (SPRUG03B Figure 17). It was not sent: the next read loads it as it is then.
"""

from __future__ import annotations

from typing import Protocol

from periph_sim.firmware import Dsp, start_i2c
from periph_sim.processor.python.register_view import ModulePort

AAS_CODE, SCD_CODE, XRDY_CODE, RRDY_CODE, NACK_CODE = 7, 6, 5, 4, 2  # I2CISRC
SDIR, AD0 = 1 << 14, 1 << 8  # I2CSTR
I2CINT1A_ACK = 0x80  # PIEACK: group 8


class Target(Protocol):
    """What a slave is for, whether a module serves it or pins do."""

    def addressed(self, reads: bool) -> None:
        """The address was acknowledged; a read begins, or a write."""

    def received(self, byte: int) -> None:
        """A byte of a write, which is acknowledged."""

    def byte(self) -> int:
        """The byte that a read sends next."""

    def step(self) -> None:
        """That byte is on its way; another one is next."""

    def over(self) -> None:
        """A STOP ended the transfer."""


class SlaveInterrupt:
    """I2CINT1A of a slave; whose it is says what each code asks for."""

    dsp: Dsp
    i2c: ModulePort

    def interrupt(self) -> None:
        """One code after the other until none is left."""
        i2c = self.i2c
        code = i2c.I2CISRC.INTCODE
        while code:
            if code == AAS_CODE:
                self.addressed()
            elif code == XRDY_CODE:
                i2c.I2CDXR.all = self.next_byte()
            elif code == RRDY_CODE:
                self.take(i2c.I2CDRR.all)
            elif code in (SCD_CODE, NACK_CODE):
                i2c.I2CIER.XRDY = 0
                if code == SCD_CODE:
                    self.over()
            code = i2c.I2CISRC.INTCODE
        self.dsp.module("PIE").PIEACK.all = I2CINT1A_ACK

    def addressed(self) -> None:
        """A read wants its first byte; a write begins."""
        raise NotImplementedError

    def next_byte(self) -> int:
        """What is sent behind the byte that is on its way."""
        raise NotImplementedError

    def take(self, byte: int) -> None:
        """It was received."""
        raise NotImplementedError

    def over(self) -> None:
        """A STOP."""
        raise NotImplementedError


class SlaveModule(SlaveInterrupt):
    """I2C-A with one own address, for a target, who is not told of the general call: that the module acknowledges."""

    def __init__(self, dsp: Dsp, target: Target) -> None:
        self.dsp = dsp
        self.i2c = dsp.module("I2C-A")
        self.target = target
        self._for_all = False  # the present transfer

    def start(self, address: int) -> None:
        i2c = self.i2c
        start_i2c(self.dsp, address)
        i2c.I2CMDR.IRS = 1
        i2c.I2CIER.all = 0x6A  # AAS, SCD, RRDY, NACK; XRDY while a read is served

    def addressed(self) -> None:
        i2c, target = self.i2c, self.target
        status = i2c.I2CSTR.all
        reads = bool(status & SDIR)
        self._for_all = bool(status & AD0)
        if not self._for_all:
            target.addressed(reads)
        if reads:
            i2c.I2CDXR.all = target.byte()
            i2c.I2CIER.XRDY = 1
        else:
            i2c.I2CIER.XRDY = 0

    def next_byte(self) -> int:
        self.target.step()
        return self.target.byte()

    def take(self, byte: int) -> None:
        if not self._for_all:
            self.target.received(byte)

    def over(self) -> None:
        self.target.over()
