"""Models of the chips' registers while nothing is measured, as simple as possible: a dictionary and a pointer."""

from __future__ import annotations

from tests.devices.register_tables import ADXL345, HMC5883L, ITG3200

BITS = {  # bits that software can write; all eight where a register is not named
    ADXL345: {0x2A: 0x0F, 0x2C: 0x1F, 0x2D: 0x3F, 0x31: 0xEF},
    ITG3200: {0x00: 0x7F, 0x16: 0x1F, 0x17: 0xF5},
    HMC5883L: {0x00: 0x7F, 0x02: 0x83},
}


class Oracle:
    """Registers of a chip.

    memory: value of each register, at first the one at power-on
    pointer: number of the register that is read or written next, at first 0
    """

    def __init__(self, table: str) -> None:
        rows = [line.split() for line in table.strip().splitlines()]
        self.memory = {int(number, 16): int(value, 16) for number, _, _, value in rows}
        self.bits = {int(number, 16): 0xFF for number, _, access, _ in rows if access == "RW"} | BITS[table]
        self.pointer = 0

    def set_pointer(self, number: int) -> None:
        self.pointer = number

    def write(self, value: int) -> None:
        self.memory_write(self.pointer, value)
        self.pointer = self.following(self.pointer)

    def memory_write(self, number: int, value: int) -> None:
        if number in self.bits:
            self.memory[number] = value & self.bits[number]

    def read(self) -> int:
        value = self.value(self.pointer)
        self.pointer = self.following(self.pointer)
        return value

    def value(self, number: int) -> int:
        return self.memory.get(number, 0)

    def following(self, number: int) -> int:
        return (number + 1) % 256


class AdxlOracle(Oracle):
    """An ADXL345 in standby. Its empty FIFO has reached the watermark if that is 0."""

    def __init__(self) -> None:
        super().__init__(ADXL345)

    def value(self, number: int) -> int:
        return 0x02 * (self.memory[0x38] & 0x1F == 0) if number == 0x30 else super().value(number)


class ItgOracle(Oracle):
    """A sleeping ITG-3200."""

    def __init__(self) -> None:
        super().__init__(ITG3200)
        self.memory[0x3E] = 0x40

    def following(self, number: int) -> int:
        return number if 35 <= number <= 60 else super().following(number)


class HmcOracle(Oracle):
    """An idle HMC5883L, in which only LOCK changes."""

    def __init__(self) -> None:
        super().__init__(HMC5883L)
        self.seen: set[int] = set()
        self.lock = 0

    def following(self, number: int) -> int:
        return 3 if number == 8 else 0 if number == 12 else super().following(number)

    def memory_write(self, number: int, value: int) -> None:
        super().memory_write(number, value)
        if number in (0, 2):
            self.lock, self.seen = 0, set()

    def value(self, number: int) -> int:
        if number == 2:
            self.lock = 1
        elif 3 <= number <= 8:
            self.seen.add(number)
            self.lock = int(len(self.seen) < 6)
            self.seen = self.seen if self.lock else set()
        return self.lock << 1 if number == 9 else super().value(number)
