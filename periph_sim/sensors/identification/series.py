"""A recording that parameters can be found in: samples go in, float64 samples and their LSB come out, or a refusal."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

LEAST_SAMPLES = 32  # below that no Allan variance has enough degrees of freedom for an error bar
LARGEST = 1e100  # beyond that the squares of sums overflow
REPEATED = 4  # samples a value, on average, of a recording that is taken for one of whole LSB
OFF_GRID = 0.05  # LSB that a printed value may lie beside its place


class BadSeries(ValueError):
    """A recording in which nothing can be found; the message says what was found and expected."""


@dataclass(frozen=True, eq=False)
class Series:
    """samples, one every `period` seconds. lsb: the step between values; None if they are not steps."""

    name: str
    samples: Floats
    period: float
    lsb: float | None


def series(name: str, samples: ArrayLike, period: float) -> Series:
    """BadSeries for samples that are too few, or not all finite numbers, or no series at all."""
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
    """The step between the values of a converter; None for a constant, or where values are not on steps."""
    told = np.unique(values)
    if len(told) < 2 or len(told) * REPEATED > len(values):
        return None
    apart = np.diff(told)
    steps = np.rint(apart / apart.min())
    lsb = float((told[-1] - told[0]) / steps.sum())
    return lsb if (np.abs(apart - steps * lsb) < OFF_GRID * lsb).all() else None
