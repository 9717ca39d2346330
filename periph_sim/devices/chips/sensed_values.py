"""Sources of the quantities that a chip measures: functions from a tick to x, y, z.

The values depend only on the tick, so a chip may sample any instant, repeatedly or never.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import pairwise

from .register_chip import Source

ZERO: Sequence[Fraction] = (Fraction(0), Fraction(0), Fraction(0))


def held(ticks: Sequence[int], rows: Sequence[Sequence[float | Fraction]]) -> Source:
    """Return a source that gives row n from ticks[n] until the tick of the next row. Before ticks[0], it gives row 0.

    ticks: a list or int64[n].
    rows: a list of (x, y, z), or float64[n, 3].

    Raise ValueError if `ticks` is empty or not strictly increasing, or if `rows` has another length than `ticks`.
    """
    if len(ticks) != len(rows) or not len(ticks):
        raise ValueError(f"{len(ticks)} times for {len(rows)} rows; each row needs one, and there must be one at least")
    for before, after in pairwise(ticks):
        if after <= before:
            raise ValueError("the times of the rows must rise from row to row")
    return lambda tick: rows[max(bisect_right(ticks, tick) - 1, 0)]


def numbered(first: int, period: int, values: Callable[[int], Sequence[int]]) -> Source:
    """Return a source that changes with a host's frames.

    The source gives `values(n)` from tick first + n * period on, and zeros before tick `first`.

    first: the tick at which frame 0 is due.
    period: the number of ticks between two frames.
    values: a function from the number of a frame to x, y, z.
    """
    # A cache of the number and the values of the last frame, because a chip takes several samples during a frame.
    kept, axes = -1, ZERO

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
    """Return the source with its values converted exactly from LSB to the chip's physical unit."""
    kept: Sequence[float | Fraction] | None = None  # cached: the last values of `source`; `axes` has the converted ones
    axes: Sequence[Fraction] = ZERO

    def at(tick: int) -> Sequence[Fraction]:
        nonlocal kept, axes
        given = source(tick)
        if given is not kept:
            kept, axes = given, tuple(Fraction(value) / lsb_per_unit for value in given)
        return axes

    return at
