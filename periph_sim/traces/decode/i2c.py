"""I2C decoder: from the edges of SCL and SDA to events and transfers.

It is a test oracle, so it shares no code with the chip's model or the agents on the simulated bus.

    edges --> clock rises with SDA's level, START and STOP --> Transfer > Phase > Byte > Bit
                                                           --> events, in order

Positions are those of logic-analyser decoders: START and STOP at the SDA edge, a byte at the rising
SCL of its first bit, ACK or NACK at the ninth.

Rules, from the I2C-bus specification (UM10204, section 3.1):
- A bit is the level of SDA at a rising SCL. If both lines change in one sample, their order is unknown: SDA's new level
  counts at a rising SCL and its old level at a falling SCL, and neither is a START or STOP.
- A falling SDA while SCL is high before and after it is a START or repeated START, a rising one is a STOP, also within
  a byte. The pulse of SCL in which it lies is no bit, except the ninth: the sender sampled the ACK when SCL rose. The
  bits of an incomplete byte are CUT.
- The first byte after a START is the address. After R/W = 1 the target drives the bytes and the controller the ACKs;
  otherwise it is the other way round. This party should drive: the lines do not show which one did.
- The two bytes of a 10-bit address are not combined: 11110xx is decoded as an address and the second byte as data.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..capture.capture import Capture
from .i2c_stream import BITS
from .i2c_table import I2cEdges, I2cRowKind, I2cTable, bit_counts, bits_of, i2c_edges, i2c_table


class Party(Enum):
    CONTROLLER = "controller"
    TARGET = "target"


class Event(NamedTuple):
    """An event: a row of `I2cTable`, except that the second byte of a 10-bit address is DATA.

    at: START, STOP: the edge of SDA; ACK, NACK: the rising SCL of the ninth bit; else that of the first bit.
    last: the rising SCL of the last bit, which is the R/W bit of an address; START, STOP: as `at`.
    value: the seven bits of an ADDRESS, the byte of DATA, the bits of CUT with the last one least significant; else -1.
    bits: the number of bits: 8 of a whole byte, 1 of ACK and NACK, fewer than 8 of CUT, 0 of START and STOP.
    read: True if the target sends in this phase, according to the R/W bit of the address.
    """

    kind: I2cRowKind
    at: int
    last: int
    value: int = -1
    bits: int = 0
    read: bool = False


# The usual names of events.
NAMES = {
    I2cRowKind.START: "START",
    I2cRowKind.REPEATED_START: "repeated START",
    I2cRowKind.ADDRESS: "address",
    I2cRowKind.DATA: "byte",
    I2cRowKind.ACK: "ACK",
    I2cRowKind.NACK: "NACK",
    I2cRowKind.STOP: "STOP",
    I2cRowKind.CUT: "cut byte",
}


class Bit(NamedTuple):
    """One pulse of SCL.

    at: the position of the rising SCL.
    low: the number of positions for which SCL was low before it, stretching included, because the lines do not show who
        held SCL; None if the capture, or its known part, began during that time.
    high: the number of positions from the rise to the fall; None if the capture ended before the fall.
    sda: the position at which SDA changed to this level; None if that was before SCL fell.
    """

    value: int
    at: int
    low: int | None
    high: int | None
    sda: int | None
    driver: Party


class Byte(NamedTuple):
    """Eight bits and the ninth. value: None if the byte is cut off. acked: None if the ninth bit is missing."""

    at: int
    value: int | None
    acked: bool | None
    bits: tuple[Bit, ...]


class Condition(NamedTuple):
    """START, repeated START or STOP.

    at: the position of the edge of SDA.
    low: the length of the low phase of SCL before it.
    high: the time from the rise of SCL to the edge of SDA. Both are None if SCL did not change since the last
        condition.
    hold: the time from the edge of SDA to the next fall of SCL; None if there is none before the next condition.
    """

    at: int
    low: int | None
    high: int | None
    hold: int | None


@dataclass(frozen=True, slots=True)
class Phase:
    """The part of a transfer after a START or repeated START. Address and direction are None if they were cut off."""

    start: Condition
    address: int | None
    read: bool | None
    bytes: tuple[Byte, ...]  # bytes[0] is the address

    @property
    def data(self) -> tuple[int, ...]:
        """The values of all complete data bytes."""
        return tuple(byte.value for byte in self.bytes[1:] if byte.value is not None)


@dataclass(frozen=True, slots=True)
class Transfer:
    """A transfer from START to STOP.

    gap: the number of positions between the STOP before and this START; None if that STOP was not captured.
    stop: None if the capture ends before the STOP.
    lead: pulses of SCL before the first START of the capture. They belong to a transfer whose START was not captured.
        It has no phases, because the boundaries of its bytes are unknown.
    """

    phases: tuple[Phase, ...]
    stop: Condition | None
    gap: int | None
    lead: tuple[Bit, ...] = ()

    @property
    def complete(self) -> bool:
        return bool(self.phases) and self.stop is not None


_Pulse = tuple[int, int, int | None, int | None, int | None]  # a bit without its driver


def transfers(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA") -> list[Transfer]:
    """Decode all transfers of a capture, in order. Raise LookupError for a missing channel."""
    return [transfer for edges in i2c_edges(capture, scl, sda) for transfer in _transfers(edges)]


def events(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA") -> list[Event]:
    """Decode all events of a capture, in order, from the first START on. Raise LookupError for a missing channel."""
    return events_of_table(i2c_table(capture, scl, sda))


def events_of_table(table: I2cTable) -> list[Event]:
    """Return the rows of a table as events."""
    columns = (table.kind, table.at, table.last, table.value, table.bits, table.read)
    return [_event(I2cRowKind(kind), *rest) for kind, *rest in zip(*(c.tolist() for c in columns), strict=True)]


def _event(kind: I2cRowKind, at: int, last: int, value: int, bits: int, read: bool) -> Event:
    if kind is I2cRowKind.ADDRESS_LOW:
        return Event(I2cRowKind.DATA, at, last, value & 0xFF, bits, read)
    return Event(kind, at, last, value, bits, read)


def events_of(transfer: Transfer) -> Iterator[Event]:
    """Yield the events of one transfer, in order."""
    for number, phase in enumerate(transfer.phases):
        start = phase.start.at
        yield Event(I2cRowKind.REPEATED_START if number else I2cRowKind.START, start, start)
        read = bool(phase.read)
        for place, byte in enumerate(phase.bytes):
            sent = byte.bits[:8]
            kind = I2cRowKind.DATA if place else I2cRowKind.ADDRESS
            if byte.value is None:
                kind = I2cRowKind.CUT
            value = number_of(sent) >> (kind is I2cRowKind.ADDRESS)
            yield Event(kind, byte.at, sent[-1].at, value, len(sent), read)
            if byte.acked is not None:
                ninth = byte.bits[8].at
                yield Event(I2cRowKind.ACK if byte.acked else I2cRowKind.NACK, ninth, ninth, -1, 1, read)
    if transfer.stop is not None and transfer.phases:
        yield Event(I2cRowKind.STOP, transfer.stop.at, transfer.stop.at)


def number_of(bits: Sequence[Bit]) -> int:
    """Return the number that bits form, the first one most significant."""
    value = 0
    for bit in bits:
        value = value << 1 | bit.value
    return value


def shared_edges(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA") -> int:
    """Count the samples in which both lines change.

    The order of these edges is unknown: they may be a START or STOP.
    """
    clock, data = capture.channel(scl), capture.channel(sda)
    return len(np.intersect1d(clock.edges, data.edges, assume_unique=True))


def _transfers(edges: I2cEdges) -> Iterator[Transfer]:
    """Yield the transfers of a span. The bytes between two conditions belong to the first one."""
    pulses = _pulses(edges)
    conditions = _conditions(edges, pulses)
    starts, seen, counts = (column.tolist() for column in (edges.starts, edges.seen, bit_counts(edges)))
    phases: list[Phase] = []
    gap: int | None = None
    first = starts.index(True) if True in starts else len(starts)
    lead = seen[first] if first < len(seen) else len(pulses)
    stop = conditions[first - 1] if first else None
    stopped = None if stop is None else stop.at  # position of the last STOP
    if lead or first:
        yield Transfer((), stop, None, tuple(Bit(*pulse, Party.CONTROLLER) for pulse in pulses[:lead]))
    for number in range(first, len(conditions)):
        condition = conditions[number]
        if starts[number]:
            if not phases:
                gap = None if stopped is None else condition.at - stopped
            phases.append(_phase(condition, pulses[seen[number] : seen[number] + counts[number]]))
            continue
        if phases:
            yield Transfer(tuple(phases), condition, gap)
        phases = []
        stopped = condition.at
    if phases:
        yield Transfer(tuple(phases), None, gap)


def _phase(start: Condition, pulses: list[_Pulse]) -> Phase:
    """Return the phase that consists of a START and the bytes of these pulses."""
    read: bool | None = None
    address: int | None = None
    found: list[Byte] = []
    for begin in range(0, len(pulses), BITS):
        byte = _byte(pulses[begin : begin + BITS], Party.TARGET if read else Party.CONTROLLER)
        if not begin and byte.value is not None:
            address, read = byte.value >> 1, bool(byte.value & 1)
        found.append(byte)
    return Phase(start, address, read, tuple(found))


def _byte(pulses: list[_Pulse], sender: Party) -> Byte:
    other = Party.TARGET if sender is Party.CONTROLLER else Party.CONTROLLER
    bits = [Bit(*pulse, sender) for pulse in pulses[:8]] + [Bit(*pulse, other) for pulse in pulses[8:]]
    value = number_of(bits[:8]) if len(bits) >= 8 else None
    return Byte(bits[0].at, value, not bits[8].value if len(bits) == BITS else None, tuple(bits))


def _pulses(edges: I2cEdges) -> list[_Pulse]:
    at, value, low, high = bits_of(edges)
    last = np.searchsorted(edges.data.edges, at, side="right")
    settled = np.concatenate(([-1], edges.data.edges))[last]
    settled[(low >= 0) & (settled < at - low)] = -1
    return list(zip(value.tolist(), at.tolist(), _known(low), _known(high), _known(settled), strict=True))


def _known(column: NDArray[np.int64]) -> list[int | None]:
    return [None if value < 0 else value for value in column.tolist()]


def _conditions(edges: I2cEdges, pulses: list[_Pulse]) -> list[Condition]:
    at, falls = edges.conditions, edges.clock.edges[edges.clock.levels == 0]
    fall = np.append(falls, -1)[np.searchsorted(falls, at)]
    hold = fall - at
    hold[:-1][at[1:] < fall[:-1]] = -1
    found: list[Condition] = []
    before = 0  # number of rises before the last condition
    for place, seen, held in zip(at.tolist(), edges.seen.tolist(), _known(hold), strict=True):
        low = high = None
        if seen > before:
            _, rise, low, _, _ = pulses[seen - 1]
            high = place - rise
        found.append(Condition(place, low, high, held))
        before = seen
    return found
