"""A slave with registers, as most chips have them: what is written goes into them, what is read comes out of them.

S addr W  pointer  [data ...] P     writes from the pointer on
S addr W  pointer  Sr addr R  data ... N P     reads from it on
S addr R  data ... N P     reads on behind the last byte that went over the bus
"""

from __future__ import annotations

from dataclasses import dataclass

from periph_sim.firmware import Dsp, HexBytes, start_pie

from .slave_module import SlaveModule

REPLAY = ("address",)  # settings that a replay fills in from the capture


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


class Registers:
    """A target. pointer: the register that goes over the bus next."""

    def __init__(self, contents: bytes, size: int) -> None:
        self.registers = bytearray(contents.ljust(size, b"\0"))
        self.pointer = 0
        self._pointer_comes = False  # with the next byte that is received

    def addressed(self, reads: bool) -> None:
        self._pointer_comes = not reads

    def received(self, byte: int) -> None:
        if self._pointer_comes:
            self.pointer = byte % len(self.registers)
            self._pointer_comes = False
        else:
            self.registers[self.pointer] = byte
            self.step()

    def byte(self) -> int:
        return self.registers[self.pointer]

    def step(self) -> None:
        self.pointer = (self.pointer + 1) % len(self.registers)

    def over(self) -> None:
        pass


def main(dsp: Dsp, settings: Settings) -> None:
    slave = SlaveModule(dsp, Registers(settings.registers, settings.size))
    slave.start(settings.address)
    start_pie(dsp, {"I2CINT1A": slave.interrupt})
    while True:
        dsp.cpu.idle()
