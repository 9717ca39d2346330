"""Sources (tick -> x, y, z) of the quantities that a chip measures, from rows of a table or a rule.

A Source is a plain function of time, so a chip may sample any instant, repeatedly or never.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise

from .register_chip import Source

ZERO: Sequence[Fraction] = (Fraction(0), Fraction(0), Fraction(0))


def held(ticks: Sequence[int], rows: Sequence[Sequence[float | Fraction]]) -> Source:
    """Return row n's x, y, z from ticks[n] on, the first row's also before: lists, or int64[n] and float64[n, 3].

    ValueError if the ticks do not rise.
    """
    if len(ticks) != len(rows) or not len(ticks):
        raise ValueError(f"{len(ticks)} times for {len(rows)} rows; each row needs one, and there must be one at least")
    for before, after in pairwise(ticks):
        if after <= before:
            raise ValueError("the times of the rows must rise from row to row")
    return lambda tick: rows[max(bisect_right(ticks, tick) - 1, 0)]


def numbered(first: int, period: int, values: Callable[[int], Sequence[int]]) -> Source:
    """Return `values(n)` from first + n * period on, zeros before: values that change with a host's frames."""
    kept, axes = -1, ZERO  # the last frame used: a chip samples several times a frame

    def at(tick: int) -> Sequence[Fraction]:
        nonlocal kept, axes
        if tick < first:
            return ZERO
        number = (tick - first) // period
        if number != kept:
            kept, axes = number, tuple(Fraction(value) for value in values(number))
        return axes

    return at


def scaled(source: Source, lsb_per_unit: Fraction) -> Source:
    """Convert a source in LSB to the chip's physical unit, exactly."""
    kept: Sequence[float | Fraction] | None = None  # the source's last value, and the result
    axes: Sequence[Fraction] = ZERO

    def at(tick: int) -> Sequence[Fraction]:
        nonlocal kept, axes
        given = source(tick)
        if given is not kept:
            kept, axes = given, tuple(Fraction(value) / lsb_per_unit for value in given)
        return axes

    return at
