"""Check of a stated baud rate against the edges of a serial line.

    frames at the stated rate --> share of misread frames --+--> another rate, if its share is much smaller
    guess of the rate --> frames at the guessed rate -------+

A frame counts as misread if it has a framing or parity error, a glitch, or a falling edge far from the boundaries of
bits. Rising edges are not compared with these boundaries, because a slow driver delays all rising edges. Frames that
begin with a break do not count.

If the stated rate is a multiple of the true rate, many frames begin with a break; if it is a fraction of the true rate,
there are few frames. In both cases, few frames are left to count. The evidence against the stated rate is then that
most low pulses are too long or too short for it.

Noise, a wrong parity and a capture that begins within a frame cause misread frames, too. So a rate is doubted only if
another one explains the edges.
"""

from __future__ import annotations

import dataclasses
from fractions import Fraction

import numpy as np
from msgspec.structs import replace

from ...core.phrases import counted
from ..capture.capture import Capture, Channel, Span
from ..capture.sampling import sample_step
from .uart import UartRowKind, low_pulses, sample_point_step, uart_table, width_of
from .uart_guess import LOOKED_AT, guess
from .uart_line import Line

# A guessed rate that differs from the stated rate by at most TOLERANCE does not contradict the stated rate. A receiver
# of 8n1 samples the stop bit 9.5 bits after the start edge. With this difference of rates, it samples the stop bit half
# a bit too early or too late.
TOLERANCE = Fraction(1, 20)
# Misread frames are evidence against the stated rate under these conditions:
FEWEST = 3  # minimum number of misread frames at the stated rate, and minimum number of frames at the other rate
MISREAD = 0.15  # minimum share of misread frames among the frames at the stated rate
BETTER = 0.25  # maximum share of misread frames at the other rate, relative to the share at the stated rate
# A frame is misread if a falling edge is more than OFF_GRID bits plus half a sample from the nearest bit boundary.
OFF_GRID = 0.3
FARTHEST = 0.45  # upper limit, in bits, of OFF_GRID plus half a sample; it matters if there are few samples per bit
LIKELY = 0.3  # minimum certainty of the guessed rate (`Guess.sure`)
# If the stated rate is four times the true rate, nearly all low pulses are longer than LONGER bits. This can also occur
# if the stated rate is right. But then a low pulse of a frame has at most ten bits, and at a quarter of the stated
# rate, only pulses of four and eight bits would still have whole numbers of bits. So if the pulses have more than two
# lengths at the guessed lower rate, the stated rate is wrong. If the stated rate is a fraction of the true rate, most
# low pulses are shorter than SHORTER bits, and one frame at the stated rate contains many of them.
LONGER, SHORTER = 3.5, 0.5
# The rate is doubtful if at most the share NEARLY_NONE of the low pulses is shorter than LONGER bits, or at least the
# share MOST is shorter than SHORTER bits.
NEARLY_NONE, MOST = 0.05, 0.5
PULSES, LENGTHS = 12, 3  # minimum number of low pulses; minimum number of their different lengths at the other rate


def rate_doubt(capture: Capture, channel: str | int, line: Line, glitch: int = 0) -> tuple[str, Line] | None:
    """Return the evidence against the baud rate of `line`, and the format that fits the edges; None without evidence.

    Only the beginning of a long capture is checked.

    glitch: pulses that are shorter than this number of positions are removed first.

    Raise LookupError if the channel is missing or ambiguous, and ValueError if the capture has no rate, or fewer than
    two positions per bit.
    """
    capture, index = _beginning(capture, capture.channel(channel))
    wrong, frames = misread_frames(capture, index, line, glitch)
    pulses = [low_pulses(part, line.invert) for part in _parts(capture, index, glitch)]
    positions = [ends - begins for begins, ends in pulses]
    lows = np.concatenate([np.empty(0, np.int64), *positions]) / float(width_of(capture, line.baud))
    misread = wrong >= max(FEWEST, MISREAD * frames)
    longer = len(lows) >= PULSES and float(np.mean(lows < LONGER)) <= NEARLY_NONE
    shorter = len(lows) >= PULSES and float(np.mean(lows < SHORTER)) >= MOST
    if not misread and not longer and not shorter:
        return None
    try:
        guessed = guess(capture, index, None, line.invert, glitch)
        width_of(capture, guessed.line.baud)
    except ValueError:
        return None
    ratio = Fraction(guessed.line.baud) / Fraction(line.baud)
    if guessed.sure < LIKELY or abs(ratio - 1) <= TOLERANCE:
        return None
    lengths = np.unique(np.rint(lows * float(ratio)))
    fits = (longer and LONGER * ratio <= 1) or (shorter and SHORTER * ratio >= 1)
    usual = [f"{float(f'{length:.2g}'):g}" for length in np.quantile(lows, (0.1, 0.9))] if fits else []
    stated = f"{float(line.baud):.7g} baud, {line.shape}"
    for other in (replace(line, baud=guessed.line.baud), guessed.line):
        left, count = misread_frames(capture, index, other, glitch)
        if misread and count >= FEWEST and left * frames <= BETTER * wrong * count:
            return f"{wrong} of {counted(frames, 'frame')} have errors or edges between bits at {stated}", other
        if fits and len(lengths) >= LENGTHS and count >= FEWEST and left <= NEARLY_NONE * count:
            return f"most low pulses are {usual[0]} to {usual[1]} bits long at {stated}", other
    return None


def misread_frames(capture: Capture, channel: int, line: Line, glitch: int = 0) -> tuple[int, int]:
    """Return the number of misread frames, and the number of all frames, of a channel that is decoded as `line`.

    A frame is misread if it has a framing or parity error, a glitch, or a falling edge far from the boundaries of bits.
    Neither number includes frames that begin with a break.

    glitch: pulses that are shorter than this number of positions are removed first.
    """
    table = uart_table(capture, channel, line, glitch)
    breaks = table.at[table.kind == UartRowKind.BREAK]
    is_frame = (table.kind == UartRowKind.FRAME) & ~np.isin(table.at, breaks)
    at = table.at[is_frame]
    if not len(at):
        return 0, 0
    wrong = (table.frame_error | table.parity_error | table.glitched)[is_frame]
    width = float(width_of(capture, line.baud))
    parts = _parts(capture, channel, glitch)
    falls = np.concatenate([part.edges[part.levels == int(line.invert)] for part in parts])
    falls = falls[falls >= at[0]]
    frame = np.searchsorted(at, falls, side="right") - 1
    bits = (falls - at[frame]) / width
    step = sample_point_step(sample_step(capture), width)
    off = np.abs(bits - np.rint(bits)) > min(FARTHEST, OFF_GRID + step / width / 2)
    wrong[frame[off & (bits < float(line.frame - Fraction(line.stop)))]] = True
    return int(np.count_nonzero(wrong)), len(at)


def _beginning(capture: Capture, wire: Channel) -> tuple[Capture, int]:
    """Return a capture of this line alone up to its edge number LOOKED_AT, and the index of the line."""
    length = int(wire.edges[LOOKED_AT]) if len(wire.edges) > LOOKED_AT else capture.length
    unknown = tuple(Span(begin, min(end, length)) for begin, end in wire.unknown if begin < length)
    wire = dataclasses.replace(wire, edges=wire.edges[:LOOKED_AT], unknown=unknown)
    return dataclasses.replace(capture, length=length, channels=(wire,)), wire.index


def _parts(capture: Capture, channel: int, glitch: int) -> list[Channel]:
    """Return the line in each known span, without pulses that are shorter than `glitch` positions."""
    wire = capture.channel(channel)
    return [wire.cut(span).without_glitches(glitch) for span in capture.known(wire)]
