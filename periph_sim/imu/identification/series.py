"""A recording checked for identification: float64 samples and their LSB."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.input_error import InputError

Floats = NDArray[np.float64]

LEAST_SAMPLES = 32  # with fewer, no Allan variance has enough degrees of freedom for an error bar
LARGEST = 1e100  # beyond that the squares of sums overflow
REPEATED = 4  # samples a value, on average, of a recording that counts as quantized
OFF_GRID = 0.05  # LSB by which a printed value may be off the grid


class BadSeries(InputError):
    """A recording unsuitable for identification; the message says what was found and expected."""


@dataclass(frozen=True, eq=False)
class Series:
    """samples, one every `period` seconds. lsb: the step between values; None if they are not quantized."""

    name: str
    samples: Floats
    period: float
    lsb: float | None


def series(name: str, samples: ArrayLike, period: float) -> Series:
    """Check samples. BadSeries if they are too few, not all finite, or not one-dimensional."""
    if not isfinite(period) or period <= 0:
        raise BadSeries(f"{name}: the sampling period is {period} s; expected a finite number above 0")
    values = np.asarray(samples, dtype=np.float64)
    if values.ndim != 1:
        raise BadSeries(f"{name}: the samples have the shape {values.shape}; expected one dimension")
    if len(values) < LEAST_SAMPLES:
        raise BadSeries(f"{name}: {len(values)} samples; expected {LEAST_SAMPLES} or more")
    wrong = np.flatnonzero(~np.isfinite(values))
    if len(wrong):
        raise BadSeries(
            f"{name}: sample {wrong[0]} is {values[wrong[0]]}, and {len(wrong)} of {len(values)} are no finite numbers"
        )
    largest = float(np.abs(values).max())
    if largest > LARGEST:
        raise BadSeries(f"{name}: a sample is {largest:g} in size; expected {LARGEST:g} or less, as of any sensor")
    return Series(name, values, period, lsb_of(values))


def lsb_of(values: Floats) -> float | None:
    """Return the step between the values of a converter; None for a constant, or values without a common step."""
    levels = np.unique(values)
    if len(levels) < 2 or len(levels) * REPEATED > len(values):
        return None
    apart = np.diff(levels)
    steps = np.rint(apart / apart.min())
    lsb = float((levels[-1] - levels[0]) / steps.sum())
    return lsb if (np.abs(apart - steps * lsb) < OFF_GRID * lsb).all() else None
