"""A slave with registers, as most chips have them: what is written goes into them, what is read comes out of them.

    S addr W  pointer  [data ...] P     writes from the pointer on
    S addr W  pointer  Sr addr R  data ... N P     reads from it on
    S addr R  data ... N P     reads on behind the last byte that went over the bus

    I2CINT1A --code--> AAS: a read loads the first byte anew; RRDY: pointer, then registers; XRDY: the next byte

The module asks for each byte of a read while the one before is sent, so that one more than was read is in I2CDXR at the
end (SPRUG03B Figure 17). The pointer stands on that byte: it was not sent, and the next read loads it as it is then.
"""

from __future__ import annotations

from dataclasses import dataclass

from periph_sim.firmware import Dsp, HexBytes, start_i2c, start_pie

AAS_CODE, SCD_CODE, XRDY_CODE, RRDY_CODE, NACK_CODE = 7, 6, 5, 4, 2  # I2CISRC
I2CINT1A_ACK = 0x80  # PIEACK: group 8


@dataclass
class Settings:
    """What a case may change. registers: what they hold at the start, from 0 on; the others hold 0."""

    address: int = 0x50
    registers: HexBytes = b""
    size: int = 256

    def __post_init__(self) -> None:
        if not 1 <= self.size <= 256:
            raise ValueError(f"size is {self.size}; a pointer of one byte has 1 to 256 registers")
        if len(self.registers) > self.size:
            raise ValueError(f"registers has {len(self.registers)} bytes, and there are {self.size} registers")


class RegisterSlave:
    """pointer: the register that goes over the bus next."""

    def __init__(self, dsp: Dsp, settings: Settings) -> None:
        self.dsp = dsp
        self.settings = settings
        self.i2c = dsp.module("I2C-A")
        self.registers = bytearray(settings.registers.ljust(settings.size, b"\0"))
        self.pointer = 0
        self._pointer_comes = False  # with the next byte that is received

    def interrupt(self) -> None:
        """I2CINT1A: one code after the other until none is left."""
        i2c = self.i2c
        code = i2c.I2CISRC.INTCODE
        while code:
            if code == AAS_CODE:
                self.addressed()
            elif code == RRDY_CODE:
                self.received(i2c.I2CDRR.all)
            elif code == XRDY_CODE:
                self.step()
                i2c.I2CDXR.all = self.registers[self.pointer]
            elif code in (SCD_CODE, NACK_CODE):
                i2c.I2CIER.XRDY = 0
            code = i2c.I2CISRC.INTCODE
        self.dsp.module("PIE").PIEACK.all = I2CINT1A_ACK

    def addressed(self) -> None:
        i2c = self.i2c
        if i2c.I2CSTR.SDIR == 1:
            i2c.I2CDXR.all = self.registers[self.pointer]
            i2c.I2CIER.XRDY = 1
        else:
            i2c.I2CIER.XRDY = 0
            self._pointer_comes = True

    def received(self, byte: int) -> None:
        if self._pointer_comes:
            self.pointer = byte % self.settings.size
            self._pointer_comes = False
        else:
            self.registers[self.pointer] = byte
            self.step()

    def step(self) -> None:
        self.pointer = (self.pointer + 1) % self.settings.size

    def run(self) -> None:
        dsp, i2c = self.dsp, self.i2c
        start_i2c(dsp, self.settings.address)
        i2c.I2CMDR.IRS = 1
        i2c.I2CIER.all = 0x6A  # AAS, SCD, RRDY, NACK; XRDY while a read is served
        start_pie(dsp, {"I2CINT1A": self.interrupt})
        while True:
            dsp.cpu.idle()


def main(dsp: Dsp, settings: Settings) -> None:
    RegisterSlave(dsp, settings).run()
