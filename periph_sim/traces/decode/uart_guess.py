"""Estimate of the baud rate, frame shape and polarity of a serial line from its edges, with a measure of certainty.

    low pulses --> the largest bit time of which all their lengths are multiples --> a usual baud rate near it
    frames decoded with each usual shape --> the first shape without errors that enough values support

The shape of a frame states data bits, parity and stop bits, as in 8n1. Low pulses consist of start and data bits, so
their lengths are whole numbers of bits. The lengths of high pulses are not, because they include silence.

A shape that decodes without errors is not necessarily right: a line of 7e1 also decodes as 8n1, and any parity is right
for half of all bytes. So a shape other than 8n1 needs at least six different byte values as evidence. With fewer
values, it is chosen only if neither 8n1 nor a shape with enough values fits.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil

import numpy as np
from numpy.typing import NDArray

from ...core.phrases import counted
from ..capture.capture import Capture, Channel, Span
from ..capture.sampling import sample_step
from .table_columns import select
from .uart import UartRowKind, breaks_of, frames_of, low_pulses, sample_point_step
from .uart_line import Line, line_of

Pulses = NDArray[np.int64]

# Usual baud rates.
USUAL = (
    *(50, 75, 110, 134, 150, 200, 300, 600, 1200, 1800, 2400, 4800, 7200, 9600, 14400, 19200, 28800, 31250, 38400),
    *(56000, 57600, 74880, 76800, 100_000, 115_200, 125_000, 153_600, 187_500, 230_400, 250_000, 312_500, 345_600),
    *(375_000, 460_800, 500_000, 576_000, 625_000, 750_000, 921_600, 1_000_000, 1_250_000, 1_500_000, 1_843_200),
    *(2_000_000, 2_500_000, 3_000_000, 3_500_000, 4_000_000, 6_000_000, 8_000_000, 12_000_000),
)
# A measured rate is rounded to a usual baud rate if the relative difference is at most NEAR.
# Transmitters can be off by 2.5 %, which receivers tolerate, and the measurement of a short capture by another 1 %.
NEAR = 0.035

# Shapes in order of preference. The first accepted shape that is 8n1, or that has enough values, is chosen. If there is
# none, the first accepted shape is chosen. CLEAN says which shapes are accepted.
SHAPES = ("5n1", "6n1", "7n1", "7e1", "7o1", "8n1", "8e1", "8o1", "9n1")
PLAIN = "8n1"
ENOUGH = 6  # number of different byte values that are enough evidence for a shape other than PLAIN (8n1)
CLEAN = 0.005  # a shape is accepted if its share of wrong frames is at most this much above the smallest share

MANY = 12  # minimum number of pulses from which a constant lengthening of all pulses can be estimated
LOOKED_AT = 20_000  # maximum number of edges of a known span that are decoded to try a shape
LONGEST = 10.5  # maximum length of a low pulse in bits, for a start bit and nine data bits; longer pulses are breaks


@dataclass(frozen=True)
class Guess:
    """The estimated settings of a line.

    line: the estimated settings. The baud rate is a usual baud rate if `measured` is near a usual baud rate.
    measured: the baud rate according to the edges.
    frames: the number of decoded frames.
    errors: the share of wrong frames among the decoded frames.
    also: other shapes that decode equally well, but are less likely or supported by fewer values.
    sure: a certainty from 0 to 1, which is no probability. The value is small if frames are few, if frames are wrong,
        if low pulses differ from whole numbers of bits, or if another shape fits, but has too few values for a
        decision.
    """

    line: Line
    measured: float
    frames: int
    errors: float
    also: tuple[str, ...]
    sure: float

    def __str__(self) -> str:
        inverted = ", inverted" if self.line.invert else ""
        also = f"; {' and '.join(self.also)} would fit, too" if self.also else ""
        return (
            f"guessed {self.line.baud} baud, {self.line.shape}{inverted} (edges say {self.measured:.0f} baud; "
            f"{self.errors:.1%} of {self.frames} frames have errors{also}; {self.sure:.0%} sure)"
        )


def guess(
    capture: Capture, channel: str | int, shape: str | None = None, invert: bool | None = None, glitch: int = 0
) -> Guess:
    """Return the settings with which a channel decodes best.

    shape: the shape of a frame, such as 8n1; None if it is unknown.
    invert: True if the line idles low, False if the line idles high; None if this is unknown.
    glitch: pulses that are shorter than this number of positions are removed first.

    Raise LookupError if the channel is missing or ambiguous, and ValueError if the capture has no rate, or too few
    edges for a guess, or if `shape` is invalid.
    """
    wire = capture.channel(channel)
    rate = capture.rate_for("a guess of the baud rate needs")
    spans, step = capture.known(wire), sample_step(capture)
    parts = [wire.cut(span).without_glitches(glitch) for span in spans]
    found = [
        tried
        for turned in ((False, True) if invert is None else (invert,))
        if (tried := _best(rate, step, parts, shape, turned))
    ]
    if not found:
        raise ValueError(
            f"{capture.path}: {wire.name} has {counted(len(wire.edges), 'edge')} and no pulse to guess a baud rate "
            "from; state it"
        )
    return max(found, key=lambda tried: (1 - tried.errors) ** 8 * _idle(parts, spans, tried.line.invert))


@dataclass(frozen=True)
class _Tried:
    """The result of decoding the line with a shape.

    frames: the number of frames.
    values: the number of different values of these frames.
    errors: the share of wrong frames.
    """

    line: Line
    frames: int
    values: int
    errors: float


def _best(rate: Fraction, step: int, parts: list[Channel], shape: str | None, invert: bool) -> Guess | None:
    """Return the best guess for one polarity; None if no pulse is at least two positions long.

    step: the length of a sample in positions.
    parts: the line in each known span.
    """
    lengths = [ends - begins for begins, ends in (low_pulses(part, invert) for part in parts)]
    pulses = np.concatenate([np.empty(0, np.int64), *lengths])
    found = _bit_time(pulses, step)
    if found is None:
        return None
    width, off = found
    measured = float(rate) / width
    usual = min(USUAL, key=lambda usual: abs(usual - measured) / usual)
    baud = usual if abs(usual - measured) <= NEAR * usual else round(measured)
    tried = [_try(rate, step, parts, line_of(str(baud), wanted, invert)) for wanted in ((shape,) if shape else SHAPES)]
    least = min(one.errors for one in tried)
    clean = [one for one in tried if one.errors <= least + CLEAN]
    supported = [one for one in clean if one.line.shape in (shape, PLAIN) or one.values >= ENOUGH]
    best = (supported or clean)[0]
    others = [one for one in clean if one is not best and not _only_longer(one.line, best.line)]
    also = tuple(one.line.shape for one in others)
    doubt = any(one.values < ENOUGH and one.line.shape != PLAIN for one in others)
    sure = max(0.0, 1 - 2 * best.errors) * max(0.0, 1 - 4 * off) * best.frames / (best.frames + 3)
    sure *= 0.5 if doubt else 1.0
    return Guess(best.line, measured, best.frames, best.errors, also, sure)


def _only_longer(line: Line, than: Line) -> bool:
    """Return True if `line` has more data bits than `than`, has no parity, and is not PLAIN.

    Such a line is not a better guess, because the silence after a frame also decodes as high data bits.
    """
    return line.parity == "none" and line.shape != PLAIN and line.bits > than.bits


def _bit_time(pulses: Pulses, step: int) -> tuple[float, float] | None:
    """Return the length of a bit in positions, and the average distance of the pulses from whole bits, in bits.

    Return None if no pulse is at least two positions long.

    The shortest frequent pulse can be one, two, three or four bits long; it is longer than one bit if each low bit in
    the capture has another low bit next to it. These four lengths are tried in this order. The result is the first one
    for which the average distance of the pulses from whole bits is small; if there is none, the one for which this
    distance is smallest.

    step: the length of a sample in positions.
    """
    pulses = np.sort(pulses[pulses >= 2])
    if not len(pulses):
        return None
    alike = np.searchsorted(pulses, 1.3 * pulses, side="right") - np.arange(len(pulses))
    common = pulses[alike >= max(1, len(pulses) // 25)]
    shortest = float(np.mean(pulses[(pulses >= common[0]) & (pulses <= 1.3 * common[0])]))
    fits = [_fit(pulses, shortest / bits) for bits in (1, 2, 3, 4) if shortest / bits >= 2]
    fits = fits or [_fit(pulses, shortest)]
    for width, off in fits:
        # The second term allows for true edges between two samples.
        if off <= 0.07 + 0.4 * sample_point_step(step, width) / width:
            return width, off
    return min(fits, key=lambda fit: fit[1])


def _fit(pulses: Pulses, width: float) -> tuple[float, float]:
    """Return the bit time near `width` that fits the pulses best, and the average distance of pulses from whole bits.

    The fit allows for a constant lengthening of all low pulses, which occurs if a line falls faster than it rises.
    """
    longer = 0.0
    # Short pulses are fitted first, because an error of the bit time adds up over the bits of a long pulse.
    for longest in (2.5, 5.5, LONGEST, LONGEST):
        some = pulses[pulses < longest * width]
        bits = np.maximum(np.rint((some - longer) / width), 1)
        if len(some) < MANY or len(np.unique(bits)) < 3:
            width, longer = float(np.sum(some * bits) / np.sum(bits * bits)) if len(some) else width, 0.0
        else:
            middle = float(np.mean(bits))
            width = float(np.sum((bits - middle) * some) / np.sum((bits - middle) ** 2))
            longer = float(np.mean(some)) - middle * width
            longer = min(max(longer, -width / 4), width / 4)
    some = pulses[pulses < LONGEST * width]
    if not len(some):
        return width, 0.5
    bits = (some - longer) / width
    return width, float(np.mean(np.abs(bits - np.maximum(np.rint(bits), 1))))


def _try(rate: Fraction, step: int, parts: list[Channel], line: Line) -> _Tried:
    """Decode with the settings `line` and count frames, values and errors.

    Frames that are cut off, and frames that begin with a break, do not count.
    """
    width = rate / Fraction(line.baud)
    sample = sample_point_step(step, width)
    frames = wrong = 0
    values: set[int] = set()
    for part in parts:
        edges = part.edges[: LOOKED_AT - 2 * frames]
        if not len(edges) or width < 2:
            continue
        some = replace(part, edges=edges)
        end = int(edges[-1]) + ceil(line.frame * width)
        table, _ = frames_of(some, line, width, end, sample, vote=False)
        table = select(table, table.kind == UartRowKind.FRAME)
        breaks = breaks_of(some, line, width).at
        table = select(table, ~np.isin(table.at, breaks, assume_unique=True))
        frames += len(table.at)
        wrong += int(np.count_nonzero(table.parity_error | table.frame_error))
        values.update(np.unique(table.value).tolist())
    return _Tried(line, frames, len(values), wrong / frames if frames else 1.0)


def _idle(parts: list[Channel], spans: list[Span], invert: bool) -> float:
    """Return the share of time for which the line is at its idle level. Most lines are idle longer than busy."""
    low = 0  # total time at the level of a start bit
    for part, span in zip(parts, spans, strict=True):
        bounds = np.concatenate(([span.begin], part.edges, [span.end]))
        low += int(np.diff(bounds)[part.initial ^ int(invert) :: 2].sum())
    return 1 - low / sum(span.end - span.begin for span in spans)
