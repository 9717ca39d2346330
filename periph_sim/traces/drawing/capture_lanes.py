"""Lanes (rows) of a timing diagram for a span of a capture: waves of the wires, and the bytes on the I2C bus.

Capture --cut to span--> SCL, SDA, bytes, other wires that change
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from ...core.phrases import addressed
from ..capture.capture import Capture, Channel, Span
from ..decode import i2c
from ..decode.i2c_table import I2cRowKind, edges_of
from .svg_diagram import BLACK, Box, Lane

BUS = ("SCL", "SDA")
BYTE = 9  # number of bits of a byte with its ACK

Seconds = Callable[[float], float]  # converts a position of the capture to seconds on the axis of the diagram


def wire_lanes(
    capture: Capture,
    span: Span,
    seconds: Seconds,
    columns: int,
    expected: Mapping[tuple[int, int], int] | None = None,
) -> list[Lane]:
    """Return the lanes of the bus and of its bytes, followed by the lanes of other wires that change within the span.

    The lanes of the bus are left out if nothing happens on it within the span, or if one of SCL and SDA is missing.

    columns: the number of columns of the diagram. If a bit is narrower than a column, the lane of bytes has one box for
        each phase of a transfer instead of one for each byte. A phase extends from a START or repeated START to the
        next repeated START or STOP. If a byte is narrower than a column, or SCL rises fewer than ten times in the
        capture, there is no lane of bytes.
    expected: the expected values of wrong data bytes. The key of a byte is (position of the last START or repeated
        START before the byte, number of data bytes between the address and the byte).
    """
    lanes: list[Lane] = []
    names = [channel.name for channel in capture.channels]
    if all(name in names for name in BUS):
        bus = [_wave(capture.channel(name), span, seconds) for name in BUS]
        boxes = _boxes(capture, span, seconds, columns, expected or {})
        if boxes or any(lane.edges for lane in bus):
            lanes += [*bus, *([Lane("bytes", "bus", BLACK, boxes=boxes)] if boxes else [])]
    for channel in capture.channels:
        wave = _wave(channel, span, seconds)
        if channel.name not in BUS and wave.edges:
            lanes.append(wave)
    return lanes


def bit_of(capture: Capture, otherwise: int) -> int:
    """Return the length of a bit on the I2C bus in positions: the median distance between rising edges of SCL.

    otherwise: the result if there is no channel SCL, or if SCL has too few edges.
    """
    for channel in capture.channels:
        rises = channel.edges[channel.levels == 1]
        if channel.name == BUS[0] and len(rises) > BYTE:
            return int(np.median(np.diff(rises)))
    return otherwise


def _wave(channel: Channel, span: Span, seconds: Seconds) -> Lane:
    cut = channel.cut(span)
    edges = tuple((seconds(at), to) for at, to in zip(cut.edges.tolist(), cut.levels.tolist(), strict=True))
    return Lane(channel.name, "bus" if channel.name in BUS else "wires", BLACK, initial=cut.initial, edges=edges)


def _boxes(
    capture: Capture, span: Span, seconds: Seconds, columns: int, expected: Mapping[tuple[int, int], int]
) -> tuple[Box, ...]:
    bit = bit_of(capture, 0)
    column = (span.end - span.begin) / columns
    if not bit or column > BYTE * bit:
        return ()
    boxes = [
        box
        for transfer in i2c.transfers(_around(capture, span))
        for box in (_bytes(transfer, bit, expected) if column <= bit else _phases(transfer, span.end))
    ]
    return tuple(
        Box(seconds(begin), seconds(end), text, wrong)
        for begin, end, text, wrong in boxes
        if end > span.begin and begin < span.end
    )


Stretch = tuple[float, float, str, bool]  # begin and end of a box in positions, its text, and True for a wrong byte


# The labels of events that have no value.
LETTERS = {
    I2cRowKind.START: "S",
    I2cRowKind.REPEATED_START: "Sr",
    I2cRowKind.ACK: "A",
    I2cRowKind.NACK: "N",
    I2cRowKind.STOP: "P",
}


class LabelledEvent(NamedTuple):
    """An event of a transfer with its label, which is the same in all pictures.

    label: "S", "Sr", "0x68 R", "0x1D", "0x1D not 0x1E", "A", "N", "P", or the bits of an incomplete byte.
    place: the number of data bytes in the phase so far, including this event.
    wrong: True if the event is a data byte for which another value is expected.
    """

    event: i2c.Event
    label: str
    place: int
    wrong: bool


def labelled_events(
    transfer: i2c.Transfer, expected: Mapping[tuple[int, int], int] | None = None
) -> Iterator[LabelledEvent]:
    """Yield the events of a transfer with their labels, in order. expected: as for `wire_lanes`."""
    start = place = 0
    for event in i2c.events_of(transfer):
        wanted = None
        label = LETTERS.get(event.kind, f"0x{event.value:02X}")
        if event.kind in (I2cRowKind.START, I2cRowKind.REPEATED_START):
            start, place = event.at, 0
        elif event.kind is I2cRowKind.ADDRESS:
            label = addressed(event.value, event.read)
        elif event.kind is I2cRowKind.CUT:
            label = f"{event.value:0{event.bits}b}"
        elif event.kind is I2cRowKind.DATA:
            wanted = (expected or {}).get((start, place))
            place += 1
            label += "" if wanted is None else f" not 0x{wanted:02X}"
        yield LabelledEvent(event, label, place, wanted is not None)


def _bytes(transfer: i2c.Transfer, bit: int, expected: Mapping[tuple[int, int], int]) -> Iterator[Stretch]:
    """Yield a box for each START, complete byte, ACK, NACK and STOP of a transfer.

    An incomplete byte has no box, because it may be complete in the capture and end after the decoded part of it.
    """
    for event, label, _, wrong in labelled_events(transfer, expected):
        if event.kind is not I2cRowKind.CUT:
            yield event.at, event.last + bit / 2, label, wrong


def _phases(transfer: i2c.Transfer, end: int) -> Iterator[Stretch]:
    """Yield a box for each phase with a whole address: the address, the direction and the number of data bytes.

    If the address was not acknowledged, the box has only the address and N.
    """
    stops = [phase.start.at for phase in transfer.phases[1:]]
    stops.append(end if transfer.stop is None else transfer.stop.at)
    for phase, stop in zip(transfer.phases, stops, strict=True):
        if phase.address is not None:
            acked = phase.bytes[0].acked is not False
            text = f"{addressed(phase.address, bool(phase.read))} {len(phase.data)}"
            yield phase.start.at, stop, text if acked else f"0x{phase.address:02X} N", False


def _around(capture: Capture, span: Span) -> Capture:
    """Return the part of the capture that is decoded for a diagram of the span.

    This part begins with the last STOP before the span, or after the last unknown level before the span if that is
    later; if there is neither, with the capture. It extends beyond the end of the span by half the length of the
    span, if the capture is long enough, so that a byte at the end of a long span is complete.
    """
    scl, sda = (capture.channel(name) for name in BUS)
    known = [one for one in capture.known(scl, sda) if one.begin <= span.begin]
    edges = edges_of(scl, sda)
    before = edges.conditions[~edges.starts & (edges.conditions < span.begin)]
    end = min(capture.length, span.end + (span.end - span.begin) // 2)
    begin = max(int(before[-1]) if len(before) else 0, known[-1].begin if known else 0)
    cut = Span(begin, end)
    return Capture(capture.path, capture.rate, end, (scl.cut(cut), sda.cut(cut)), sampled=False)
