"""I2C from edges: SCL and SDA in, events and transfers out.

An oracle: it shares no code with the chip's model or the agents on the simulated bus.

    edges --> clock rises with SDA's level, START and STOP --> Transfer > Phase > Byte > Bit
                                                           --> events, in order

Positions are those of logic-analyser decoders: START and STOP at the SDA edge, a byte at the rising
SCL of its first bit, ACK or NACK at the ninth.

Rules, from the I2C-bus specification (UM10204, section 3.1):
- A bit is SDA's level at a rising SCL. Where both lines change in one sample the order is unknown: at a
  rising SCL SDA's new level counts, at a falling SCL its old one, and neither is a START or STOP.
- SDA falling while SCL is high before and after is START or repeated START, rising is STOP, at any
  place. The SCL high phase in which it comes holds no bit, unless it is the ninth: the sender sampled the
  ACK when SCL rose. The bits of an incomplete byte are `Cut`.
- The first byte after a START is the address. Bytes after R/W = 1 are the target's, their ACKs the
  controller's; else the other way round. This is who should drive: the lines do not show who did.
- 10-bit addresses are not joined: 11110xx comes as an address, the second byte as data.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..capture.capture import Capture, Channel


class Party(Enum):
    CONTROLLER = "controller"
    TARGET = "target"


@dataclass(frozen=True, slots=True)
class Start:
    at: int


@dataclass(frozen=True, slots=True)
class RepeatedStart:
    at: int


@dataclass(frozen=True, slots=True)
class Address:
    """value: seven bits, right-aligned. rw_at: the rising SCL of the R/W bit."""

    at: int
    value: int
    read: bool
    rw_at: int


@dataclass(frozen=True, slots=True)
class Data:
    """read: True if the target sends it, by the address's R/W bit."""

    at: int
    value: int
    read: bool


@dataclass(frozen=True, slots=True)
class Ack:
    at: int


@dataclass(frozen=True, slots=True)
class Nack:
    at: int


@dataclass(frozen=True, slots=True)
class Stop:
    at: int


@dataclass(frozen=True, slots=True)
class Cut:
    """Bits of a byte, most significant first, that START, STOP or the end of the capture left incomplete."""

    at: int
    bits: tuple[int, ...]


Event = Start | RepeatedStart | Address | Data | Ack | Nack | Stop | Cut


class Bit(NamedTuple):
    """One SCL pulse.

    at: its rising SCL. low: positions SCL was low before it; None if the capture (or its known part) began
    within. high: positions from the rise to the fall; None if the capture ended before. Stretching is part
    of `low`: the lines do not show who held SCL. sda: where SDA took this level, if since SCL fell.
    """

    value: int
    at: int
    low: int | None
    high: int | None
    sda: int | None
    driver: Party


class Byte(NamedTuple):
    """Eight bits and the ninth. value: None if cut off; acked: None if the ninth bit is missing."""

    at: int
    value: int | None
    acked: bool | None
    bits: tuple[Bit, ...]


class Condition(NamedTuple):
    """START, repeated START or STOP.

    at: the SDA edge. low, high: the SCL low phase before it, and from SCL's rise to the SDA edge; None where SCL
    did not move since the last condition. hold: from the SDA edge to SCL's fall; None if none came.
    """

    at: int
    low: int | None
    high: int | None
    hold: int | None


@dataclass(frozen=True, slots=True)
class Phase:
    """From a START or repeated START on: the address byte and what follows it. All None if it was cut off."""

    start: Condition
    address: int | None
    read: bool | None
    bytes: tuple[Byte, ...]  # bytes[0] is the address

    @property
    def data(self) -> tuple[int, ...]:
        """Values of the whole data bytes."""
        return tuple(byte.value for byte in self.bytes[1:] if byte.value is not None)


@dataclass(frozen=True, slots=True)
class Transfer:
    """From START to STOP.

    gap: positions between the STOP before and this START; None if there is no such STOP in sight.
    stop: None if the capture ends first. lead: rising SCL before the first START of the capture, of a
    transfer whose START was not captured; it has no phases, since the bounds of its bytes are unknown.
    """

    phases: tuple[Phase, ...]
    stop: Condition | None
    gap: int | None
    lead: tuple[Bit, ...] = ()

    @property
    def complete(self) -> bool:
        return bool(self.phases) and self.stop is not None


@dataclass(frozen=True, slots=True)
class _Pulses:
    """The lines within a span, as plain lists: rising SCL one by one, conditions one by one."""

    rises: list[int]
    values: list[int]  # SDA at the rise
    falls_before: list[int]  # the SCL fall before each rise; -1 if not in the capture
    falls_after: list[int]  # and after it
    settled: list[int]  # SDA's last edge up to the rise; -1 if none since the fall
    conditions: list[int]  # SDA edges under steadily high SCL
    starts: list[bool]  # falling ones
    seen: list[int]  # rises before each condition
    falls_behind: list[int]  # the SCL fall after each condition; -1 if not in the capture


def transfers(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA") -> list[Transfer]:
    """Decode all transfers of a capture, in order. LookupError for a missing channel."""
    lines = capture.channel(scl), capture.channel(sda)
    found: list[Transfer] = []
    for span in capture.known(*lines):
        found.extend(_transfers(_pulses(*(line.cut(span) for line in lines))))
    return found


def events(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA") -> list[Event]:
    """Decode all events of a capture, in order, from the first START on. LookupError for a missing channel."""
    return [event for transfer in transfers(capture, scl, sda) for event in events_of(transfer)]


def events_of(transfer: Transfer) -> Iterator[Event]:
    """Yield the events of one transfer, in order."""
    for number, phase in enumerate(transfer.phases):
        yield RepeatedStart(phase.start.at) if number else Start(phase.start.at)
        for place, byte in enumerate(phase.bytes):
            if byte.value is None:
                yield Cut(byte.at, tuple(bit.value for bit in byte.bits))
                continue
            if place == 0:
                yield Address(byte.at, byte.value >> 1, bool(byte.value & 1), byte.bits[7].at)
            else:
                yield Data(byte.at, byte.value, bool(phase.read))
            if byte.acked is not None:
                yield Ack(byte.bits[8].at) if byte.acked else Nack(byte.bits[8].at)
    if transfer.stop is not None and transfer.phases:
        yield Stop(transfer.stop.at)


def shared_edges(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA") -> int:
    """Count the samples with an edge of both lines, whose order, and so a START or STOP, is unknown."""
    clock, data = capture.channel(scl), capture.channel(sda)
    return len(np.intersect1d(clock.edges, data.edges, assume_unique=True))


def _pulses(scl: Channel, sda: Channel) -> _Pulses:
    rises = scl.edges[scl.levels == 1]
    falls = scl.edges[scl.levels == 0]
    padded = np.concatenate(([-1], falls, [-1]))
    fallen = np.searchsorted(falls, rises)  # falls before each rise
    last = np.searchsorted(sda.edges, rises, side="right")
    settled = np.concatenate(([-1], sda.edges))[last]
    settled[settled < padded[fallen]] = -1
    steady = (scl.before(sda.edges) == 1) & (scl.at(sda.edges) == 1)
    conditions = sda.edges[steady]
    return _Pulses(
        rises.tolist(),
        sda.at(rises).tolist(),
        padded[fallen].tolist(),
        padded[fallen + 1].tolist(),
        settled.tolist(),
        conditions.tolist(),
        (sda.levels[steady] == 0).tolist(),
        np.searchsorted(rises, conditions).tolist(),
        padded[np.searchsorted(falls, conditions) + 1].tolist(),
    )


def _transfers(p: _Pulses) -> Iterator[Transfer]:
    """Go from condition to condition; the bytes between two of them belong to the first."""
    phases: list[Phase] = []
    stopped: int | None = None  # where the last STOP was
    gap: int | None = None
    first = next((n for n, start in enumerate(p.starts) if start), len(p.starts))
    lead = p.seen[first] if first < len(p.seen) else len(p.rises)
    if lead or first:
        stop = _condition(p, first - 1) if first else None
        yield Transfer((), stop, None, tuple(_bit(p, n, Party.CONTROLLER) for n in range(lead)))
        stopped = p.conditions[first - 1] if first else None
    for number in range(first, len(p.conditions)):
        if not p.starts[number]:
            if phases:
                yield Transfer(tuple(phases), _condition(p, number), gap)
            phases = []
            stopped = p.conditions[number]
            continue
        if not phases:
            gap = None if stopped is None else p.conditions[number] - stopped
        phases.append(_phase(p, number))
    if phases:
        yield Transfer(tuple(phases), None, gap)


def _phase(p: _Pulses, number: int) -> Phase:
    """Return START number `number` with the bytes up to the next condition."""
    begin = p.seen[number]
    if number + 1 == len(p.conditions):
        end = len(p.rises)
    else:
        end = max(begin, p.seen[number + 1] - 1)
        if (end - begin) % 9 == 8:  # the condition's own pulse is the ninth
            end += 1
    bounds = [*range(begin, end, 9), end]
    read: bool | None = None
    address: int | None = None
    found: list[Byte] = []
    for place, (a, b) in enumerate(pairwise(bounds)):
        byte = _byte(p, a, b, Party.TARGET if read else Party.CONTROLLER)
        if place == 0 and byte.value is not None:
            address, read = byte.value >> 1, bool(byte.value & 1)
        found.append(byte)
    return Phase(_condition(p, number), address, read, tuple(found))


def _byte(p: _Pulses, begin: int, end: int, sender: Party) -> Byte:
    other = Party.TARGET if sender is Party.CONTROLLER else Party.CONTROLLER
    bits = tuple(_bit(p, n, sender if n < begin + 8 else other) for n in range(begin, end))
    value: int | None = None
    if len(bits) >= 8:
        value = 0
        for bit in bits[:8]:
            value = value << 1 | bit.value
    return Byte(bits[0].at, value, not bits[8].value if len(bits) == 9 else None, bits)


def _bit(p: _Pulses, n: int, driver: Party) -> Bit:
    at, fell, falls = p.rises[n], p.falls_before[n], p.falls_after[n]
    low = at - fell if fell >= 0 else None
    high = falls - at if falls >= 0 else None
    return Bit(p.values[n], at, low, high, p.settled[n] if p.settled[n] >= 0 else None, driver)


def _condition(p: _Pulses, number: int) -> Condition:
    at, rises, fall = p.conditions[number], p.seen[number], p.falls_behind[number]
    moved = rises > (p.seen[number - 1] if number else 0)
    hold = fall - at if fall >= 0 else None
    if number + 1 < len(p.conditions) and p.conditions[number + 1] < fall:
        hold = None
    if not moved:
        return Condition(at, None, None, hold)
    rise, fell = p.rises[rises - 1], p.falls_before[rises - 1]
    return Condition(at, rise - fell if fell >= 0 else None, at - rise, hold)
