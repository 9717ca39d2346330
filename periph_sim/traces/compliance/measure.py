"""Measurement of every time of UM10204's Table 10, over the whole trace at once.

    Capture --known spans, spikes removed--> SCL rises and falls, SDA edges --> symbol -> Measured

             tHD;STA tLOW  tHIGH       tSU;STA tHD;STA                tSU;STO  tBUF
    SCL  -------|______|--------|_____|-----------|___ ... ________|-------------------
    SDA  ---|______________/-------------\\________________________________/--------\\___
           START   | tSU;DAT         repeated START                       STOP     START
                |--| tHD;DAT (first change), tVD;DAT (last change before the rise)

Rules:
- A change of SDA while SCL is high is a condition: START (falling) or STOP (rising). A START that follows another START
  without a STOP between them is a repeated START. If both lines change at one position, the change of SDA is data: its
  hold time is 0 if SCL falls, and its setup time is 0 if SCL rises.
- A bit is a high phase of SCL that contains no condition. The ninth bit of each byte is its ACK. Only bits are measured
  as tHIGH or as part of a period. tSU;STA and tSU;STO are measured from a rise of SCL to the first condition after this
  rise.
- tHD;DAT, tSU;DAT, tVD;DAT and tVD;ACK are measured between START and STOP. tVD;DAT and tVD;ACK are measured, and the
  maximum of tHD;DAT is applied, only in low phases before a bit.
- The controller causes conditions and edges of SCL. The protocol determines the driver of each bit: after R/W = 1, the
  target drives the data bytes and the controller their ACKs; all other bytes are driven by the controller and their
  ACKs by the target. A falling edge of SDA is caused by the driver of the next bit. A rising edge is caused by the
  driver of the previous bit, which releases SDA. The controller causes the fall of SDA before a STOP.
- No time is measured across a span in which the level of a line is unknown.
- Spikes are removed first, as by the filter of an I2C input: a level that is no longer than the longest spike is
  removed, and the other edges keep their positions. If an edge rings, its last change counts. The text `SPIKE` in
  `limits` states which pulses are spikes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..capture.capture import Capture, Channel, Positions, Span
from ..decode.i2c import Party
from ..decode.i2c_stream import BITS
from ..decode.i2c_table import I2cEdges, edges_of
from .limits import LIMIT, SPIKES_TO, Mode, Resolution


def without_spikes(
    scl: Channel, sda: Channel, mode: Mode, resolution: Resolution
) -> tuple[Channel, Channel, Positions, Positions]:
    """Return SCL and SDA without spikes, and the positions and lengths of the spikes.

    Only pulses that are certainly spikes at this resolution are removed. In Standard-mode nothing is removed, because
    this mode has no spike filter.
    """
    most = LIMIT["tSP"].bounds[mode].most
    none = np.zeros(0, np.int64)
    if most is None:
        return scl, sda, none, none
    short, long = resolution.surely_at_most(most), resolution.surely_at_most(SPIKES_TO * most)
    clock, clock_begins, clock_lengths = _filtered(scl, _lengths(scl) <= long)
    lengths = _lengths(sda)
    ends = sda.edges + lengths
    falls = np.append(clock.edges[clock.levels == 0], np.iinfo(np.int64).max)
    next_fall = falls[np.searchsorted(falls, sda.edges)]
    high = (clock.before(sda.edges) == 1) & (clock.at(sda.edges) == 1) & (ends < next_fall)
    data, data_begins, data_lengths = _filtered(sda, (lengths <= short) | high & (lengths <= long))
    begins = np.concatenate((clock_begins, data_begins))
    order = np.argsort(begins, kind="stable")
    return clock, data, begins[order], np.concatenate((clock_lengths, data_lengths))[order]


def _lengths(channel: Channel) -> Positions:
    """Return how many positions the level after each edge lasts. For the last level, this is a huge number."""
    return np.append(np.diff(channel.edges), np.iinfo(np.int64).max // 2)[: len(channel.edges)]


def _filtered(channel: Channel, short: NDArray[np.bool_]) -> tuple[Channel, Positions, Positions]:
    """Return the channel without the levels that are marked in `short`, and the positions and lengths of these levels.

    short: for each edge, True if the level that begins with this edge is removed.
    """
    return channel.without_levels(short), channel.edges[short], _lengths(channel)[short]


Scalar = TypeVar("Scalar", bound=np.generic)
Flags = NDArray[np.bool_]
Parties = NDArray[np.uint8]

NOBODY, CONTROLLER, TARGET = 0, 1, 2
PARTY: dict[int, Party | None] = {NOBODY: None, CONTROLLER: Party.CONTROLLER, TARGET: Party.TARGET}


class Measured(NamedTuple):
    """All measured times of one limit, as arrays of equal length.

    begins: the positions at which the times begin.
    lengths: the lengths of the times, in positions.
    party: for each time, the party that caused it, as a key of PARTY.
    excused: True for a time to which the maximum of the limit does not apply.
    doubtful: True for a time to which the limit may not apply: the resolution does not show whether the pulse is a
        spike, the low phase is stretched, or the change of SDA is a condition. If a doubtful time is beyond the limit,
        it is not certainly wrong.
    """

    begins: Positions
    lengths: Positions
    party: Parties
    excused: Flags
    doubtful: Flags


def measured(
    begins: Positions,
    ends: Positions,
    party: Parties | int = CONTROLLER,
    excused: Flags | None = None,
    doubtful: Flags | None = None,
) -> Measured:
    """Return the times from `begins` to `ends`.

    By default, the controller causes all times, and no time is marked as excused or doubtful (see `Measured`).
    """
    nothing = np.zeros(len(begins), np.bool_)
    who = np.full(len(begins), party, np.uint8) if isinstance(party, int) else party
    return Measured(
        begins,
        ends - begins,
        who,
        nothing if excused is None else excused,
        nothing if doubtful is None else doubtful,
    )


@dataclass(frozen=True)
class Measures:
    """The measured times of a capture.

    times: for the symbol of each limit that a capture can show, the measured times.
    starts: the number of STARTs and repeated STARTs.
    shared: the positions at which both lines change. The order of the two edges at such a position is unknown.
    coarse: True if the mode allows high or low phases of SCL that are shorter than a sample.
    blind: True if `coarse` is True and a level of SCL lasts only one sample. Shorter levels were possibly missed.
    """

    times: dict[str, Measured]
    starts: int
    shared: Positions
    coarse: bool
    blind: bool


def measure(capture: Capture, scl: str | int, sda: str | int, mode: Mode, resolution: Resolution) -> Measures:
    """Measure all times of a capture.

    mode: determines which pulses are spikes, and which low phases are stretched.

    Raise LookupError if a channel is missing or ambiguous.
    """
    lines = capture.channel(scl), capture.channel(sda)
    spans = capture.known(*lines)
    clock, data = lines
    parts = [_Part(clock.cut(span), data.cut(span), span, mode, resolution) for span in spans]
    lows = [part.lows_before_bits() for part in parts]
    shortest = min((int(low.min()) for low in lows if len(low)), default=0)
    found = [part.measures(shortest) for part in parts]
    coarse = resolution.period > min(_least("tHIGH", mode), _least("tLOW", mode))
    times = {
        symbol: Measured._make(map(np.concatenate, zip(*(of[symbol] for of in found), strict=True)))
        for symbol in (found[0] if found else {})
    }
    return Measures(
        times,
        sum(len(part.starts) for part in parts),
        np.intersect1d(clock.edges, data.edges, assume_unique=True),
        coarse,
        coarse and any(part.shortest_phase <= resolution.slack for part in parts),
    )


class _Part:
    """SCL and SDA within one span in which both levels are known."""

    def __init__(self, scl: Channel, sda: Channel, span: Span, mode: Mode, resolution: Resolution) -> None:
        self._mode, self._resolution = mode, resolution
        scl, sda, self._spikes, self._spike_lengths = without_spikes(scl, sda, mode, resolution)
        edges = edges_of(scl, sda)
        self.rises, self.conditions, self.is_start = edges.rises, edges.conditions, edges.starts
        self.falls = scl.edges[scl.levels == 0]
        # The length of the shortest high or low phase of SCL, in positions.
        self.shortest_phase = np.diff(scl.edges).min(initial=np.iinfo(np.int64).max)
        self._edges, self._levels = sda.edges, sda.levels
        self.starts = self.conditions[self.is_start]
        # For each rise of SCL, the positions of the falls before and after it; -1 if the span has no such fall.
        self._low_from: Positions = _pick(self.falls, np.searchsorted(self.falls, self.rises) - 1)
        self._high_to: Positions = _pick(self.falls, np.searchsorted(self.falls, self.rises, side="right"))
        high_to = np.where(self._high_to < 0, span.end, self._high_to)
        self._condition_in = np.searchsorted(self.conditions, high_to) > np.searchsorted(self.conditions, self.rises)
        self._number_bits(edges)

    def _number_bits(self, edges: I2cEdges) -> None:
        """Number the pulses of SCL from each condition on, and determine which party should drive SDA in each pulse."""
        last = np.searchsorted(self.conditions, self.rises) - 1
        busy = (last >= 0) & _pick(self.is_start, last, False)
        first = edges.seen  # the index of the first pulse after each condition
        number = np.arange(len(self.rises)) - _pick(first, last, 0)
        self._busy = busy
        self._is_bit = busy & ~self._condition_in
        self._ack = busy & (number % BITS == BITS - 1)
        rw_bit = first + 7
        next_first = np.append(first[1:], len(self.rises))
        asked = np.zeros(len(first), np.bool_)
        whole = rw_bit < next_first
        asked[whole] = edges.values[rw_bit[whole]] == 1
        read = _pick(asked, last, False) & (number >= BITS)
        by_target = (read != self._ack) & self._is_bit  # in a pulse with START or STOP, the controller drives SDA
        self._driver = np.where(busy, np.where(by_target, TARGET, CONTROLLER), NOBODY).astype(np.uint8)
        before = np.concatenate((np.zeros(1, np.uint8), self._driver))[:-1]
        self._driver_before = np.where(busy & (number == 0), CONTROLLER, before).astype(np.uint8)

    def lows_before_bits(self) -> Positions:
        """Return the low time of SCL, in positions, before each pulse that transfers a bit.

        Pulses with a START or STOP, pulses outside a transfer, and low times that begin before the span are left out.
        """
        seen = self._is_bit & (self._low_from >= 0)
        return self.rises[seen] - self._low_from[seen]

    def measures(self, shortest_low: int) -> dict[str, Measured]:
        """Return a dictionary from the symbol of each limit that a capture can show to its measured times.

        shortest_low: the length of the shortest low phase before a bit in the whole capture, in positions.
        """
        return {
            **self._clock(),
            **self._start_stop(),
            **self._data(shortest_low),
            "tSP": measured(self._spikes, self._spikes + self._spike_lengths, NOBODY),
        }

    def _clock(self) -> dict[str, Measured]:
        low = self._low_from >= 0
        high = (self._high_to >= 0) & ~self._condition_in
        period = low & high
        short_low = self._may_be_spike(self.rises - self._low_from)
        short_high = self._may_be_spike(self._high_to - self.rises)
        either = (short_low | short_high)[period]
        return {
            "fSCL": measured(self._low_from[period], self._high_to[period], doubtful=either),
            "tLOW": measured(self._low_from[low], self.rises[low], doubtful=short_low[low]),
            "tHIGH": measured(self.rises[high], self._high_to[high], doubtful=short_high[high]),
        }

    def _start_stop(self) -> dict[str, Measured]:
        conditions, is_start = self.conditions, self.is_start
        after_start = np.concatenate((np.zeros(1, np.bool_), is_start))[:-1]
        before = np.concatenate((np.full(1, -1, np.int64), conditions))[:-1]
        rise = _pick(self.rises, np.searchsorted(self.rises, conditions) - 1)
        rise = np.where(rise > before, rise, -1)  # -1 if SCL did not rise since the previous condition
        fall = _pick(self.falls, np.searchsorted(self.falls, conditions))
        behind = np.append(conditions[1:], np.iinfo(np.int64).max)[: len(conditions)]
        held = is_start & (fall >= 0) & (fall < behind)
        again = is_start & after_start & (rise >= 0)
        stop = ~is_start & (rise >= 0)
        free = is_start & ~after_start & (before >= 0)
        return {
            "tHD;STA": measured(conditions[held], fall[held]),
            "tSU;STA": measured(rise[again], conditions[again]),
            "tSU;STO": measured(rise[stop], conditions[stop]),
            "tBUF": measured(before[free], conditions[free]),
        }

    def _data(self, shortest_low: int) -> dict[str, Measured]:
        if not len(self._edges):
            nothing = self._edges
            return {symbol: measured(nothing, nothing) for symbol in ("tHD;DAT", "tSU;DAT", "tVD;DAT", "tVD;ACK")}
        begin = np.where(self._low_from < 0, 0, self._low_from)
        first = np.searchsorted(self._edges, begin)
        last = np.searchsorted(self._edges, self.rises, side="right") - 1
        changed = (last >= first) & self._busy
        seen = changed & (self._low_from >= 0)
        bit = seen & self._is_bit
        stretched, maybe = self._stretched(shortest_low)
        excused = ~self._is_bit | stretched
        data, ack = bit & ~self._ack, bit & self._ack
        low_from, rises = self._low_from, self.rises
        first, last = np.minimum(first, len(self._edges) - 1), np.maximum(last, 0)
        hold_by, setup_by = self._by(first), self._by(last)
        valid = self._edges[last]
        # A change of SDA in the same sample as a rise of SCL is either data or a condition just after the rise.
        unsure = (valid == rises) & (self._resolution.slack > 0)
        return {
            "tHD;DAT": measured(low_from[seen], self._edges[first][seen], hold_by[seen], excused[seen], maybe[seen]),
            "tSU;DAT": measured(valid[changed], rises[changed], setup_by[changed], doubtful=unsure[changed]),
            "tVD;DAT": measured(low_from[data], valid[data], setup_by[data], excused[data], maybe[data]),
            "tVD;ACK": measured(low_from[ack], valid[ack], setup_by[ack], excused[ack], maybe[ack]),
        }

    def _by(self, edge: NDArray[np.intp]) -> Parties:
        """Return for each pulse the party that caused a given edge of SDA in the low phase before the pulse.

        edge: for each pulse, the index of the given edge.
        """
        return np.where(self._levels[edge] == 0, self._driver, self._driver_before).astype(np.uint8)

    def _stretched(self, shortest_low: int) -> tuple[Flags, Flags]:
        """Return a mask of pulses whose low phase is certainly stretched, and a mask of pulses that may be stretched.

        A low phase is not stretched if it is no longer than the minimum of tLOW, or no longer than 1.1 times the
        shortest low phase of the capture. It may be stretched if the answer depends on the error of measured lengths,
        which is up to `Resolution.slack` positions.

        shortest_low: the length of the shortest low phase before a bit in the whole capture, in positions.
        """
        least, slack = _least("tLOW", self._mode), self._resolution.slack
        lengths = self.rises - self._low_from
        own = 10 * (lengths + slack) <= 11 * (shortest_low - slack)
        own |= lengths <= self._resolution.surely_at_most(least)
        stretched = 10 * (lengths - slack) > 11 * (shortest_low + slack)
        stretched &= lengths >= self._resolution.surely_above(least)
        return stretched, ~own & ~stretched

    def _may_be_spike(self, lengths: Positions) -> Flags:
        most = LIMIT["tSP"].bounds[self._mode].most
        if most is None or not self._resolution.slack:
            return np.zeros(len(lengths), np.bool_)
        return lengths < self._resolution.surely_above(most)


def _least(symbol: str, mode: Mode) -> int:
    return LIMIT[symbol].bounds[mode].least or 0


def _pick(values: NDArray[Scalar], index: NDArray[np.intp], default: bool | int = -1) -> NDArray[Scalar]:
    """Return values[index], with `default` in place of values whose index is out of range."""
    padded = np.concatenate((values, np.array([default], values.dtype)))
    return padded[np.where((index < 0) | (index >= len(values)), len(values), index)]
