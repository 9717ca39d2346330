"""Asynchronous serial frames from edges, all at once: one line in, a table of frames and breaks out.

    falling edges --> where the next frame would begin --> the chain of frames --> edges within each --> bits

The rules are those of `decode.uart`, which gives the same events one by one as objects. A frame decides where
the next may begin, so the chain is followed one by one, which is one look into a list a frame; all else is
done for all frames at once.
"""

from __future__ import annotations

from enum import IntEnum
from fractions import Fraction
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..formats.capture import Capture, Channel, Positions
from .glitch import without_glitches
from .uart_line import Line, look, width_of


class Kind(IntEnum):
    """What a row is. CUT: a frame that the end of the capture, or of its known part, left incomplete."""

    FRAME = 0
    BREAK = 1
    CUT = 2


class UartTable(NamedTuple):
    """Arrays of equal length, in order of where the rows begin, a frame before the break it is part of.

    The tuple is of columns.

    kind          uint8   a `Kind`
    at            int64   the start edge
    end           int64   FRAME: where its last stop bit is over; BREAK: the rising edge; CUT: where it was cut off
    value         int32   the data bits, the first one least significant; -1 of a break
    bits          uint8   data bits seen; 0 of a break
    parity_error  bool
    frame_error   bool    the stop bit was low
    """

    kind: NDArray[np.uint8]
    at: Positions
    end: Positions
    value: NDArray[np.int32]
    bits: NDArray[np.uint8]
    parity_error: NDArray[np.bool_]
    frame_error: NDArray[np.bool_]

    def take(self, rows: NDArray[np.int64] | NDArray[np.bool_] | slice) -> UartTable:
        """The table of some rows: their numbers, a mask, or a slice."""
        return UartTable._make(column[rows] for column in self)


def uart_table(capture: Capture, channel: str | int, line: Line, glitch: int = 0) -> UartTable:
    """Frames and breaks of one channel; nothing across unknown spans.

    glitch: pulses of fewer positions are left out first. LookupError if the channel is not there; ValueError if
    the capture has no rate, or under two samples a bit.
    """
    wire = capture.channel(channel)
    width = width_of(capture, line.baud)
    spans = [(without_glitches(wire.cut(span), glitch), span.end) for span in capture.known(wire)]
    return _joined([_table(part, line, width, end) for part, end in spans])


def _table(wire: Channel, line: Line, width: Fraction, end: int) -> UartTable:
    frames = frames_of(wire, line, width, end)
    breaks = breaks_of(wire, line, width)
    if not len(breaks.at):
        return frames
    both = _joined([frames, breaks])
    return both.take(np.argsort(both.at, kind="stable"))


def frames_of(wire: Channel, line: Line, width: Fraction, end: int) -> UartTable:
    """The frames of a line that is known up to `end`, each bit `width` positions long."""
    low = int(line.invert)  # what the wire is at during a start bit
    edges = wire.edges
    first = int(wire.initial == low)  # among the edges, the first that may start a frame
    starts = edges[first::2]
    checked = line.parity != "none"
    looks = np.array([look(bit, width) for bit in range(line.bits + 2 + checked)], np.int64)

    taken = _chain(starts, edges, first, looks, end)
    at = starts[taken]
    cut = len(at) > 0 and int(at[-1] + looks[-1]) >= end

    # Each edge of a frame turns over all looks from it on; edge 0 is the start bit's own.
    begin = 2 * taken + first
    after = np.append(begin[1:], len(edges))
    inside = edges[begin[0] :] if len(begin) else edges[:0]
    passed = np.searchsorted(looks, inside - np.repeat(at, after - begin))
    turns = np.array([(1 << len(looks)) - (1 << n) for n in range(len(looks) + 1)], np.int32)
    every = turns[0]
    seen = every ^ np.bitwise_xor.reduceat(turns[passed], begin - begin[0]) if len(begin) else turns[:0]

    value = seen >> 1 & (1 << line.bits) - 1
    stop = seen >> len(looks) - 1 & 1
    frame_error = stop == 0
    parity_error = np.zeros(len(at), bool)
    if checked:
        parity_error = (seen >> 1 + line.bits & 1) != _parity(line.parity, value)
    table = UartTable(
        np.zeros(len(at), np.uint8),
        at,
        at + round(line.frame * width),
        value,
        np.full(len(at), line.bits, np.uint8),
        parity_error,
        frame_error,
    )
    if cut:
        bits = int(np.searchsorted(looks[1:], end - int(at[-1])))
        bits = min(bits, line.bits)
        table.kind[-1] = Kind.CUT
        table.end[-1] = end
        table.value[-1] &= (1 << bits) - 1
        table.bits[-1] = bits
        table.parity_error[-1] = table.frame_error[-1] = False
    return table


def _chain(starts: Positions, edges: Positions, first: int, looks: Positions, end: int) -> NDArray[np.int64]:
    """Which of the edges that may start a frame do: the first, and each time the first behind the last look.

    An edge whose start bit is over by its middle starts nothing.
    """
    done = np.searchsorted(edges, starts + looks[0], side="right")
    glitch = (done - first & 1 == 0) & (starts + looks[0] < end)
    behind = np.searchsorted(starts, np.where(glitch, starts + looks[0], starts + looks[-1]), side="right")
    behind[~glitch & (starts + looks[-1] >= end)] = len(starts)  # cut off: nothing follows
    hops: list[int] = behind.tolist()
    taken: list[int] = []
    n, count = 0, len(hops)
    while n < count:
        taken.append(n)
        n = hops[n]
    chosen = np.array(taken, np.int64)
    sound: NDArray[np.int64] = chosen[~glitch[chosen]]
    return sound


def breaks_of(wire: Channel, line: Line, width: Fraction) -> UartTable:
    """The breaks of a line, each bit `width` positions long."""
    first = int(wire.initial == int(line.invert))
    falls, rises = wire.edges[first::2], wire.edges[first + 1 :: 2]
    falls = falls[: len(rises)]
    long = rises - falls >= ceil(line.frame * width)
    at, ends = falls[long], rises[long]
    none = np.zeros(len(at), bool)
    return UartTable(
        np.full(len(at), Kind.BREAK, np.uint8),
        at,
        ends,
        np.full(len(at), -1, np.int32),
        np.zeros(len(at), np.uint8),
        none,
        none.copy(),
    )


def _parity(kind: str, value: NDArray[np.int32]) -> NDArray[np.int32]:
    if kind in ("mark", "space"):
        return np.full(len(value), int(kind == "mark"), np.int32)
    odd = value.copy()
    for shift in (8, 4, 2, 1):
        odd ^= odd >> shift
    return (odd & 1) ^ np.int32(kind == "odd")


def _joined(tables: list[UartTable]) -> UartTable:
    if len(tables) == 1:
        return tables[0]
    kinds = (np.uint8, np.int64, np.int64, np.int32, np.uint8, np.bool_, np.bool_)
    none = (np.empty(0, kind) for kind in kinds)
    return UartTable._make(np.concatenate(columns) for columns in zip(none, *tables, strict=True))
