"""Decoder of asynchronous serial frames: from the edges of one line to frames and breaks.

The decoder is a test oracle, so it shares no code with the SCI model.

           ___     ___ ___ ___ ... ___ ___
    idle      \\___/___X___X___X ...___/        start bit, data (least significant first), parity, stop
            |   '   '   '   '        '
            at  mid-bit: where each bit is sampled

Rules:
- A falling edge starts a frame. The true edge is between two samples, so bits are measured from half a sample before
  the first low sample.
- Each bit is sampled once, at the first sample at or after the middle of the bit, or three times around its middle. Of
  three samples, the majority counts. If the start bit is sampled high, the event is a rejected start.
- Only the first stop bit is checked. The first falling edge after the sample point of this bit starts the next frame.
- A low phase that ends and is at least as long as a frame is a break. If it does not begin within a frame, it is also
  decoded as a frame.
- A pulse shorter than half a bit is a glitch. If a glitch is in the interval in which receivers may sample a bit
  (`windows_of`), some receivers may read this bit as 0 and others as 1.

    falling edges --> the next possible start after each --> chain of frames --> edges within each frame --> bits

The position of a frame determines where the next frame can begin, so frames are found one after the other (this is the
chain), with one list access for each. All other steps are done for all frames at once, in arrays. The function `events`
converts the rows of the resulting table to objects.
"""

from __future__ import annotations

from enum import IntEnum
from fractions import Fraction
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...core.input_error import InputError
from ..capture.capture import Capture, Channel, Positions
from ..capture.sampling import rate_text, sample_step
from .table_columns import joined, select
from .uart_line import PARITIES, Line

HALF, QUARTER, LATEST = Fraction(1, 2), Fraction(1, 4), Fraction(7, 8)


def width_of(capture: Capture, baud: Fraction | int) -> Fraction:
    """Return the length of a bit in positions.

    Raise ValueError if the capture has no rate, or fewer than two positions per bit.
    """
    rate = capture.rate_for("frames need")
    width = rate / Fraction(baud)
    if width < 2:
        raise InputError(
            f"{capture.path}: {float(width):.2f} samples a bit at {float(baud):.7g} baud; expected at least 2, "
            f"so the rate of {rate_text(rate)} or the baud rate is wrong"
        )
    return width


def sample_points_of(line: Line, width: Fraction, step: int = 1, vote: bool = False) -> list[tuple[int, ...]]:
    """Return the sample points of each bit, from the start bit to the first stop bit.

    A sample point is an offset in positions from the first low position of the frame.

    width: the length of a bit in positions.
    step: the length of a sample in positions.
    vote: True for three samples an eighth of a bit apart; False for one sample in the middle of the bit.
    """
    places = (Fraction(3, 8), HALF, Fraction(5, 8)) if vote else (HALF,)
    bits = range(_checked_bits(line))
    # Places are in bits. They are counted from half a sample before the first low sample, and rounded up to a sample.
    return [tuple(step * ceil((bit + place) * width / step - HALF) for place in places) for bit in bits]


def windows_of(line: Line, width: Fraction) -> list[tuple[int, int]]:
    """Return the interval in which a receiver may sample each bit, as offsets from the first low position of the frame.

    For the start bit, the interval begins at the first low position; for all others, at a quarter of the bit. It ends
    at seven eighths of the bit. Receivers with 8 or 16 samples per bit vote around the middle of a bit, and detect the
    start edge up to one of these samples late.
    """
    bits = range(_checked_bits(line))
    return [(int((bit + QUARTER) * width) + 1 if bit else 0, int((bit + LATEST) * width)) for bit in bits]


def _checked_bits(line: Line) -> int:
    return 2 + line.bits + (line.parity != "none")


def sample_point_step(step: int, width: Fraction | float) -> int:
    """Return the step of sample points, in positions: `step`, or 1 if a bit is shorter than two steps.

    A capture that can be decoded has at least two samples per bit. So if a bit is shorter than two steps, `step` is not
    the sampling grid of an analyser, but the grid on which the edges of the signal happen to lie.
    """
    return step if width >= 2 * step else 1


class UartRowKind(IntEnum):
    """Kind of a row. CUT: a frame that is incomplete because the capture, or its known part, ends within the frame."""

    FRAME = 0
    BREAK = 1
    CUT = 2
    REJECTED = 3


class UartTable(NamedTuple):
    """Events of a line in the order in which they begin: a tuple of columns, which are arrays of equal length.

    If a frame and a break begin at the same edge, the frame comes first.

    kind          uint8   a `UartRowKind`
    at            int64   the start edge
    end           int64   for FRAME the end of the last stop bit; for BREAK and REJECTED the rising edge; for CUT the
                          end of the capture or of its known part
    value         int32   the data bits, the first bit least significant; -1 for BREAK and REJECTED
    bits          uint8   number of received data bits; 0 for BREAK and REJECTED
    parity_error  bool    True if the parity bit is wrong
    frame_error   bool    True if the stop bit is low
    glitched      bool    True if there is a glitch within the frame
    unsure        int32   mask of the bits that a glitch may change in a receiver: bit 0 is the start bit, bit 1 the
                          first data bit, and so on
    """

    kind: NDArray[np.uint8]
    at: Positions
    end: Positions
    value: NDArray[np.int32]
    bits: NDArray[np.uint8]
    parity_error: NDArray[np.bool_]
    frame_error: NDArray[np.bool_]
    glitched: NDArray[np.bool_]
    unsure: NDArray[np.int32]


def uart_table(capture: Capture, channel: str | int, line: Line, glitch: int = 0, vote: bool = False) -> UartTable:
    """Decode frames, breaks and rejected starts of one channel. No event extends over unknown levels.

    glitch: pulses that are shorter than this number of positions are removed first.
    vote: True if each bit is the majority of three samples.

    Raise LookupError if the channel is missing or ambiguous, and ValueError if the capture has no rate, or fewer than
    two positions per bit.
    """
    wire = capture.channel(channel)
    width = width_of(capture, line.baud)
    spans = [(wire.cut(span).without_glitches(glitch), span.end) for span in capture.known(wire)]
    step = sample_point_step(sample_step(capture), width)
    none = _without_value(UartRowKind.BREAK, wire.edges[:0], wire.edges[:0])
    return joined([none, *(_table(part, line, width, end, step, vote) for part, end in spans)])


def _table(wire: Channel, line: Line, width: Fraction, end: int, step: int, vote: bool) -> UartTable:
    frames, rejected = frames_of(wire, line, width, end, step, vote)
    breaks = breaks_of(wire, line, width)
    if not len(breaks.at) and not len(rejected.at):
        return frames
    both = joined([frames, rejected, breaks])
    return select(both, np.argsort(both.at, kind="stable"))


def frames_of(
    wire: Channel, line: Line, width: Fraction, end: int, step: int, vote: bool
) -> tuple[UartTable, UartTable]:
    """Decode a line that is known up to the position `end`. Return a table of frames and a table of rejected starts.

    width: the length of a bit in positions.
    step: the length of a sample in positions.
    vote: True if each bit is the majority of three samples.
    """
    low = int(line.invert)  # level of the wire during a start bit
    edges = wire.edges
    first = int(wire.initial == low)  # index of the first edge that may start a frame
    starts = edges[first::2]
    looks = np.array(sample_points_of(line, width, step, vote), np.int64)  # the sample points, a row for each bit
    last = looks[:, -1]

    taken, rejected = _chain(starts, edges, first, looks, end)
    at = starts[taken]
    cut = len(at) > 0 and int(at[-1] + last[-1]) >= end
    seen = _majority([_seen(edges, first, taken, column) for column in looks.T])

    value = seen >> 1 & (1 << line.bits) - 1
    stop = seen >> len(looks) - 1 & 1
    frame_error = stop == 0
    parity_error = np.zeros(len(at), bool)
    if line.parity != "none":
        parity_error = (seen >> 1 + line.bits & 1) != _parity(line.parity, value)
    table = UartTable(
        np.zeros(len(at), np.uint8),
        at,
        at + round(line.frame * width),
        value,
        np.full(len(at), line.bits, np.uint8),
        parity_error,
        frame_error,
        *_glitches(edges, at, line, width),
    )
    if cut:
        bits = int(np.searchsorted(last[1:], end - int(at[-1])))
        bits = min(bits, line.bits)
        table.kind[-1] = UartRowKind.CUT
        table.end[-1] = end
        table.value[-1] &= (1 << bits) - 1
        table.bits[-1] = bits
        table.parity_error[-1] = table.frame_error[-1] = table.glitched[-1] = False
        table.unsure[-1] = 0
    return table, _without_value(UartRowKind.REJECTED, starts[rejected], edges[2 * rejected + first + 1])


def _seen(edges: Positions, first: int, taken: NDArray[np.int64], looks: Positions) -> NDArray[np.int32]:
    """Return for each frame a number whose bits are the levels at the sample points; 1 is the idle level.

    Each edge of a frame, including the start edge, inverts the levels at all sample points after it.

    first, taken: the start edge of frame n is the edge with the index 2 * taken[n] + first.
    looks: the sample points, as offsets from the start edge.
    """
    begin = 2 * taken + first
    if not len(begin):
        return np.empty(0, np.int32)
    after = np.append(begin[1:], len(edges))
    inside = edges[begin[0] :]
    passed = np.searchsorted(looks, inside - np.repeat(edges[begin], after - begin))
    turns = np.array([(1 << len(looks)) - (1 << n) for n in range(len(looks) + 1)], np.int32)
    levels: NDArray[np.int32] = turns[0] ^ np.bitwise_xor.reduceat(turns[passed], begin - begin[0])
    return levels


def _majority(seen: list[NDArray[np.int32]]) -> NDArray[np.int32]:
    if len(seen) == 1:
        return seen[0]
    a, b, c = seen
    return a & b | a & c | b & c


def _glitches(
    edges: Positions, at: Positions, line: Line, width: Fraction
) -> tuple[NDArray[np.bool_], NDArray[np.int32]]:
    """Return the columns `glitched` and `unsure` of a `UartTable` for the frames that begin at the positions `at`."""
    glitched, unsure = np.zeros(len(at), bool), np.zeros(len(at), np.int32)
    short = np.flatnonzero(np.diff(edges) <= ceil(width / 2) - 1) if len(at) else edges[:0]
    begins, ends = edges[short], edges[short + 1]
    windows = windows_of(line, width)
    frame = np.searchsorted(at, begins, side="right") - 1
    within = (frame >= 0) & (begins <= at[frame] + windows[-1][1]) if len(short) else np.zeros(0, bool)
    frame, begins, ends = frame[within], begins[within], ends[within]
    glitched[frame] = True
    for bit, (window, until) in enumerate(windows):
        touched = (begins - at[frame] <= until) & (ends - at[frame] > window)
        unsure[frame[touched]] |= 1 << bit
    return glitched, unsure


def _chain(
    starts: Positions, edges: Positions, first: int, looks: NDArray[np.int64], end: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the indices of the edges in `starts` that start a frame, and of the edges that are rejected starts.

    A candidate is an edge in `starts` at which a frame may begin; the first candidate is the first edge. A candidate is
    rejected if the start bit is high at most of its sample points. The next candidate is the first edge after the last
    sample point of the frame or, if the candidate is rejected, after the last sample point of the start bit.
    """
    passed = [np.searchsorted(edges, starts + look, side="right") for look in looks[0].tolist()]
    high = sum((done - first & 1 == 0).astype(np.int64) for done in passed)
    start, stop = starts + looks[0, -1], starts + looks[-1, -1]
    glitch = (2 * high > len(passed)) & (start < end)
    behind = np.searchsorted(starts, np.where(glitch, start, stop), side="right")
    behind[~glitch & (stop >= end)] = len(starts)  # the capture ends in this frame, so no frame follows
    hops: list[int] = behind.tolist()
    tried: list[int] = []
    n, count = 0, len(hops)
    while n < count:
        tried.append(n)
        n = hops[n]
    chosen = np.array(tried, np.int64)
    sound = ~glitch[chosen]
    return chosen[sound], chosen[~sound]


def breaks_of(wire: Channel, line: Line, width: Fraction) -> UartTable:
    """Return the breaks of a line. width: the length of a bit in positions."""
    falls, rises = low_pulses(wire, line.invert)
    long = rises - falls >= ceil(line.frame * width)
    return _without_value(UartRowKind.BREAK, falls[long], rises[long])


def low_pulses(wire: Channel, invert: bool) -> tuple[Positions, Positions]:
    """Return the positions at which the whole pulses with the level of a start bit begin, and where they end."""
    first = int(wire.initial == int(invert))
    rises = wire.edges[first + 1 :: 2]
    return wire.edges[first::2][: len(rises)], rises


def _without_value(kind: UartRowKind, at: Positions, ends: Positions) -> UartTable:
    count = len(at)
    no, nothing = np.zeros(count, bool), np.zeros(count, np.uint8)
    values, unsure = np.full(count, -1, np.int32), np.zeros(count, np.int32)
    of = np.full(count, kind, np.uint8)
    return UartTable(of, at, ends, values, nothing, no, no.copy(), no.copy(), unsure)


def _parity(kind: str, value: NDArray[np.int32]) -> NDArray[np.int32]:
    if kind in ("mark", "space"):
        return np.full(len(value), int(kind == "mark"), np.int32)
    odd = value.copy()
    for shift in (8, 4, 2, 1):
        odd ^= odd >> shift
    return (odd & 1) ^ np.int32(kind == "odd")


__all__ = ["PARITIES", "Event", "Line", "events"]


class Event(NamedTuple):
    """A row of `UartTable` as an object. The attributes have the meanings of the columns with the same names."""

    kind: UartRowKind
    at: int
    end: int
    value: int = -1
    bits: int = 0
    parity_error: bool = False
    frame_error: bool = False
    glitched: bool = False
    unsure: int = 0


def events(capture: Capture, channel: str | int, line: Line, vote: bool = False) -> list[Event]:
    """Decode the events of one channel, in the order of the rows of `UartTable`.

    vote: True if each bit is the majority of three samples.

    Raise LookupError if the channel is missing or ambiguous, and ValueError if the capture has no rate, or fewer than
    two positions per bit.
    """
    columns = (column.tolist() for column in uart_table(capture, channel, line, vote=vote))
    return [Event(UartRowKind(kind), *rest) for kind, *rest in zip(*columns, strict=True)]
