"""I2C decoder: from the edges of SCL and SDA to events and transfers.

The decoder is a test oracle, so it shares no code with the model of the I2C module or the agents on the simulated bus.

    edges --> clock rises with SDA's level, START and STOP --> Transfer > Phase > Byte > Bit
                                                           --> events, in order

Positions are as in the decoders of logic analysers: a START or STOP is at the edge of SDA, a byte at the rising SCL of
its first bit, and an ACK or NACK at the rising SCL of the ninth bit.

Rules, from the I2C-bus specification (UM10204, section 3.1):
- A bit is the level of SDA at a rising SCL. If both lines change in one sample, the order of the edges is unknown: at a
  rising SCL the new level of SDA counts, and at a falling SCL the old level. Such a change of SDA is no START or STOP.
- If SCL is high before and after an edge of SDA, a falling edge is a START or repeated START, and a rising edge is a
  STOP, even within a byte. A pulse of SCL that contains such an edge is counted as a bit only if it is the ninth pulse
  of a byte, because its ACK was already transferred when SCL rose. The bits of an incomplete byte are decoded as CUT.
- The first byte after a START is the address. After R/W = 1 the target drives the data bytes and the controller the
  ACKs; otherwise the controller drives the bytes and the target the ACKs. The `driver` of a bit is the party that
  drives SDA according to this rule. The lines do not show which party really drives it.
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
from .i2c_table import I2cEdges, I2cRowKind, bit_counts, bits_of, i2c_edges, i2c_table


class Party(Enum):
    CONTROLLER = "controller"
    TARGET = "target"


class Event(NamedTuple):
    """An event: a row of `I2cTable`, except that the second byte of a 10-bit address is DATA.

    at: the edge of SDA for START and STOP, otherwise the rising SCL of the first bit (for ACK and NACK the ninth bit).
    last: the rising SCL of the last bit (for an address its R/W bit); equal to `at` for START and STOP.
    value: the seven bits of an ADDRESS, the byte of DATA, or the bits of CUT, the last bit least significant; -1 for
        other kinds.
    bits: the number of bits: 8 for a complete byte, 1 for ACK and NACK, fewer than 8 for CUT, 0 for START and STOP.
    read: True if the R/W bit of the address says that the target sends in this phase.
    """

    kind: I2cRowKind
    at: int
    last: int
    value: int = -1
    bits: int = 0
    read: bool = False


# The names of events in texts.
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

    value: the level of SDA.
    at: the position at which SCL rises.
    low: the length of the low phase of SCL before the rise, in positions, including stretching; None if the capture, or
        its known part, begins within this phase.
    high: the length of the high phase of SCL, in positions; None if the capture, or its known part, ends within it.
    sda: the position at which SDA changed to this level; None if SDA already had this level when SCL fell.
    driver: the party that should drive SDA in this pulse.
    """

    value: int
    at: int
    low: int | None
    high: int | None
    sda: int | None
    driver: Party


class Byte(NamedTuple):
    """Eight bits and the ACK bit, or fewer bits if the byte is cut off.

    at: the rising SCL of the first bit.
    value: the first eight bits as a number; None if there are fewer.
    acked: True if the ninth bit is low; None if this bit is missing.
    """

    at: int
    value: int | None
    acked: bool | None
    bits: tuple[Bit, ...]


class Condition(NamedTuple):
    """START, repeated START or STOP.

    at: the position of the edge of SDA.
    low: the length of the last low phase of SCL before this edge, in positions.
    high: the number of positions from the last rise of SCL to this edge. `low` and `high` are None if SCL did not rise
        since the previous condition; `low` is also None if the capture, or its known part, begins within the low phase.
    hold: the number of positions from this edge to the next fall of SCL; None if there is no such fall, or if the next
        condition is before this fall.
    """

    at: int
    low: int | None
    high: int | None
    hold: int | None


@dataclass(frozen=True, slots=True)
class Phase:
    """The part of a transfer from a START or repeated START to the next condition.

    address, read: the address and the direction; None if the address byte is cut off.
    bytes: all bytes; the first byte has the address.
    """

    start: Condition
    address: int | None
    read: bool | None
    bytes: tuple[Byte, ...]

    @property
    def data(self) -> tuple[int, ...]:
        """The values of all complete data bytes."""
        return tuple(byte.value for byte in self.bytes[1:] if byte.value is not None)


@dataclass(frozen=True, slots=True)
class Transfer:
    """A transfer from START to STOP. The rest of a transfer whose START was not captured is a `Transfer`, too.

    Such a rest has no phases, because the boundaries of its bytes are unknown. It has all pulses before the first START
    of a span. A span is a part of the capture in which the levels are known.

    phases: the phases; empty in a rest.
    stop: the STOP; None if the span ends before it. In a rest, the last STOP before the first START; None without one.
    gap: the number of positions from the previous STOP to the START; None in a rest, and if the span has no such STOP.
    lead: the pulses of a rest; empty in a transfer with a START.
    """

    phases: tuple[Phase, ...]
    stop: Condition | None
    gap: int | None
    lead: tuple[Bit, ...] = ()

    @property
    def complete(self) -> bool:
        return bool(self.phases) and self.stop is not None


_Pulse = tuple[int, int, int | None, int | None, int | None]  # the fields of a Bit, except its driver


def transfers(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA") -> list[Transfer]:
    """Decode all transfers of a capture, in order. Raise LookupError if a channel is missing or ambiguous."""
    return [transfer for edges in i2c_edges(capture, scl, sda) for transfer in _transfers(edges)]


def events(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA") -> list[Event]:
    """Decode all events of a capture, in order, from the first START of each known span on.

    Raise LookupError if a channel is missing or ambiguous.
    """
    table = i2c_table(capture, scl, sda)
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
            at, last, value, count = byte.at, sent[-1].at, number_of(sent), len(sent)
            if byte.value is None:
                yield Event(I2cRowKind.CUT, at, last, value, count, read)
            elif place == 0:
                yield Event(I2cRowKind.ADDRESS, at, last, value >> 1, count, bool(value & 1))
            else:
                yield Event(I2cRowKind.DATA, at, last, value, count, read)
            if byte.acked is not None:
                ninth = byte.bits[8].at
                yield Event(I2cRowKind.ACK if byte.acked else I2cRowKind.NACK, ninth, ninth, -1, 1, read)
    if transfer.stop is not None and transfer.phases:
        yield Event(I2cRowKind.STOP, transfer.stop.at, transfer.stop.at)


def number_of(bits: Sequence[Bit]) -> int:
    """Return the number that the bits form, with the first bit most significant."""
    value = 0
    for bit in bits:
        value = value << 1 | bit.value
    return value


def shared_edges(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA") -> int:
    """Count the samples in which both lines change.

    The order of the two edges in such a sample is unknown, so the edge of SDA may be a START or STOP.
    """
    clock, data = capture.channel(scl), capture.channel(sda)
    return len(np.intersect1d(clock.edges, data.edges, assume_unique=True))


def _transfers(edges: I2cEdges) -> Iterator[Transfer]:
    """Yield the transfers of a span. Bytes belong to the phase of the last condition before them."""
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
    """Return the phase that consists of a START and of the bytes that these pulses transfer."""
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
