"""Search for the first input, from ordinary to extreme, at which an arithmetic deviates from the reference.

value --> parameters, counts --> codes in the arithmetic --+--> first value at which the codes differ by more
value --> reference's inputs --> codes in the reference  --+    than allowed

The first value is searched on a coarse grid, and then on ever finer grids between two adjacent points.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..models import parameters
from .frames import REFERENCE, SENSORS, CodesOfSamples, Ints, codes_of
from .working_range import Worst

# "agrees": the deviation is no larger than in the working range. "exact": there is no deviation.
# "off": the deviation is larger. "full scale": the converter returns its lowest or highest code, as intended.
# "saturates", "wraps": a result does not fit the Q format. "NaN": a value before rounding is NaN.
# "refused": the input is rejected with an error.
Happens = Literal["agrees", "exact", "off", "full scale", "saturates", "wraps", "NaN", "refused"]


def overflow_of(arithmetic: str) -> Happens:
    """Return the effect of an overflow in a Q format, "saturates" or "wraps". arithmetic: the name of the format."""
    return "saturates" if arithmetic.endswith("saturating") else "wraps"


EVERY = "every"  # replaces the name of an arithmetic in findings that do not depend on the arithmetic


@dataclass(frozen=True)
class ExtremeFinding:
    """The behaviour of an arithmetic at an extreme.

    extreme: the name of the extreme.
    arithmetic: the name of the arithmetic, or EVERY.
    happens: the effect (see `Happens`).
    begins: the first input with this effect, in `unit`; None if no single input causes the effect.
    worst: the largest deviation from the reference, in LSB; None if no codes were compared.
    note: a remark for the report; "" for none.
    overflows: the first input at which an intermediate value exceeds the range of the Q format, in `unit`, with or
        without an effect on codes; None if there is none.
    """

    extreme: str
    arithmetic: str
    happens: Happens
    begins: float | None
    unit: str
    worst: float | None = None
    note: str = ""
    overflows: float | None = None


# Number of points from the ordinary to the extreme value. A coarser grid might contain only points at which codes that
# have wrapped are right by chance.
FIRST_GRID = 121
GRID = 13  # number of points of each finer grid, which lies between two adjacent points of the previous grid
ZOOMS = 4  # number of finer grids

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Sample:
    """The inputs of an arithmetic and of the reference at one value of a sweep.

    imu, counts: the parameters, and the counts of a sample (see `frames`), int64[12].
    true_imu, true_counts: the parameters and the counts for the reference; None if they are the same as `imu` or
        `counts`.
    """

    imu: parameters.ImuParameters
    counts: Ints
    true_imu: parameters.ImuParameters | None = None
    true_counts: Ints | None = None


@dataclass(frozen=True)
class InputSweep:
    """A sweep of an input from an ordinary to an extreme value.

    what: a description for the report.
    unit: the unit of the input.
    ordinary, extreme: the first and the last value, in `unit`. The last value may be smaller than the first.
    at: a function that returns the inputs for a value of the sweep.
    slack: additional LSB by which codes may differ. It is needed if an angle and the corresponding angle of the
        reference differ, for example by a full turn, because each of them is rounded to counts on its own.
    """

    name: str
    what: str
    unit: str
    ordinary: float
    extreme: float
    at: Callable[[float], Sample]
    slack: float = 0

    def find(self, arithmetic: str, worst: Worst | None) -> ExtremeFinding:
        """Find the first value of the sweep at which an arithmetic deviates from the reference.

        A deviation is the difference from the reference's codes, which are calculated in float64 from `true_imu` and
        `true_counts`. So float64 itself can deviate in a sweep whose samples have other inputs for the reference. If
        float64 does not deviate, the function finds the first value at which a converter is at full scale.

        worst: the largest errors of the arithmetic in the working range. Errors of this size are allowed. It is None
            for float64, for which 1 LSB is allowed.
        """
        allowed = (np.ones(9) if worst is None else worst.allowed()) + self.slack
        largest = float(_grid(self, arithmetic, self.ordinary, self.extreme, FIRST_GRID).off.max())
        overflows = self._first(arithmetic, lambda grid: grid.codes.overflown)
        begins = self._first(arithmetic, lambda grid: grid.astray(allowed))
        happens: Happens = "agrees"
        if begins is not None:
            there = _grid(self, arithmetic, begins, begins, 1)
            if np.isnan(there.codes.exact[:, 0]).any():
                happens = "NaN"
            else:
                happens = overflow_of(arithmetic) if there.codes.overflown[0] else "off"
            largest = max(largest, float(there.off.max()))
        elif worst is None:
            begins = self._first(arithmetic, lambda grid: grid.full)
            happens = "agrees" if begins is None else "full scale"
        return ExtremeFinding(self.name, arithmetic, happens, begins, self.unit, largest, overflows=overflows)

    def _first(self, arithmetic: str, holds: Callable[[Grid], Bools]) -> float | None:
        """Return the first value of the sweep at which `holds` is true; None if it is false at all points.

        The search uses ever finer grids. holds: a function that returns a boolean for each point of a grid.
        """
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
    """The results of one arithmetic at the points of a grid.

    values: the values of the input, float64[n].
    off: the deviation of the codes from the reference, float64[9, n].
    full: for each point, True if a code is the lowest or the highest code of its converter, bool[n].
    """

    values: Floats
    codes: CodesOfSamples
    off: Floats
    full: Bools

    def astray(self, allowed: Floats) -> Bools:
        """Return, for each point, True if a code deviates by more than `allowed` or a value before rounding is NaN."""
        return np.logical_or((self.off > allowed[:, None]).any(axis=0), np.isnan(self.codes.exact).any(axis=0))


@lru_cache(maxsize=256)
def _grid(sweep: InputSweep, arithmetic: str, low: float, high: float, points: int) -> Grid:
    """Evaluate a sweep at a number of points from low to high."""
    values = np.linspace(low, high, points)
    samples = [sweep.at(float(value)) for value in values]
    codes = _together(arithmetic, samples)
    limits = [[getattr(one.imu, name).limits for name in SENSORS] for one in samples]
    lowest, highest = np.repeat(np.array(limits), 3, axis=1).transpose(2, 1, 0)
    full = np.logical_or(codes.codes <= lowest, codes.codes >= highest).any(axis=0)
    return Grid(values, codes, np.abs(codes.codes - _true(sweep, low, high, points)), full)


@lru_cache(maxsize=256)
def _true(sweep: InputSweep, low: float, high: float, points: int) -> Floats:
    """Return the codes of the reference at a number of points from low to high."""
    samples = [sweep.at(float(value)) for value in np.linspace(low, high, points)]
    true = [
        Sample(one.true_imu or one.imu, one.counts if one.true_counts is None else one.true_counts) for one in samples
    ]
    return _together(REFERENCE, true).codes


def _together(arithmetic: str, samples: list[Sample]) -> CodesOfSamples:
    """Return the codes of all samples. They are calculated at once if all samples have the same parameters."""
    if all(one.imu is samples[0].imu for one in samples):
        return codes_of(arithmetic, samples[0].imu, np.stack([one.counts for one in samples], axis=1))
    each = [codes_of(arithmetic, one.imu, one.counts[:, np.newaxis]) for one in samples]
    return CodesOfSamples(
        np.hstack([one.codes for one in each]),
        np.hstack([one.exact for one in each]),
        np.hstack([one.overflown for one in each]),
    )
