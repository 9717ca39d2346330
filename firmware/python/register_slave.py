"""A slave with registers, as in most chips: a master writes and reads them through a pointer.

S addr W  pointer  [data ...] P             writes registers, beginning at the pointer
S addr W  pointer  Sr addr R  data ... N P  reads registers, beginning at the pointer
S addr R  data ... N P                      reads registers, beginning after the last one that was transferred
"""

from __future__ import annotations

from dataclasses import dataclass

from periph_sim.firmware import Dsp, HexBytes, start_pie

from .slave_module import SlaveModule

REPLAY = ("address",)  # settings that a replay sets from the capture


@dataclass
class Settings:
    """The settings that a case can give. registers: initial values, from register 0 on; other registers are 0."""

    address: int = 0x50
    registers: HexBytes = b""
    size: int = 256

    def __post_init__(self) -> None:
        if not 1 <= self.size <= 256:
            raise ValueError(f"size is {self.size}; a pointer of one byte addresses 1 to 256 registers")
        if len(self.registers) > self.size:
            raise ValueError(f"registers has {len(self.registers)} bytes, and there are {self.size} registers")


class Registers:
    """A target with registers. pointer: number of the register that is transferred next."""

    def __init__(self, contents: bytes, size: int) -> None:
        self.registers = bytearray(contents.ljust(size, b"\0"))
        self.pointer = 0
        self._pointer_comes = False  # True if the next received byte is the pointer

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
