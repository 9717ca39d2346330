"""Data of a sensor head: its requests, the known sensors, its schedule, and the result of a round."""

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
    """A request to one chip: a write, a read, or a write and then a read.

    If there is nothing to write and nothing to read, only the address is sent.

    name: the name of the request's transfers in records.
    pointer: the register pointer that is written first; None for no pointer.
    count: the number of bytes that are read.
    write: the bytes that are written after the pointer.
    expect: the bytes that the read should return; None to accept any bytes.
    """

    name: str
    address: int
    pointer: int | None
    count: int
    write: bytes = b""
    expect: bytes | None = None

    def transfers(self, by_stop: bool) -> list[Transfer]:
        """Return the transfers of the request.

        by_stop: True for a STOP between write and read, which are then two transfers; False for a repeated START in one
            transfer.
        """
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
    """The data registers of a sensor, and the requests with which a driver sets it up.

    pointer: the address of the first data register.
    big: True if the high byte comes first.
    lsb_per_unit: the number of LSB in one `unit`, with the range that `startup` selects.
    unit: the physical unit of the values.
    count: the number of data bytes that are read.
    order: the axes (0: x, 1: y, 2: z) in the order of their registers.
    overflow: the value that marks a result as invalid; None if there is none.
    startup: requests that set up the chip before the first round.
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
        """Return x, y, z from six bytes that were read, each a signed 16-bit value."""
        words = [int.from_bytes(data[i : i + 2], "big" if self.big else "little", signed=True) for i in (0, 2, 4)]
        return tuple(words[self.order.index(axis)] for axis in range(3))


def driver(name: str, address: int, who: tuple[int, str], writes: tuple[tuple[int, int], ...]) -> tuple[Request, ...]:
    """Return the start-up requests of a driver: a read of the identification, then writes of registers.

    who: the identification register, and its expected bytes in hexadecimal.
    writes: pairs of a register and its value.
    """
    pointer, right = who[0], bytes.fromhex(who[1])
    identify = Request(f"{name} identification", address, pointer, len(right), expect=right)
    return (identify, *(Request(f"{name} set-up", address, to, 0, bytes([value])) for to, value in writes))


def register_bytes(chip: ChipData, xyz: Sequence[Any]) -> bytes:
    """Return the six bytes of the chip's data registers for the values x, y, z.

    Raise OverflowError if a value does not fit 16 bits.
    """
    first, second, third = chip.order
    try:
        return (BIG if chip.big else LITTLE).pack(int(xyz[first]), int(xyz[second]), int(xyz[third]))
    except struct.error as error:
        raise OverflowError(f"{xyz}: {error}") from None


def known_sensors() -> Mapping[str, ChipData]:
    """Return the data of each known sensor, by the name that the key `order` of a case uses for it."""
    return cast(Mapping[str, ChipData], registered("sensors").SENSORS)


class Schedule(Struct, frozen=True):
    """The times at which the rounds of a sensor head begin. Times are in ticks.

    first: the time from the start of the run to the first round.
    period: the exact period of the rounds.
    gap: the pause between two transfers of a round, in addition to the bus-free time.
    jitter: the maximum random delay of a round. Delays are uniformly distributed from 0 to this maximum.
    rounds: number of rounds; None for no end.
    ahead: the time before `first` at which the chips are set up, if there are start-up requests.
    starts: the ticks at which the rounds begin; None if `first`, `period` and `jitter` determine these ticks.
    """

    first: int
    period: Fraction | int
    gap: int
    jitter: int = 0
    rounds: int | None = None
    ahead: int = 0
    starts: Sequence[int] | None = None


class Round(Struct):
    """The result of one round.

    number: from 1; 0 for the start-up.
    due: the tick at which the round was due.
    start: the tick at which it began.
    end: the tick at which its last transfer ended, normally with a STOP; 0 before.
    nacked: number of transfers that failed, because an address was not acknowledged or the transfer was lost.
    transfers: number of transfers.
    """

    STATE = State("number nacked transfers", ticks="due start end")

    number: int
    due: int
    start: int
    end: int = 0
    nacked: int = 0
    transfers: int = 0
