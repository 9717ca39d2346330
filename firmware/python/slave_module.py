"""An interrupt-driven slave on the I2C module. A target object supplies the bytes to send and stores received bytes.

    I2CINT1A --code--> AAS: load the first byte of a read; RRDY: byte received; XRDY: load the next byte; SCD: end

The module requests each byte of a read while the previous one is sent. So after a read, I2CDXR contains one byte that
was not sent (SPRUG03B Figure 17). The next read loads this byte again, with its current value.
"""

from __future__ import annotations

from typing import Protocol

from periph_sim.firmware import Dsp, start_i2c
from periph_sim.processor.python.register_view import ModulePort

AAS_CODE, SCD_CODE, XRDY_CODE, RRDY_CODE, NACK_CODE = 7, 6, 5, 4, 2  # values of I2CISRC.INTCODE
SDIR, AD0 = 1 << 14, 1 << 8  # masks in I2CSTR
I2CINT1A_ACK = 0x80  # mask in PIEACK of group 8, which has I2CINT1A


class Target(Protocol):
    """Interface of the device that a slave represents, whether by the I2C module or by pins."""

    def addressed(self, reads: bool) -> None:
        """Begin a read or a write, whose address is acknowledged in any case."""

    def received(self, byte: int) -> None:
        """Receive a byte of a write, which is acknowledged in any case."""

    def byte(self) -> int:
        """Return the byte that a read sends next."""

    def step(self) -> None:
        """Advance to the next byte of a read. Called at XRDY or, with pins, when the previous byte was sent."""

    def over(self) -> None:
        """End the transfer, if there is one, at a STOP. `SlaveModule` also calls it at other STOPs."""


class SlaveInterrupt:
    """Service routine of I2CINT1A in a slave. Subclasses define what each interrupt code does."""

    dsp: Dsp
    i2c: ModulePort

    def interrupt(self) -> None:
        """Handle interrupt codes until none is left."""
        i2c = self.i2c
        code = i2c.I2CISRC.INTCODE
        while code:
            if code == AAS_CODE:
                self.addressed()
            elif code == XRDY_CODE:
                i2c.I2CDXR.all = self.next_byte()
            elif code == RRDY_CODE:
                self.receive_byte(i2c.I2CDRR.all)
            elif code in (SCD_CODE, NACK_CODE):
                i2c.I2CIER.XRDY = 0
                if code == SCD_CODE:
                    self.over()
            code = i2c.I2CISRC.INTCODE
        self.dsp.module("PIE").PIEACK.all = I2CINT1A_ACK

    def addressed(self) -> None:
        """Handle AAS: a read begins and needs its first byte, or a write begins."""
        raise NotImplementedError

    def next_byte(self) -> int:
        """Return the byte to send after the current one."""
        raise NotImplementedError

    def receive_byte(self, byte: int) -> None:
        """Handle RRDY: store a byte that was received."""
        raise NotImplementedError

    def over(self) -> None:
        """Handle SCD: this transfer, or one with another device, has ended with a STOP."""
        raise NotImplementedError


class SlaveModule(SlaveInterrupt):
    """A slave on I2C-A with one own address. General calls are acknowledged, but `target` only gets their STOP."""

    def __init__(self, dsp: Dsp, target: Target) -> None:
        self.dsp = dsp
        self.i2c = dsp.module("I2C-A")
        self.target = target
        self._for_all = False  # True while the current transfer is a general call

    def start(self, address: int) -> None:
        i2c = self.i2c
        start_i2c(self.dsp, address)
        i2c.I2CMDR.IRS = 1
        i2c.I2CIER.all = 0x6A  # AAS, SCD, RRDY, NACK; XRDY is enabled only during a read

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

    def receive_byte(self, byte: int) -> None:
        if not self._for_all:
            self.target.received(byte)

    def over(self) -> None:
        self.target.over()
