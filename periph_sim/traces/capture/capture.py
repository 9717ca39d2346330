"""A capture in memory: the edges of each channel. The readers of all file formats return a `Capture`.

    file --> formats.read(path) --> Capture --> decode

Positions are integers: numbers of samples if the file consists of samples, and ticks if the file states only times. An
edge is at the first position with the new level. A level can be unknown in a span (a gap between chunks, `x` in a VCD,
`X` in a CSV). Decoders treat the parts before and after such a span separately.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...core.input_error import InputError
from ...core.phrases import did_you_mean, one_line, shorten
from ...core.time import seconds

Positions = NDArray[np.int64]
Levels = NDArray[np.uint8]

MOST_DIGITS = 40  # maximum number of digits of a number in text; Python refuses to convert more than 4300
MOST_NAMED = 12  # maximum number of channels that a message names
MOST_LISTED = 3  # maximum number of spans that a note lists
MOST_POSITION = 1 << 62  # maximum position, which is stored in 64 bits
UNKNOWN = 2  # the state of a line whose level is unknown; the other states are 0 and 1
# Added to the remedy for a damaged file if --salvage was given and the format cannot be read in part.
NO_SALVAGE = ", since --salvage reads no part of a file of this format"
STATE_LETTERS = "01x"  # for each state, its letter in a waveform file
UNITS = {"": 1, "hz": 1, "khz": 10**3, "mhz": 10**6, "ghz": 10**9}
FASTEST = 10**15  # maximum rate that is accepted, in samples per second
RATE = re.compile(rf"\s*(\d{{1,{MOST_DIGITS}}}(?:\.\d{{0,{MOST_DIGITS}}})?(?:[eE]\+?\d\d?)?)\s*([A-Za-z]*)\s*")


class BadCapture(ValueError):
    """A capture cannot be read, converted or written.

    The message states the file, the place in it, what was found and expected, and a remedy (`way_out`).
    """

    def __init__(self, path: Path, place: str, found: str, expected: str, way_out: str) -> None:
        said = f"{shorten(place)}: found {shorten(found)}, expected {shorten(expected)}; {shorten(way_out)}"
        super().__init__(f"{path}, " + one_line(said))
        self.place = place
        self.found = found
        self.expected = expected
        self.way_out = way_out


class Span(NamedTuple):
    """Positions from `begin` up to, not including, `end`."""

    begin: int
    end: int


@dataclass(frozen=True, eq=False)
class Channel:
    """One line of a capture.

    initial: the level before the first edge.
    edges: the positions of the edges, strictly increasing, from 1 to `Capture.length` - 1. Each edge inverts the level.
    index: the number of the line in the file: its bit in a sample, its column, or the number of its export file.
    unknown: the spans in which the level is unknown, in order.
    """

    name: str
    index: int
    initial: int
    edges: Positions
    unknown: tuple[Span, ...] = ()

    @cached_property
    def levels(self) -> Levels:
        """The level after each edge."""
        levels = np.full(len(self.edges), self.initial, np.uint8)
        levels[::2] ^= 1
        return levels

    def at(self, positions: Positions) -> Levels:
        """Return the level at each position. At the position of an edge, this is the level after the edge."""
        done = np.searchsorted(self.edges, positions, side="right")
        return (self.initial ^ (done & 1)).astype(np.uint8)

    def before(self, positions: Positions) -> Levels:
        """Return the level just before each position."""
        return self.at(positions - 1)

    def without_glitches(self, shortest: int) -> Channel:
        """Return the line without high and low pulses of fewer than `shortest` positions. All levels must be known.

            shortest = 3     __-_______----____        __________----____
                             __--_-----___-____   -->  _____-----________

        Both edges of a short pulse are removed, from left to right. If the level after a series of short pulses differs
        from the level before this series, the last edge of the series remains. The levels before the first edge and
        after the last edge of the line are not pulses, so they are never removed.
        """
        if shortest <= 1 or len(self.edges) < 2:
            return self
        return self.without_levels(np.append(np.diff(self.edges) < shortest, False))

    def without_levels(self, short: NDArray[np.bool_]) -> Channel:
        """Return the line without some of its levels.

        short: for each edge, True if the level that begins with this edge is removed; False for the last edge.
        """
        if not short.any():
            return self
        # A group of edges has only removed levels between its edges, and kept levels before and after it.
        begins = np.flatnonzero(~np.append(False, short[:-1]))  # for each group, the index of its first edge
        ends = np.flatnonzero(~short)  # for each group, the index of its last edge; it remains if their number is odd
        return replace(self, edges=self.edges[ends[(ends - begins) & 1 == 0]])

    def cut(self, span: Span) -> Channel:
        """Return the line within a span. Positions are unchanged; `initial` is the level at the start of the span.

        The result has no spans with unknown levels, even if this channel has some.
        """
        first, last = np.searchsorted(self.edges, [span.begin + 1, span.end])
        initial = self.initial ^ (int(first) & 1)
        return Channel(self.name, self.index, initial, self.edges[first:last])


@dataclass(frozen=True, eq=False)
class Capture:
    """A recording of some lines.

    rate: the number of positions per second; None if neither the file nor the caller states a rate.
    sampled: True if positions are samples of the analyser; False if they are ticks of time stamps whose sampling grid
        is unknown (see `sampling`).
    notes: sentences that say how the reader treated irregularities of the file.
    exact: True if positions are exact instants, as in recordings of our own simulations.
    """

    path: Path
    rate: Fraction | None
    length: int
    channels: tuple[Channel, ...]
    sampled: bool = True
    notes: tuple[str, ...] = ()
    exact: bool = False

    def noted(self, *notes: str) -> Capture:
        """Return the capture with these notes added."""
        return replace(self, notes=(*self.notes, *notes))

    def rate_for(self, what: str) -> Fraction:
        """Return the number of positions per second. Raise InputError if the file does not state it.

        what: who needs the rate, as the beginning of the message, such as "frames need".
        """
        if self.rate is None:
            raise InputError(f"{self.path}: {what} a time base and the file states no rate; state the rate")
        return self.rate

    def channel(self, wanted: str | int) -> Channel:
        """Return the channel with this name or index. An index can also be given as a text of digits.

        The part of a name after its last dot is sufficient if it is unique. Names are tried before indices. Raise
        LookupError, with names of channels, if no channel or more than one channel matches.
        """
        if isinstance(wanted, str):
            found = [c for c in self.channels if c.name == wanted]
            found = found or [c for c in self.channels if c.name.rpartition(".")[2] == wanted]
            if not found and wanted.isdecimal() and len(wanted) <= MOST_DIGITS:
                found = [c for c in self.channels if c.index == int(wanted)]
        else:
            found = [c for c in self.channels if c.index == wanted]
        if len(found) == 1:
            return found[0]
        which = listed(found or self.channels)
        asked = shorten(repr(wanted))
        if found:
            raise LookupError(f"{self.path}: {asked} names {len(found)} channels: {which}")
        right = did_you_mean(wanted, [c.name for c in self.channels]) if isinstance(wanted, str) else f"it has {which}"
        raise LookupError(f"{self.path}: there is no channel {asked}; {right}")

    def known(self, *channels: Channel) -> list[Span]:
        """Return the spans, in order, in which the levels of all the given channels are known."""
        spans: list[Span] = []
        begin = 0
        for hole in sorted(hole for channel in channels for hole in channel.unknown):
            if hole.begin > begin:
                spans.append(Span(begin, hole.begin))
            begin = max(begin, hole.end)
        if begin < self.length:
            spans.append(Span(begin, self.length))
        return spans


def listed(channels: Sequence[Channel]) -> str:
    """Format channels as `SCL (index 0), SDA (index 1)`; at most MOST_NAMED of them are named."""
    names = [f"{shorten(channel.name, 60)} (index {channel.index})" for channel in channels[:MOST_NAMED]]
    return ", ".join(names if len(channels) <= MOST_NAMED else [*names, "..."])


def channel_of(name: str, index: int, at: Iterable[int], levels: Iterable[int | None], length: int) -> Channel:
    """Build a Channel from its levels, of which None is an unknown level.

    at: for each level, the position from which on the line has this level.

    The rules are those of `channel_of_states`.
    """
    states = [UNKNOWN if level is None else level for level in levels]
    return channel_of_states(name, index, np.fromiter(at, np.int64), np.array(states, np.uint8), length)


def rate_of(text: str) -> Fraction:
    """Parse a sample rate: `4 MHz`, `500 kHz`, `1.5MHz`, `12000000`. Raise ValueError if it is invalid or too high."""
    match = RATE.fullmatch(text)
    if not match or match[2].casefold() not in UNITS:
        asked = shorten(repr(text.strip()))
        raise ValueError(f"{asked} is no sample rate; expected a number with or without Hz, kHz, MHz or GHz")
    rate = Fraction(match[1]) * UNITS[match[2].casefold()]
    if rate > FASTEST:
        raise ValueError(f"{text.strip()!r} is no sample rate; expected at most 1000 THz, a sample each femtosecond")
    return rate


def channel_of_states(name: str, index: int, at: Positions, states: Levels, length: int) -> Channel:
    """Build a Channel from its states, which are 0, 1 or UNKNOWN.

    at: for each state, the position from which on the line has this state.

    Positions may repeat but never decrease. The last of several states at one position counts, and a state that equals
    the previous state is ignored. Before the first position, the level is unknown.

    A span in which the level is unknown has no edges: the level before the span is assumed throughout. For a span at
    the beginning, the level after the span is assumed, or 1 if the level is never known.
    """
    at, states = changes_only(at, states)
    known = states != UNKNOWN
    levels, places = states[known], at[known]
    initial = int(levels[0]) if len(levels) else 1
    edges = places[np.diff(levels, prepend=np.uint8(initial)) != 0]
    ends = np.append(at[1:], length)[: len(at)]
    holes = list(zip(at[~known].tolist(), ends[~known].tolist(), strict=True))
    begin = int(at[0]) if len(at) else length
    if begin and holes and holes[0][0] == begin:
        holes[0] = (0, holes[0][1])
    elif begin:
        holes.insert(0, (0, begin))
    return Channel(name, index, initial, edges, tuple(Span(*hole) for hole in holes))


def changes_only(at: Positions, values: NDArray[Any]) -> tuple[Positions, NDArray[Any]]:
    """Return positions and values without repetitions: positions increase, and successive values are different.

    at: positions, which may repeat but never decrease. The last of several values at one position counts.
    """
    last = np.append(at[1:] != at[:-1], True)[: len(at)]
    at, values = at[last], values[last]
    new = np.append(True, values[1:] != values[:-1])[: len(at)]
    return at[new], values[new]


def changes(capture: Capture) -> tuple[Positions, NDArray[np.int64], Levels]:
    """Return the changes of all channels as (at, which, states), sorted by position and channel.

    From position `at[i]` on, the channel `capture.channels[which[i]]` has the state `states[i]`: 0, 1 or UNKNOWN. The
    first `len(capture.channels)` entries are the states at position 0.
    """
    each = [_states(channel, capture.length) for channel in capture.channels]
    at = np.concatenate([np.empty(0, np.int64), *(positions for positions, _ in each)])
    states = np.concatenate([np.empty(0, np.uint8), *(values for _, values in each)])
    which = np.repeat(np.arange(len(each)), [len(positions) for positions, _ in each])
    order = np.lexsort((which, at))
    return at[order], which[order], states[order]


def _states(channel: Channel, length: int) -> tuple[Positions, Levels]:
    """Return the positions at which a channel's state changes, and the state from each position on.

    The first position is 0.
    """
    begins = np.array([span.begin for span in channel.unknown], np.int64)
    ends = np.array([span.end for span in channel.unknown if span.end < length], np.int64)
    at = np.unique(np.concatenate([np.zeros(1, np.int64), channel.edges, begins, ends]))
    states = channel.at(at)
    hole = np.searchsorted(begins, at, side="right") - 1
    spans = np.array([span.end for span in channel.unknown] or [0], np.int64)
    states[(hole >= 0) & (at < spans[hole])] = UNKNOWN
    return changes_only(at, states)


def gaps(capture: Capture, *channels: Channel) -> list[Span]:
    """Return the spans in which the level of any of the channels is unknown, in order. Adjacent spans are merged."""
    known = [Span(0, 0), *capture.known(*channels), Span(capture.length, capture.length)]
    between = (Span(before.end, behind.begin) for before, behind in pairwise(known))
    return [span for span in between if span.begin < span.end]


def gap_notes(capture: Capture, *channels: Channel) -> list[str]:
    """Return a list with a note on the spans in which any of the channels is unknown; empty if there are none."""
    found = gaps(capture, *channels)
    if not found:
        return []
    names = " and ".join(shorten(channel.name, 60) for channel in channels)
    if capture.rate is None:
        total = f"{sum(span.end - span.begin for span in found)} samples"
        places = [f"sample {span.begin} to sample {span.end}" for span in found[:MOST_LISTED]]
    else:
        total = _seconds(capture.rate, sum(span.end - span.begin for span in found))
        times = [tuple(_seconds(capture.rate, bound) for bound in span) for span in found[:MOST_LISTED]]
        places = [" to ".join(bounds) for bounds in times]
    if len(found) > MOST_LISTED:
        places.append(f"and {len(found) - MOST_LISTED} more")
    spans = "1 span was" if len(found) == 1 else f"{len(found)} spans were"
    return [f"{names}: {spans} not recorded, {total} in all, {', '.join(places)}; nothing is decoded across them"]


def _seconds(rate: Fraction, positions: int) -> str:
    return f"{float(positions / rate):.9f} s"


def with_channels(capture: Capture, names: Sequence[str]) -> Capture:
    """Return the capture with only the named channels, in this order.

    Raise LookupError, with similar names, if a name does not determine exactly one channel.
    """
    return replace(capture, channels=tuple(capture.channel(name) for name in names))


def within(capture: Capture, window: Span) -> Capture:
    """Return the part of the capture in a window. Positions are then counted from the start of the window.

    Raise BadCapture if the window is empty or not within the capture.
    """
    if not 0 <= window.begin < window.end <= capture.length:
        raise BadCapture(
            capture.path,
            "its window",
            f"positions {window.begin} to {window.end}",
            f"a stretch within 0 to {capture.length}",
            "state another window",
        )
    channels = tuple(_within(channel, window) for channel in capture.channels)
    return replace(capture, channels=channels, length=window.end - window.begin)


def _within(channel: Channel, window: Span) -> Channel:
    cut = channel.cut(window)
    holes = (Span(max(h.begin, window.begin), min(h.end, window.end)) for h in channel.unknown)
    unknown = tuple(Span(h.begin - window.begin, h.end - window.begin) for h in holes if h.begin < h.end)
    return replace(cut, edges=np.subtract(cut.edges, window.begin), unknown=unknown)


def window_of(text: str, rate: Fraction | None) -> Span:
    """Parse a window of times, `100 us..1.2 ms`, or of positions, `400..4800`.

    Times between two positions are rounded so that the window becomes longer. Raise ValueError if the text is invalid
    or the window is empty, and for times if there is no rate.
    """
    begin, dots, end = text.partition("..")
    if not dots:
        raise ValueError(f"{shorten(repr(text))} is no window; expected FROM..TO, as in '100 us..1.2 ms'")
    first, last = _position(begin, rate), _position(end, rate)
    if not first < last:
        raise ValueError(f"{shorten(repr(text))} ends before it begins")
    return Span(first.numerator // first.denominator, -(-last.numerator // last.denominator))


def _position(text: str, rate: Fraction | None) -> Fraction:
    text = text.strip()
    if text.isdecimal() and len(text) <= MOST_DIGITS:
        return Fraction(int(text))
    if rate is None:
        raise ValueError(f"{shorten(repr(text))} needs a rate; state one, or give positions without a unit")
    return seconds(text) * rate
