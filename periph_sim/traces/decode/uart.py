"""Decoder of asynchronous serial frames: from the edges of one line to frames and breaks.

An oracle: it shares no code with the SCI model.

           ___     ___ ___ ___ ... ___ ___
    idle      \\___/___X___X___X ...___/        start bit, data (least significant first), parity, stop
            |   '   '   '   '        '
            at  mid-bit: where each bit is sampled

Rules: a falling edge starts a frame. Each bit is sampled once, in its middle (the first sample not before
it, the bits counted from half a sample before the first low one, since the edge is between two samples), or
three times around it, and the majority counts. A start bit that is sampled high is a rejected start. Only the
first stop bit is checked, and the next falling edge after its sample starts the next frame. A low phase of at
least a whole frame is a break, in addition to its frame.

A pulse of less than half a bit is a glitch. If it is at a place at which receivers sample a bit, they may
read that bit either way, and the line does not show which.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import ceil

import numpy as np

from ..capture.capture import Capture, Channel
from ..capture.sampling import sample_step
from .uart_format import longest_glitch, sample_point_step, sample_points_of, width_of, windows_of
from .uart_line import PARITIES, Line

__all__ = ["PARITIES", "Break", "CutFrame", "Event", "Frame", "Line", "RejectedStart", "events"]


@dataclass(frozen=True, slots=True)
class Frame:
    """at: the start edge. end: the end of its last stop bit. value: the first data bit is the least significant.

    glitched: True with a glitch between the start edge and the end of the first stop bit. unsure: the bits that
    receivers may read differently because of a glitch, as a mask: bit 0 the start bit, then data, parity and the
    first stop bit.
    """

    at: int
    end: int
    value: int
    parity_error: bool
    frame_error: bool
    glitched: bool = False
    unsure: int = 0


@dataclass(frozen=True, slots=True)
class Break:
    """The line was low from `at` to `end`, a whole frame or longer."""

    at: int
    end: int


@dataclass(frozen=True, slots=True)
class CutFrame:
    """A frame cut by the end of the capture or of its known part. bits: data bits received, least significant first."""

    at: int
    bits: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class RejectedStart:
    """The line left idle at `at`, but not for a start bit; `end`: its first return."""

    at: int
    end: int


Event = Frame | Break | CutFrame | RejectedStart


def events(capture: Capture, channel: str | int, line: Line, vote: bool = False) -> list[Event]:
    """Decode the events of one channel, in the order of their begins, a frame before the break it is part of.

    vote: each bit is the majority of three samples. LookupError for a missing channel; ValueError if the capture has
    no rate, or under two samples a bit.
    """
    wire = capture.channel(channel)
    width = width_of(capture, line.baud)
    found: list[Event] = []
    for span in capture.known(wire):
        looks = sample_points_of(line, width, sample_point_step(sample_step(capture), width), vote)
        found.extend(_frames(wire.cut(span), line, width, span.end, looks))
        found.extend(_breaks(wire.cut(span), line, width))
    return sorted(found, key=lambda event: (event.at, isinstance(event, Break)))


def _frames(wire: Channel, line: Line, width: Fraction, end: int, looks: list[tuple[int, ...]]) -> list[Event]:
    low = int(line.invert)  # level of the wire during a start bit
    edges: list[int] = wire.edges.tolist()
    starts: list[int] = wire.edges[wire.levels == low].tolist()
    first = wire.initial ^ low
    glitches = [(a, b) for a, b in pairwise(edges) if b - a <= longest_glitch(width)]
    windows = windows_of(line, width)
    length = round(line.frame * width)
    found: list[Event] = []
    n = 0
    while n < len(starts):
        at = starts[n]
        levels = [[first ^ bisect_right(edges, at + look) & 1 for look in of] for of in looks if at + of[-1] < end]
        seen = [int(2 * sum(of) > len(of)) for of in levels]
        if seen and seen[0]:
            found.append(RejectedStart(at, edges[bisect_right(edges, at)]))
            n = bisect_left(starts, at + looks[0][-1] + 1)
            continue
        data = seen[1 : 1 + line.bits]
        if len(seen) < len(looks):
            found.append(CutFrame(at, tuple(data)))
            break
        value = sum(bit << place for place, bit in enumerate(data))
        wrong = line.parity != "none" and seen[-2] != _parity(line.parity, value)
        within = glitches[bisect_left(glitches, (at, 0)) : bisect_right(glitches, (at + windows[-1][1], end))]
        unsure = _unsure([(a - at, b - at) for a, b in within], windows)
        found.append(Frame(at, at + length, value, wrong, not seen[-1], bool(within), unsure))
        n = bisect_left(starts, at + looks[-1][-1] + 1)
    return found


def _unsure(glitches: list[tuple[int, int]], windows: list[tuple[int, int]]) -> int:
    """Return the bits whose window contains a glitch, as a mask."""
    return sum(
        1 << bit for bit, (begin, last) in enumerate(windows) if any(a <= last and b > begin for a, b in glitches)
    )


def _breaks(wire: Channel, line: Line, width: Fraction) -> list[Event]:
    falls = wire.edges[wire.levels == int(line.invert)]
    rises = wire.edges[wire.levels != int(line.invert)]
    rises = rises[np.searchsorted(rises, falls[0]) :] if len(falls) else rises[:0]
    falls = falls[: len(rises)]
    long = rises - falls >= ceil(line.frame * width)
    return [Break(at, end) for at, end in zip(falls[long].tolist(), rises[long].tolist(), strict=True)]


def _parity(kind: str, value: int) -> int:
    if kind in ("mark", "space"):
        return int(kind == "mark")
    return value.bit_count() & 1 ^ int(kind == "odd")
