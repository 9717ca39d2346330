"""The requests of a sensor head, its three known chips, its schedule, and the result of a round.

Source: the dissertation's Figure A.2 (order), Table 3.1 (scales); data sheets of ITG-3200 (registers 0x1D to 0x22),
ADXL345 (0x32 to 0x37), HMC5883L (0x03 to 0x08).
"""

from __future__ import annotations

from fractions import Fraction

from msgspec import Struct

from ..bus.i2c.transfer import Phase, Transfer
from ..core.state import State


class Request(Struct, frozen=True):
    """One read or write of a round. pointer None: no pointer is written. write: bytes after the pointer.

    Without pointer, write and count it is an address alone, to see if it is acknowledged.
    """

    name: str
    address: int
    pointer: int | None
    count: int
    write: bytes = b""
    expect: bytes | None = None

    def transfers(self, by_stop: bool) -> list[Transfer]:
        """Return its transfers: one with a repeated START, or two."""
        head = b"" if self.pointer is None else bytes([self.pointer])
        phases: list[Phase] = []
        if head or self.write or not self.count:
            phases.append(Phase(self.address, read=False, data=head + self.write))
        if self.count:
            phases.append(Phase(self.address, read=True, count=self.count, expect=self.expect))
        if by_stop:
            return [Transfer(self.name, [phase]) for phase in phases]
        return [Transfer(self.name, phases)]


class ChipData(Struct, frozen=True):
    """The registers of a sensor's three values, and its driver.

    big: the high byte comes first. lsb_per_unit: the number of LSB in one deg/s, g or gauss after `startup`. order: the
    axes in the order of their registers. overflow: the code for an invalid value. startup: requests that set the
    chip up before the first round.
    """

    address: int
    pointer: int
    big: bool
    lsb_per_unit: Fraction
    order: tuple[int, int, int] = (0, 1, 2)
    overflow: int | None = None
    startup: tuple[Request, ...] = ()

    def values(self, data: bytes) -> tuple[int, ...]:
        """Return the values x, y, z of six bytes read, signed 16-bit."""
        words = [int.from_bytes(data[i : i + 2], "big" if self.big else "little", signed=True) for i in (0, 2, 4)]
        return tuple(words[self.order.index(axis)] for axis in range(3))


def driver(name: str, address: int, who: tuple[int, str], writes: tuple[tuple[int, int], ...]) -> tuple[Request, ...]:
    """Return a driver's start-up: read the identification (register, expected bytes), then write the registers."""
    pointer, right = who[0], bytes.fromhex(who[1])
    identify = Request(f"{name} identification", address, pointer, len(right), expect=right)
    return (identify, *(Request(f"{name} set-up", address, to, 0, bytes([value])) for to, value in writes))


CHIPS: dict[str, ChipData] = {
    "gyroscope": ChipData(
        0x68,
        0x1D,
        big=True,
        lsb_per_unit=Fraction(115, 8),
        # PLL with the x gyroscope, 1 kHz, full scale 2000 deg/s and 42 Hz
        startup=driver("gyroscope", 0x68, (0x00, "68"), ((0x3E, 0x01), (0x15, 0x00), (0x16, 0x1B))),
    ),
    "accelerometer": ChipData(
        0x53,
        0x32,
        big=False,
        lsb_per_unit=Fraction(256),
        # 100 Hz, full resolution and 2 g, measure
        startup=driver("accelerometer", 0x53, (0x00, "e5"), ((0x2C, 0x0A), (0x31, 0x08), (0x2D, 0x08))),
    ),
    "magnetometer": ChipData(
        0x1E,
        0x03,
        big=True,
        order=(0, 2, 1),
        lsb_per_unit=Fraction(660),
        overflow=-4096,
        # 75 Hz, 2.5 gauss, continuous
        startup=driver("magnetometer", 0x1E, (0x0A, "48 34 33"), ((0x00, 0x18), (0x01, 0x60), (0x02, 0x00))),
    ),
}


ADDRESSES = frozenset(chip.address for chip in CHIPS.values())


class Schedule(Struct, frozen=True):
    """Times in ticks, the period exact. jitter: maximum delay of each round, uniformly distributed.

    ahead: time before `first` at which the chips are set up, if they are.
    """

    first: int
    period: Fraction | int
    gap: int  # between two transfers of a round, on top of the bus-free time
    jitter: int = 0
    rounds: int | None = None  # None: until the end of the run
    ahead: int = 0


class Round(Struct):
    """The result of one round. number: from 1; the start-up is 0. due: the scheduled begin; end: the last STOP."""

    STATE = State("number nacked transfers", ticks="due start end")

    number: int
    due: int
    start: int
    end: int = 0
    nacked: int = 0  # requests whose address was not acknowledged
    transfers: int = 0
