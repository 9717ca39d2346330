"""A capture in memory, as every format reader returns it: the edges, channel by channel.

    file --> formats.read(path) --> Capture --> decode

Positions are integers: sample numbers where the file counts samples, ticks where it
only gives times. An edge is at the first position with the new level. Unknown levels
(gaps between chunks, `x` in a VCD, `X` in a CSV) are spans that a decoder must not
cross.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...core.shorten import one_line, shorten
from ...core.suggest import did_you_mean

Positions = NDArray[np.int64]
Levels = NDArray[np.uint8]

MOST_DIGITS = 40  # of a number in text; Python refuses to read one of over 4300
MOST_NAMED = 12  # channels in a message
UNITS = {"": 1, "hz": 1, "khz": 10**3, "mhz": 10**6, "ghz": 10**9}
FASTEST = 10**15  # samples a second
RATE = re.compile(rf"\s*(\d{{1,{MOST_DIGITS}}}(?:\.\d{{0,{MOST_DIGITS}}})?(?:[eE]\+?\d\d?)?)\s*([A-Za-z]*)\s*")


class BadCapture(ValueError):
    """A file that cannot be read, in one sentence: file, place, found, expected, remedy."""

    def __init__(self, path: Path, place: str, found: str, expected: str, way_out: str) -> None:
        said = f"{shorten(place)}: found {shorten(found)}, expected {shorten(expected)}; {shorten(way_out)}"
        super().__init__(f"{path}, " + one_line(said))
        self.place = place
        self.found = found
        self.expected = expected
        self.way_out = way_out

    def with_path(self, path: Path) -> BadCapture:
        """Return the same error with another path."""
        return BadCapture(path, self.place, self.found, self.expected, self.way_out)


class Span(NamedTuple):
    """Positions from `begin` up to, not including, `end`."""

    begin: int
    end: int


@dataclass(frozen=True, eq=False)
class Channel:
    """One line. `edges` rise strictly, within 1 .. length - 1; `levels[i]` holds from `edges[i]` on.

    Neighbouring levels differ, so the level after edge i is `initial` inverted i + 1 times.
    `index` is the place in the file (bit of the sample, column, number of the export file).
    """

    name: str
    index: int
    initial: int
    edges: Positions
    levels: Levels
    unknown: tuple[Span, ...] = ()

    def at(self, positions: Positions) -> Levels:
        """Return the level at each position; an edge at a position is included."""
        done = np.searchsorted(self.edges, positions, side="right")
        return (self.initial ^ (done & 1)).astype(np.uint8)

    def before(self, positions: Positions) -> Levels:
        """Return the level just before each position."""
        done = np.searchsorted(self.edges, positions, side="left")
        return (self.initial ^ (done & 1)).astype(np.uint8)

    def cut(self, span: Span) -> Channel:
        """Return the line within a span, positions unchanged; `initial` is the level where the span begins."""
        first, last = np.searchsorted(self.edges, [span.begin + 1, span.end])
        initial = self.initial ^ (int(first) & 1)
        return Channel(self.name, self.index, initial, self.edges[first:last], self.levels[first:last])


@dataclass(frozen=True, eq=False)
class Capture:
    """rate: positions a second, None if neither the file nor the caller states it.

    sampled: True if one position is one sample of the analyser, False if positions are the
    ticks of time stamps, whose sampling grid is unknown (see `sampling`).
    notes: what the reader did about irregularities, a sentence each.
    exact: True if positions are the exact instants, as in our own simulations.
    """

    path: Path
    rate: Fraction | None
    length: int
    channels: tuple[Channel, ...]
    sampled: bool = True
    notes: tuple[str, ...] = ()
    exact: bool = False

    def noted(self, *notes: str) -> Capture:
        """Return the capture with more notes."""
        return replace(self, notes=(*self.notes, *notes))

    def channel(self, wanted: str | int) -> Channel:
        """Return the channel of a name (the part after the last dot is enough if unique), or an index, also as digits.

        LookupError names the nearest right names.
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
    """Return the channels as text, `SCL (index 0), SDA (index 1)`; at most MOST_NAMED of them."""
    names = [f"{shorten(channel.name, 60)} (index {channel.index})" for channel in channels[:MOST_NAMED]]
    return ", ".join(names if len(channels) <= MOST_NAMED else [*names, "..."])


def channel_of(name: str, index: int, at: Iterable[int], levels: Iterable[int | None], length: int) -> Channel:
    """Build a Channel from states in order of time: the line is at `levels[i]` from `at[i]` on, None for unknown.

    Of several states at one position the last counts; a state that changes nothing is dropped.
    An unknown stretch keeps the level before it (at the start, the level after it): no edge lies within it.
    """
    states = dict(zip(at, levels, strict=True))
    initial = next((level for level in states.values() if level is not None), 1)
    edges: list[int] = []
    holes: list[Span] = []
    now = initial
    unknown_since: int | None = None if 0 in states else 0
    for position, level in states.items():
        if level is None:
            unknown_since = position if unknown_since is None else unknown_since
            continue
        if unknown_since is not None:
            holes.append(Span(unknown_since, position))
            unknown_since = None
        if level != now:
            edges.append(position)
            now = level
    if unknown_since is not None:
        holes.append(Span(unknown_since, length))
    return channel_of_edges(name, index, initial, np.array(edges, np.int64), tuple(holes))


def channel_of_edges(name: str, index: int, initial: int, edges: Positions, unknown: tuple[Span, ...] = ()) -> Channel:
    """Build a Channel whose level is inverted at each of `edges`, which rise strictly from 1."""
    levels = np.full(len(edges), initial, np.uint8)
    levels[::2] ^= 1
    return Channel(name, index, initial, edges, levels, unknown)


def rate_of(text: str) -> Fraction:
    """Parse a sample rate: `4 MHz`, `500 kHz`, `1.5MHz`, `12000000`. ValueError says what was expected."""
    match = RATE.fullmatch(text)
    if not match or match[2].casefold() not in UNITS:
        asked = shorten(repr(text.strip()))
        raise ValueError(f"{asked} is no sample rate; expected a number with or without Hz, kHz, MHz or GHz")
    rate = Fraction(match[1]) * UNITS[match[2].casefold()]
    if rate > FASTEST:
        raise ValueError(f"{text.strip()!r} is no sample rate; expected at most 1000 THz, a sample each femtosecond")
    return rate
