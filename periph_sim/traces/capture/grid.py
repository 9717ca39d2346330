"""Conversion of times to integer positions and back, exactly or with an error.

"0.000016460", ISO 8601 --> ticks (a power of ten per second) <--> samples of a known rate
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from fractions import Fraction
from pathlib import Path

import numpy as np

from ...core.shorten import shorten
from .capture import MOST_DIGITS, BadCapture, Capture, Positions
from .sampling import rate_text

# A text with more digits is not a time.
DECIMAL = re.compile(r"\s*([+-]?)(\d{1,40})(?:\.(\d{0,40}))?(?:[eE]([-+]?\d\d?))?\s*", re.ASCII)
ISO = re.compile(r"\s*(\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d)(?:\.(\d{1,40}))?(Z|[+-]\d\d:?\d\d)?\s*")

FINEST = 15  # maximum number of decimals with which seconds are written: femtoseconds
LEAST_DECIMALS = 9  # nanoseconds: Saleae's exports are exact with these if the sample period is whole nanoseconds


class OffGrid(ValueError):
    """A time lies between two samples of the given rate. It has an index in its sequence and an offset in ticks."""

    def __init__(self, which: int, off: Fraction) -> None:
        super().__init__(f"time {which} is {float(off):.3g} ticks off the grid")
        self.which = which


def exact_time(text: str) -> tuple[int, int]:
    """Parse a time exactly. Return (digits, decimals), which means digits / 10**decimals seconds.

    Raise ValueError if the text is neither a number nor a time of ISO 8601.
    """
    whole, _, part = text.partition(".")
    if part.isdecimal() and whole.isdecimal() and text.isascii() and len(text) <= MOST_DIGITS:
        return int(whole + part), len(part)  # the same as below, for most times
    if match := DECIMAL.fullmatch(text):
        part = match[3] or ""
        decimals = len(part) - int(match[4] or 0)
        return int(match[1] + match[2] + part) * 10 ** max(-decimals, 0), max(decimals, 0)
    if match := ISO.fullmatch(text):
        zone = "+00:00" if match[3] in (None, "Z") else match[3]
        since = datetime.fromisoformat(match[1] + zone) - datetime(1970, 1, 1, tzinfo=UTC)
        part = match[2] or ""
        return int(f"{since.days * 86400 + since.seconds}{part}"), len(part)
    raise ValueError(f"{shorten(repr(text.strip()))} is neither seconds nor an ISO 8601 time")


def decimals_for(capture: Capture, least: int, rounded_to: int, otherwise: str = "") -> tuple[int, bool]:
    """Return with how many decimals of a second times are written, from `least` to FINEST, and whether this is exact.

    This is the smallest number of decimals with which each sample is exact. If there is none, it is the smallest number
    with which a sample is at least `rounded_to` units of the last decimal. With it, a reader that knows the rate gets
    the same samples.

    otherwise: an addition to the expected rate in the message. Raise BadCapture if there is no rate or it is too high.
    """
    rate = capture.rate
    if rate is None:
        raise BadCapture(capture.path, "its rate", "none stated", "positions with a time", "state it with --rate")
    able = range(least, FINEST + 1)
    for decimals in able:
        if Fraction(10**decimals) % rate == 0:
            return decimals, True
    for decimals in able:
        if 10**decimals >= rounded_to * rate:
            return decimals, False
    most = f"up to {10**FINEST // rounded_to // 10**9} GHz{otherwise}"
    raise BadCapture(capture.path, "its rate", rate_text(rate), most, "write .psr")


def nearest(times: Positions, ratio: Fraction) -> Positions:
    """Return the whole number nearest to each time multiplied by `ratio`, exactly.

    If the arithmetic does not fit 64 bits, the result is an array of objects, which are Python's integers.
    """
    top, bottom = ratio.numerator, ratio.denominator
    if len(times) and 2 * (int(abs(times).max()) * top + bottom) >= 1 << 63:
        times = times.astype(object)
    return (2 * times * top + bottom) // (2 * bottom)


def quantized(ticks: Positions, per_second: Fraction, rate: Fraction) -> Positions:
    """Return the nearest sample number of each time.

    If a sample period is a whole number of ticks, each time must be on a sample. Otherwise the writer may have rounded
    or truncated times by up to a tick. Raise OffGrid for a time that is further off, and OverflowError if a sample
    number exceeds 64 bits.
    """
    period = per_second / rate  # ticks per sample
    samples = nearest(ticks, 1 / period)
    off = ticks.astype(samples.dtype) * period.denominator - samples * period.numerator
    beyond = np.flatnonzero(abs(off) > (0 if period.denominator == 1 else period.denominator))
    if len(beyond):
        which = int(beyond[0])
        raise OffGrid(which, Fraction(int(off[which]), period.denominator))
    return samples.astype(np.int64)


def on_grid(
    path: Path, lines: Sequence[Positions], last: int, per_second: Fraction, rate: Fraction, said: str
) -> tuple[list[Positions], int]:
    """Return the sample numbers of the times of each line, and of the time `last`.

    Raise BadCapture if a time is not on a sample. said: a description of such a time for the message, with {} in place
    of the time.
    """
    moments = np.unique(np.concatenate([np.array([last], np.int64), *lines]))
    try:
        samples = quantized(moments, per_second, rate)
    except OffGrid as off:
        found, expected = said.format(moments[off.which]), f"times on the grid of {rate} Hz"
        raise BadCapture(path, "its times", found, expected, "state the right rate or none") from off
    return [samples[np.searchsorted(moments, at)] for at in lines], int(samples[-1])
