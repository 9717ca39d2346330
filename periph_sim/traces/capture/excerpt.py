"""Parts of a capture: some of its channels, or a window of time, which then begins at position 0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np

from ...core.shorten import shorten
from ...core.time import seconds
from .capture import MOST_DIGITS, BadCapture, Capture, Channel, Span


def with_channels(capture: Capture, names: Sequence[str]) -> Capture:
    """Return the named channels in the order given. Raise LookupError, with similar names, if one does not exist."""
    return replace(capture, channels=tuple(capture.channel(name) for name in names))


def within(capture: Capture, window: Span) -> Capture:
    """Return the part in the window, which begins at position 0. Raise BadCapture if it is outside the capture."""
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

    Times between two positions are rounded outwards. Raise ValueError if the text is invalid.
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
