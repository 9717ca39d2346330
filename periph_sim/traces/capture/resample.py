"""Resampling of a capture, as an analyser of another rate would have recorded it.

An edge goes to the first sample at or after it. A pulse between two samples is lost,
counted, and mentioned in the notes.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from .capture import BadCapture, Capture, Channel, Positions, Span, channel_of_edges

MOST_POSITION = 1 << 62


def resampled(capture: Capture, rate: Fraction) -> Capture:
    """Return the capture on samples of `rate` a second, with a note of lost pulses. BadCapture without a rate."""
    if capture.rate is None:
        raise BadCapture(
            capture.path, "its rate", "none stated", "positions with a time", "state the rate at which it was captured"
        )
    ratio = rate / capture.rate
    last = max((int(channel.edges[-1]) for channel in capture.channels if len(channel.edges)), default=0)
    length = max(_ceil(capture.length * ratio), _ceil(last * ratio) + 1)  # no edge is after the last sample
    if length > MOST_POSITION:
        raise BadCapture(capture.path, "its length", f"{length} samples", f"at most {MOST_POSITION}", "use less --rate")
    moved = [_moved(channel, ratio, length) for channel in capture.channels]
    notes = [
        f"channel {channel.name}: pulses that fall between two samples of {rate_text(rate)} are lost: {lost}"
        for channel, lost in moved
        if lost
    ]
    channels = tuple(channel for channel, _ in moved)
    return replace(capture, rate=rate, length=length, channels=channels, sampled=True, exact=False).noted(*notes)


def rate_text(rate: Fraction) -> str:
    """Format a rate exactly, in the largest unit that gives a whole number: `4 MHz`, `115200 Hz`, `1000000/3 Hz`."""
    for unit, size in (("GHz", 10**9), ("MHz", 10**6), ("kHz", 10**3)):
        if rate % size == 0:
            return f"{rate // size} {unit}"
    return f"{rate} Hz"


def _moved(channel: Channel, ratio: Fraction, length: int) -> tuple[Channel, int]:
    """Return (the channel on the new samples, pulses lost)."""
    at, changes = np.unique(_up(channel.edges, ratio), return_counts=True)
    lost = int((changes // 2).sum())
    spans = ((_ceil(hole.begin * ratio), min(_ceil(hole.end * ratio), length)) for hole in channel.unknown)
    unknown = tuple(Span(begin, end) for begin, end in spans if begin < end)
    edges = at[changes & 1 == 1]
    return channel_of_edges(channel.name, channel.index, channel.initial, edges, unknown), lost


def _up(positions: Positions, ratio: Fraction) -> Positions:
    """Return the first sample at or after each position, exactly."""
    top, bottom = ratio.numerator, ratio.denominator
    if not len(positions) or int(positions[-1]) * top + bottom < 1 << 63:
        return -(-positions * top // bottom)
    return np.array([-(-int(position) * top // bottom) for position in positions], np.int64)


def _ceil(value: Fraction) -> int:
    return -(-value.numerator // value.denominator)
