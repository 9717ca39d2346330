"""Search for the first input, from ordinary to extreme, at which an arithmetic deviates from the reference.

value --> parameters, counts --------> codes --+-> first value at which they differ by more than allowed,
value --> those of the reference ----> codes --+   searched on a grid, then between two of its points, and so on
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..models import parameters
from .frames import REFERENCE, SENSORS, Codes, Ints, codes_of
from .working_range import Worst

# agrees: as near as in the working range. exact: no deviation. full scale: the converter's last code, as intended.
Happens = Literal["agrees", "exact", "off", "full scale", "saturates", "wraps", "NaN", "refused"]


def overflow_of(arithmetic: str) -> Happens:
    """Return the effect of an overflow in a Q format."""
    return "saturates" if arithmetic.endswith("saturating") else "wraps"


EVERY = "every"  # in place of an arithmetic if a finding involves none


@dataclass(frozen=True)
class Finding:
    """The behaviour of an arithmetic at an extreme.

    arithmetic: the name of the arithmetic, or EVERY.
    begins: the first input at which it happens, in `unit`; None if it never happens.
    worst: the largest deviation from the reference, in LSB.
    overflows: the first input at which an intermediate value exceeded a Q format, with or without a visible effect.
    """

    extreme: str
    arithmetic: str
    happens: Happens
    begins: float | None
    unit: str
    worst: float | None = None
    note: str = ""
    overflows: float | None = None


FIRST_GRID = 121  # number of points from ordinary to extreme; with fewer, values that wrapped may look right
GRID = 13  # number of points of each finer grid between two points
ZOOMS = 4

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Sample:
    """The inputs of a model at one value of a sweep, and those of the reference, which are the same by default."""

    imu: parameters.ImuParameters
    counts: Ints  # counts of a sample (see `frames`), int64[12]
    true_imu: parameters.ImuParameters | None = None
    true_counts: Ints | None = None


@dataclass(frozen=True)
class Sweep:
    """A sweep of an input from an ordinary to an extreme value.

    ordinary, extreme: the first and the last value, in `unit`. The last value may be smaller than the first.
    slack: additional LSB by which codes may differ, because the counts of a frame are rounded differently in the
        reference.
    """

    name: str
    what: str
    unit: str
    ordinary: float
    extreme: float
    at: Callable[[float], Sample]
    slack: float = 0

    def find(self, arithmetic: str, worst: Worst | None) -> Finding:
        """Find the first deviation of an arithmetic. worst: its allowed deviation; None for the reference itself."""
        allowed = (np.ones(9) if worst is None else worst.allowed()) + self.slack
        largest = float(_grid(self, arithmetic, self.ordinary, self.extreme, FIRST_GRID).off.max())
        overflows = self._first(arithmetic, lambda grid: grid.codes.overflown)
        begins = self._first(arithmetic, lambda grid: grid.astray(allowed))
        happens: Happens = "agrees"
        if begins is not None:
            there = _grid(self, arithmetic, begins, begins, 1)
            happens = there.how(arithmetic)
            largest = max(largest, float(there.off.max()))
        elif worst is None:
            begins = self._first(arithmetic, lambda grid: grid.full)
            happens = "agrees" if begins is None else "full scale"
        return Finding(self.name, arithmetic, happens, begins, self.unit, largest, overflows=overflows)

    def _first(self, arithmetic: str, holds: Callable[[Grid], Bools]) -> float | None:
        """Return the first value of the sweep at which `holds` is true, found by ever finer grids; else None."""
        low, high, found = self.ordinary, self.extreme, None
        for points in (FIRST_GRID, *[GRID] * ZOOMS):
            grid = _grid(self, arithmetic, low, high, points)
            held = np.flatnonzero(holds(grid))
            if not len(held):
                return found
            found = float(grid.values[held[0]])
            if held[0] == 0:
                return found
            low, high = float(grid.values[held[0] - 1]), found
        return found


@dataclass(frozen=True)
class Grid:
    """The results of an arithmetic at the points of a grid.

    values: the values of the input, float64[n].
    off: the deviation of the codes from the reference, float64[9, n].
    full: True if a code is the last one of its converter.
    """

    values: Floats
    codes: Codes
    off: Floats
    full: Bools

    def astray(self, allowed: Floats) -> Bools:
        """Return True for points at which codes deviate by more than allowed, or a value before rounding is NaN."""
        return np.logical_or((self.off > allowed[:, None]).any(axis=0), np.isnan(self.codes.exact).any(axis=0))

    def how(self, arithmetic: str) -> Happens:
        """Return the reason of the deviation at the first point."""
        if np.isnan(self.codes.exact[:, 0]).any():
            return "NaN"
        return overflow_of(arithmetic) if self.codes.overflown[0] else "off"


@lru_cache(maxsize=256)
def _grid(sweep: Sweep, arithmetic: str, low: float, high: float, points: int) -> Grid:
    """Evaluate a sweep at a number of points from low to high."""
    values = np.linspace(low, high, points)
    samples = [sweep.at(float(value)) for value in values]
    codes = _together(arithmetic, samples)
    limits = [[getattr(one.imu, name).limits for name in SENSORS] for one in samples]
    lowest, highest = np.repeat(np.array(limits), 3, axis=1).transpose(2, 1, 0)
    full = np.logical_or(codes.codes <= lowest, codes.codes >= highest).any(axis=0)
    return Grid(values, codes, np.abs(codes.codes - _true(sweep, low, high, points)), full)


@lru_cache(maxsize=256)
def _true(sweep: Sweep, low: float, high: float, points: int) -> Floats:
    """Return the codes of the reference at the points of such a grid."""
    samples = [sweep.at(float(value)) for value in np.linspace(low, high, points)]
    true = [
        Sample(one.true_imu or one.imu, one.counts if one.true_counts is None else one.true_counts) for one in samples
    ]
    return _together(REFERENCE, true).codes


def _together(arithmetic: str, samples: list[Sample]) -> Codes:
    """Return the codes of all samples. They are calculated at once if all samples have the same parameters."""
    if all(one.imu is samples[0].imu for one in samples):
        return codes_of(arithmetic, samples[0].imu, np.stack([one.counts for one in samples], axis=1))
    each = [codes_of(arithmetic, one.imu, one.counts[:, np.newaxis]) for one in samples]
    return Codes(
        np.hstack([one.codes for one in each]),
        np.hstack([one.exact for one in each]),
        np.hstack([one.overflown for one in each]),
    )
