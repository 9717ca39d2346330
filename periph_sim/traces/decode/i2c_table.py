"""I2C decoder on arrays: from SCL and SDA to a table with a row for each event and a column for each property.

    edges --> clock rises with SDA's level | START and STOP --> phases --> bytes --> rows in order of time

The rules are stated in `decode.i2c`, which returns the same events as objects with the timing of each bit. `i2c_stream`
contains the rules as tables. All operations are on whole arrays, so a capture of a million edges takes some tens of
milliseconds.

10-bit addresses (UM10204, section 3.1.11): the byte after an acknowledged 11110xx with R/W = 0 is the lower part of the
address. The kind of its row is `ADDRESS_LOW`, and the value of this row is the whole address.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import IntEnum
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...core.phrases import counted
from ..capture.capture import Capture, Channel, Positions
from ..capture.sampling import rate_text, sample_step
from .i2c_stream import BITS, COUNTED, EVENTS, KINDS, START
from .table_columns import joined

Flags = NDArray[np.bool_]
Counts = NDArray[np.int64]

OF_EVENTS = np.array([EVENTS >> 3 * pair & KINDS for pair in range(16)], np.uint8)
OF_COUNTED = np.array(COUNTED, np.int64)
NEVER = np.iinfo(np.int64).max  # in place of a position: there is none


class I2cRowKind(IntEnum):
    """Kind of a row. CUT: a byte that is incomplete because of a START, a STOP, or the end of the known span."""

    START = 0
    REPEATED_START = 1
    ADDRESS = 2
    ADDRESS_LOW = 3
    DATA = 4
    ACK = 5
    NACK = 6
    STOP = 7
    CUT = 8


class I2cTable(NamedTuple):
    """Events in order of time: a tuple of columns, which are arrays of equal length.

    kind    uint8   an `I2cRowKind`
    at      int64   the edge of SDA for START and STOP, otherwise the rising SCL of the first bit (for ACK and NACK the
                    ninth bit)
    last    int64   the rising SCL of the last bit (for an address its R/W bit); equal to `at` for START and STOP
    end     int64   the falling SCL after the last bit; for ACK and NACK the START or STOP if it comes before this fall;
                    `last` if the known span ends before all of these; equal to `at` for START and STOP
    value   int16   the seven bits of ADDRESS, the ten bits of ADDRESS_LOW, the byte of DATA, or the bits of CUT, the
                    last bit least significant; -1 for other kinds
    bits    uint8   8 for a complete byte, 1 for ACK and NACK, fewer than 8 for CUT, 0 for START and STOP
    read    bool    True if the R/W bit says that the target sends in this phase; False for START, STOP and without R/W
    """

    kind: NDArray[np.uint8]
    at: Positions
    last: Positions
    end: Positions
    value: NDArray[np.int16]
    bits: NDArray[np.uint8]
    read: Flags


class I2cBits(NamedTuple):
    """All pulses of SCL in order of time: a tuple of columns, which are arrays of equal length.

    at      int64   the rising SCL
    value   uint8   the level of SDA at the rising SCL
    low     int64   length of the low phase before the rise, including stretching; -1 if the capture, or its known part,
                    begins within this phase
    high    int64   length of the high phase after the rise; -1 if the capture, or its known part, ends within it
    """

    at: Positions
    value: NDArray[np.uint8]
    low: Counts
    high: Counts


class I2cEdges(NamedTuple):
    """Bits and conditions in a span in which both lines are known. The arrays are in order of time.

    clock, data         SCL and SDA in the span
    rises       int64   the position of each rising SCL
    values      uint8   the level of SDA at each rise
    conditions  int64   the positions of edges of SDA that are START or STOP
    starts      bool    for each condition, True if it is a START
    seen        int64   for each condition, the number of rises before it
    """

    clock: Channel
    data: Channel
    rises: Positions
    values: NDArray[np.uint8]
    conditions: Positions
    starts: Flags
    seen: Counts


def i2c_table(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA", glitch: int = 0) -> I2cTable:
    """Decode all events of a capture, from the first START of each known span on.

    No event extends over unknown levels.

    glitch: pulses of SCL or SDA that are shorter than this number of positions are removed first.

    Raise LookupError if a channel is missing or ambiguous.
    """
    return joined([_empty(0), *(_table(edges) for edges in i2c_edges(capture, scl, sda, glitch))])


def i2c_bits(capture: Capture, scl: str | int = "SCL", sda: str | int = "SDA", glitch: int = 0) -> I2cBits:
    """Return all pulses of SCL, also before the first START. Arguments and errors are those of `i2c_table`."""
    none = (np.empty(0, np.int64), np.empty(0, np.uint8), np.empty(0, np.int64), np.empty(0, np.int64))
    return joined([I2cBits(*none), *(bits_of(edges) for edges in i2c_edges(capture, scl, sda, glitch))])


def bits_of(edges: I2cEdges) -> I2cBits:
    """Return all pulses of SCL in a span."""
    clock, rises = edges.clock, edges.rises
    falls = _edges(clock, 0)
    before = falls if clock.initial else np.concatenate(([-1], falls))
    behind = falls[1:] if clock.initial else falls
    low = rises - before[: len(rises)]
    if len(low) and not clock.initial:
        low[0] = -1
    high = np.full(len(rises), -1, np.int64)
    high[: len(behind)] = behind - rises[: len(behind)]
    return I2cBits(rises, edges.values, low, high)


def i2c_edges(capture: Capture, scl: str | int, sda: str | int, glitch: int = 0) -> Iterator[I2cEdges]:
    """Yield the edges of each span in which both lines are known.

    glitch: pulses of SCL or SDA that are shorter than this number of positions are removed first.
    """
    clock, data = capture.channel(scl), capture.channel(sda)
    for span in capture.known(clock, data):
        yield edges_of(clock.cut(span).without_glitches(glitch), data.cut(span).without_glitches(glitch))


def _edges(line: Channel, level: int) -> Positions:
    """Return the positions of the edges to a level, which are every second edge of the line."""
    return line.edges[int(line.initial == level) :: 2]


def edges_of(clock: Channel, data: Channel) -> I2cEdges:
    """Find START, STOP and bits in the edges of SCL and SDA. Both lines must be known throughout."""
    rises = _edges(clock, 1)

    # For each edge of SDA: its place among the edges of SCL, and the levels of both lines before and after it.
    edges = data.edges
    passed = np.searchsorted(clock.edges, edges)  # number of SCL's edges before each edge of SDA
    seen = (passed + 1 - clock.initial) >> 1  # number of rises of SCL before each edge of SDA
    high = ((passed & 1) != clock.initial).view(np.uint8)
    together = clock.edges[np.minimum(passed, len(clock.edges) - 1)] == edges if len(clock.edges) else np.False_
    before, after = high | (data.levels ^ 1) << 1, high ^ together | data.levels << 1
    events = OF_EVENTS[before << 2 | after]
    which = np.flatnonzero(events >= START)

    # The level of SDA at each rise of SCL follows from the parity of the number of SDA's edges up to this rise.
    values = np.bincount(seen, minlength=len(rises) + 1)[: len(rises)].astype(np.uint8)
    np.cumsum(values, out=values)  # only the parity of the sum is used, so the sum may overflow
    values &= 1
    values ^= np.uint8(data.initial)
    return I2cEdges(clock, data, rises, values, edges[which], events[which] == START, seen[which])


def _table(edges: I2cEdges) -> I2cTable:
    """Decode the events of a span from its first START on."""
    starts = edges.starts
    if not starts.any():
        return _empty(0)
    first = int(np.argmax(starts))
    edges = edges._replace(conditions=edges.conditions[first:], starts=starts[first:], seen=edges.seen[first:])
    return _rows(edges, _bytes(edges.seen, bit_counts(edges), edges.values))


def bit_counts(edges: I2cEdges) -> Counts:
    """Return for each START the number of bits between it and the next condition; 0 for each STOP."""
    counts = np.diff(edges.seen, append=len(edges.rises))
    partial = counts[:-1] % BITS
    counts[:-1] += OF_COUNTED[partial] - partial
    return np.where(edges.starts, counts, 0)


class _Bytes(NamedTuple):
    """The bytes of all phases, complete or cut, in order. The columns are arrays of equal length.

    phase: the index of the condition with which the phase of the byte begins.
    begin: the index of the first rise of SCL in the byte.
    kind, value, read: as in `I2cTable`.
    bits: the number of bits, without the ninth.
    acked: True if the byte has a ninth bit, whether it is an ACK or a NACK.
    """

    phase: Counts
    begin: Counts
    kind: NDArray[np.uint8]
    value: NDArray[np.int16]
    bits: Counts
    acked: Flags
    read: Flags


def _bytes(seen: Counts, count: Counts, values: NDArray[np.uint8]) -> _Bytes:
    """Divide the rises of SCL into bytes of nine bits.

    seen: for each condition, the index of the first rise after it.
    count: for each condition, the number of bits after it, up to the next condition.
    values: the level of SDA at each rise.
    """
    per = (count + 8) // 9
    phase = np.repeat(np.arange(len(per)), per)
    number = np.arange(len(phase)) - np.repeat(np.cumsum(per) - per, per)  # for each byte, its number within its phase
    begin = seen[phase] + 9 * number
    there = count[phase] - 9 * number
    bits, acked, whole = np.minimum(there, 8), there >= 9, there >= 8

    padded = np.append(values, np.zeros(8, np.uint8))
    # For each rise, a word with the values at this rise and at the next seven rises.
    eights = np.ndarray(len(values) + 1, np.uint64, padded, strides=(1,))
    value = np.packbits(eights[begin].view(np.uint8).reshape(-1, 8), axis=1)[:, 0].astype(np.int16)
    value >>= 8 - bits
    head = whole & (number == 0)
    reads = np.zeros(len(per), bool)
    reads[phase[head]] = value[head] & 1

    kind = np.where(whole, np.uint8(I2cRowKind.DATA), np.uint8(I2cRowKind.CUT))
    kind[head] = I2cRowKind.ADDRESS
    tens = np.flatnonzero(head & (value & 0xF9 == 0xF0) & acked)  # address bytes 11110xx, R/W = 0, then ACK or NACK
    tens = tens[np.append(kind, I2cRowKind.CUT)[tens + 1] == I2cRowKind.DATA]
    tens = tens[values[begin[tens] + 8] == 0]
    kind[tens + 1] = I2cRowKind.ADDRESS_LOW
    value[tens + 1] |= (value[tens] & 6) << 7
    value[head] >>= 1
    return _Bytes(phase, begin, kind, value, bits, acked, reads[phase])


def _rows(edges: I2cEdges, found: _Bytes) -> I2cTable:
    """Return the rows of conditions, bytes, ACKs and NACKs in order. The first condition is a START."""
    clock, _, rises, values, conditions, starts, _ = edges
    falls = _edges(clock, 0)[clock.initial :]  # the falls after the first rise
    again = np.concatenate(([False], starts[:-1]))  # True if the previous condition is a START
    shown = starts | again  # a STOP that follows another STOP has no row

    of_bytes = np.concatenate(([0], np.cumsum(1 + found.acked)))  # number of rows of bytes and ACKs before each byte
    of_conditions = np.cumsum(shown)
    at_byte = of_bytes[:-1] + of_conditions[found.phase]
    at_ack = at_byte[found.acked] + 1
    before = np.searchsorted(found.phase, np.arange(len(conditions)))
    at_condition = (of_bytes[before] + of_conditions - 1)[shown]

    last = found.begin + found.bits - 1
    ninth = found.begin[found.acked] + 8
    table = _empty(int(of_bytes[-1] + of_conditions[-1]))
    table.kind[at_condition] = np.where(
        starts, np.where(again, I2cRowKind.REPEATED_START, I2cRowKind.START), I2cRowKind.STOP
    )[shown]
    table.at[at_condition] = table.last[at_condition] = table.end[at_condition] = conditions[shown]
    table.kind[at_byte] = found.kind
    table.at[at_byte] = rises[found.begin]
    table.last[at_byte] = rises[last]
    table.end[at_byte] = _behind(falls, rises, last)
    table.value[at_byte] = found.value
    table.bits[at_byte] = found.bits
    table.read[at_byte] = found.read
    table.kind[at_ack] = values[ninth] + np.uint8(I2cRowKind.ACK)  # NACK is ACK + 1
    table.at[at_ack] = table.last[at_ack] = rises[ninth]
    # A START or STOP within the ninth pulse ends the ACK before SCL falls.
    ends = np.minimum(np.append(falls, NEVER)[ninth], np.append(conditions, NEVER)[found.phase[found.acked] + 1])
    table.end[at_ack] = np.where(ends == NEVER, rises[ninth], ends)
    table.bits[at_ack] = 1
    table.read[at_ack] = found.read[found.acked]
    return table


def _behind(falls: Positions, rises: Positions, which: Counts) -> Positions:
    """Return the fall of SCL after each of the rises `which`; the rise itself if the capture ends before the fall."""
    if len(falls) == len(rises):
        return falls[which]
    ends = rises[which]
    there = which < len(falls)
    ends[there] = falls[which[there]]
    return ends


def _empty(rows: int) -> I2cTable:
    return I2cTable(
        np.zeros(rows, np.uint8),
        np.zeros(rows, np.int64),
        np.zeros(rows, np.int64),
        np.zeros(rows, np.int64),
        np.full(rows, -1, np.int16),
        np.zeros(rows, np.uint8),
        np.zeros(rows, bool),
    )


LONG = Fraction(3, 2)  # a low phase is long if it exceeds this multiple of the median
SLOWEST, FASTEST = 100, 5_000_000  # possible rates of SCL in Hz; Ultra Fast-mode (UM10204) has up to 5 MHz
FEWEST = 9  # minimum number of rises of SCL (one byte) for a check of the rate


class LongLows(NamedTuple):
    """The long low phases of SCL.

    rises: every rising SCL of the capture.
    which: the indices of the rises that follow a long low phase.
    lengths: the lengths of these low phases in positions.
    """

    rises: Positions
    which: Positions
    lengths: Positions


def long_lows(capture: Capture, scl: Channel, sda: Channel, glitch: int = 0) -> LongLows:
    """Return the low phases of SCL that are much longer than the median of all low phases.

    A low phase is returned if it exceeds 1.5 times the median, and exceeds the median by more than two samples.

    glitch: pulses of SCL or SDA that are shorter than this number of positions are removed first.
    """
    bits = i2c_bits(capture, scl.index, sda.index, glitch)
    seen = bits.low[bits.low >= 0]
    usual = Fraction(float(np.median(seen))) if len(seen) else Fraction(0)
    limit = float(max(usual * LONG, usual + 2 * sample_step(capture)))
    which = np.flatnonzero(bits.low > limit)
    return LongLows(bits.at, which, bits.low[which])


def impossible_rate(capture: Capture, scl: str | int) -> str:
    """Return a message if the clock rate of SCL shows that the capture's rate is wrong; otherwise "".

    The message is also "" if SCL has too few edges, or if the capture has no rate.

    Raise LookupError if the channel is missing or ambiguous.
    """
    line = capture.channel(scl)
    rises = line.edges[line.levels == 1]
    if capture.rate is None or len(rises) < FEWEST:
        return ""
    clock = capture.rate / Fraction(float(np.median(np.diff(rises))))
    if SLOWEST <= clock <= FASTEST:
        return ""
    return (
        f"at {rate_text(capture.rate)}, as captured or stated, SCL would run at {float(clock):.3g} Hz; "
        f"expected {SLOWEST} Hz to {FASTEST // 10**6} MHz"
    )


def _whole_addresses(capture: Capture, scl: str | int, sda: str | int) -> tuple[int, int]:
    """Return the number of STARTs with a whole address byte and its ninth bit, and the number of all STARTs."""
    whole = starts = 0
    for edges in i2c_edges(capture, scl, sda):
        whole += int(np.count_nonzero(bit_counts(edges) >= BITS))
        starts += int(np.count_nonzero(edges.starts))
    return whole, starts


def swapped_lines(capture: Capture, scl: str | int, sda: str | int) -> str:
    """Return a message if SCL and SDA are swapped; otherwise "".

    On swapped lines, most pulses of SCL look like a START and a STOP, so few STARTs are followed by a whole address.

    Raise LookupError if a channel is missing or ambiguous.
    """
    whole, starts = _whole_addresses(capture, scl, sda)
    if 2 * whole > starts:
        return ""
    other, others = _whole_addresses(capture, sda, scl)
    if 2 * other <= others:
        return ""
    return (
        f"SCL and SDA are swapped: {whole} of {counted(starts, 'START')} on them have a whole address, "
        f"and {other} of {others} the other way round"
    )


def likely_cause(capture: Capture, scl: str | int, sda: str | int) -> str:
    """Return the likely reason why lines have no complete START and address: idle lines, or swapped ones.

    Raise LookupError if a channel is missing or ambiguous.
    """
    idle = [line.name for line in map(capture.channel, (scl, sda)) if not len(line.edges)]
    if len(idle) == 2:
        return "neither line changes in the capture"
    return f"{idle[0]!r} does not change in the capture" if idle else "the lines may be swapped"
