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

from ..core.nearest import near
from ..formats.capture import Capture, Channel

PARITIES = ("none", "odd", "even", "mark", "space")


@dataclass(frozen=True, slots=True)
class Line:
    """How frames are made. invert: True where idle is low on the wire."""

    baud: Fraction | int
    bits: int = 8
    parity: str = "none"
    stop: Fraction | int = 1
    invert: bool = False

    def __post_init__(self) -> None:
        if self.baud <= 0:
            raise ValueError(f"baud is {self.baud}; expected more than 0")
        if not 1 <= self.bits <= 16:
            raise ValueError(f"{self.bits} data bits; expected 1 to 16")
        if self.parity not in PARITIES:
            raise ValueError(f"parity {self.parity!r}; {near(self.parity, PARITIES)}")
        if self.stop not in (1, Fraction(3, 2), 2):
            raise ValueError(f"{self.stop} stop bits; expected 1, 3/2 or 2")

    @property
    def frame(self) -> Fraction:
        """Bit times from the start edge to the end of the last stop bit."""
        return 1 + self.bits + (self.parity != "none") + Fraction(self.stop)


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
    if capture.rate is None:
        raise ValueError(f"{capture.path}: frames need a time base and the file states no rate; state the rate")
    width = capture.rate / Fraction(line.baud)
    if width < 2:
        raise ValueError(
            f"{capture.path}: {float(width):.2f} samples a bit at {line.baud} baud; expected at least 2, "
            f"so the rate of {capture.rate} Hz or the baud rate is wrong"
        )
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
    looks = [_look(bit, width) for bit in range(line.bits + 2 + checked)]
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


def _look(bit: int, width: Fraction) -> int:
    """Samples from the first low one to the look at a bit, the start bit being bit 0."""
    return ceil((bit + Fraction(1, 2)) * width - Fraction(1, 2))


def _parity(kind: str, value: int) -> int:
    if kind in ("mark", "space"):
        return int(kind == "mark")
    return value.bit_count() & 1 ^ int(kind == "odd")
