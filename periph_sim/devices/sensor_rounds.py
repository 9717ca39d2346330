"""The requests of a sensor head, the registers of a sensor that it knows, its schedule, and the result of a round."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, cast

from msgspec import Struct

from ..bus.i2c.transfer import Phase, Transfer
from ..core.registered import registered
from ..core.state import State

BIG, LITTLE = struct.Struct(">3h"), struct.Struct("<3h")


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
    """The registers of a sensor's values, and its driver.

    count: bytes of a read. big: the high byte comes first. lsb_per_unit: the number of LSB in one `unit` after
    `startup`. order: the axes in the order of their registers. overflow: the code for an invalid value. startup:
    requests that set the chip up before the first round.
    """

    address: int
    pointer: int
    big: bool = True
    lsb_per_unit: Fraction = Fraction(1)
    unit: str = "LSB"
    count: int = 6
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


def register_bytes(chip: ChipData, xyz: Sequence[Any]) -> bytes:
    """Return the six bytes of three values in the chip's order. Raise OverflowError if a value does not fit 16 bits."""
    first, second, third = chip.order
    try:
        return (BIG if chip.big else LITTLE).pack(int(xyz[first]), int(xyz[second]), int(xyz[third]))
    except struct.error as error:
        raise OverflowError(f"{xyz}: {error}") from None


def known_sensors() -> Mapping[str, ChipData]:
    """Return the registered sensors by the names that `order` of a case may give."""
    return cast(Mapping[str, ChipData], registered("sensors").SENSORS)


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
