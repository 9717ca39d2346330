"""Asynchronous serial frames from edges: one line in, frames and breaks out.

An oracle: it shares no code with the SCI model.

           ___     ___ ___ ___ ... ___ ___
    idle      \\___/___X___X___X ...___/        start bit, data (least significant first), parity, stop
            |   '   '   '   '        '
            at  mid-bit: where each bit is looked at

Rules: a falling edge starts a frame. Each bit is looked at once, in its middle (the first sample not before
it, the bits counted from half a sample before the first low one, since the edge lies between two samples). A
start bit that is high there was a glitch. Only the first stop bit is checked, and the next falling edge after
that look starts the next frame. A low phase of at least a whole frame is a break, besides the frame it makes.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

import numpy as np

from ..formats.capture import Capture, Channel
from .uart_line import PARITIES, Line, look, width_of

__all__ = ["PARITIES", "Break", "CutFrame", "Event", "Frame", "Line", "events"]


@dataclass(frozen=True, slots=True)
class Frame:
    """at: the start edge. end: where its last stop bit is over. value: the first data bit is the least significant."""

    at: int
    end: int
    value: int
    parity_error: bool
    frame_error: bool


@dataclass(frozen=True, slots=True)
class Break:
    """The line was low from `at` to `end`, a whole frame or longer."""

    at: int
    end: int


@dataclass(frozen=True, slots=True)
class CutFrame:
    """The capture, or its known part, ends within a frame. bits: data bits seen until then, least significant first."""

    at: int
    bits: tuple[int, ...]


Event = Frame | Break | CutFrame


def events(capture: Capture, channel: str | int, line: Line) -> list[Event]:
    """Frames and breaks of one channel, in order of where they begin, a frame before the break it is part of.

    LookupError if the channel is not there; ValueError if the capture has no rate, or under two samples a bit.
    """
    wire = capture.channel(channel)
    width = width_of(capture, line.baud)
    found: list[Event] = []
    for span in capture.known(wire):
        found.extend(_frames(wire.cut(span), line, width, span.end))
        found.extend(_breaks(wire.cut(span), line, width))
    return sorted(found, key=lambda event: (event.at, isinstance(event, Break)))


def _frames(wire: Channel, line: Line, width: Fraction, end: int) -> list[Event]:
    low = int(line.invert)  # what the wire is at during a start bit
    edges: list[int] = wire.edges.tolist()
    starts: list[int] = wire.edges[wire.levels == low].tolist()
    first = wire.initial ^ low
    checked = line.parity != "none"
    looks = [look(bit, width) for bit in range(line.bits + 2 + checked)]
    length = round(line.frame * width)
    found: list[Event] = []
    n = 0
    while n < len(starts):
        at = starts[n]
        seen = [first ^ bisect_right(edges, at + look) & 1 for look in looks if at + look < end]
        if seen and seen[0]:  # high in the middle of the start bit: a glitch
            n = bisect_left(starts, at + looks[0] + 1)
            continue
        data = seen[1 : 1 + line.bits]
        if len(seen) < len(looks):
            found.append(CutFrame(at, tuple(data)))
            break
        value = sum(bit << place for place, bit in enumerate(data))
        wrong = checked and seen[-2] != _parity(line.parity, value)
        found.append(Frame(at, at + length, value, wrong, not seen[-1]))
        n = bisect_left(starts, at + looks[-1] + 1)
    return found


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
