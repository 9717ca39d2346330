"""Conversion of times in text to integer positions, exactly or with an error.

"0.000016460", ISO 8601 --> ticks (a power of ten a second) --> samples of a known rate
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from fractions import Fraction

from ...core.shorten import shorten

DECIMAL = re.compile(r"\s*([+-]?)(\d{1,40})(?:\.(\d{0,40}))?\s*")  # more digits are no time
ISO = re.compile(r"\s*(\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d)(?:\.(\d{1,40}))?(Z|[+-]\d\d:?\d\d)?\s*")

LEAST_DECIMALS = 9  # nanoseconds, to which Saleae's exports are exact at whole-nanosecond sample periods


class OffGrid(ValueError):
    """A time that is on no sample of the given rate: its index in the sequence, and the offset in ticks."""

    def __init__(self, which: int, off: Fraction) -> None:
        super().__init__(f"time {which} is {float(off):.3g} ticks off the grid")
        self.which = which


def exact_time(text: str) -> tuple[int, int]:
    """Return (digits, decimals): digits / 10**decimals seconds, exactly. ValueError if not a number or ISO 8601."""
    if match := DECIMAL.fullmatch(text):
        sign, whole, part = match[1], match[2], match[3] or ""
        digits = int(whole + part)
        return (-digits if sign == "-" else digits), len(part)
    if match := ISO.fullmatch(text):
        zone = "+00:00" if match[3] in (None, "Z") else match[3]
        since = datetime.fromisoformat(match[1] + zone) - datetime(1970, 1, 1, tzinfo=UTC)
        part = match[2] or ""
        return int(f"{since.days * 86400 + since.seconds}{part}"), len(part)
    raise ValueError(f"{shorten(repr(text.strip()))} is neither seconds nor an ISO 8601 time")


def ticks_of(times: Sequence[tuple[int, int]]) -> tuple[list[int], int]:
    """Return (ticks, ticks a second): all times exactly, on the coarsest power of ten that is at least nanoseconds."""
    decimals = max((d for _, d in times), default=0)
    decimals = max(decimals, LEAST_DECIMALS)
    ticks = [digits * 10 ** (decimals - d) for digits, d in times]
    while decimals > LEAST_DECIMALS and not any(t % 10 for t in ticks):
        ticks = [t // 10 for t in ticks]
        decimals -= 1
    return ticks, 10**decimals


def snap(ticks: Sequence[int], per_second: Fraction, rate: Fraction) -> list[int]:
    """Return the nearest sample number of each time. OffGrid if one is further off than its writer's rounding explains.

    Where a sample period is whole ticks there is nothing to round and a time must fall on a sample;
    else the writer may have rounded or cut by up to a tick.
    """
    period = per_second / rate  # ticks a sample
    allowed = Fraction(0) if period.denominator == 1 else Fraction(1)
    samples = []
    top, bottom = period.denominator, period.numerator  # samples = ticks * top / bottom
    for which, tick in enumerate(ticks):
        sample = (2 * tick * top + bottom) // (2 * bottom)
        off = tick * top - sample * bottom  # in ticks / top
        if abs(off) > allowed * top:
            raise OffGrid(which, Fraction(off, top))
        samples.append(sample)
    return samples
