"""Overlapping Allan variance of a recording: half the mean square of the change between adjacent averages.

    averages over m samples --> differences of adjacent averages, at every place --> mean square / 2

Equations 4.11 to 4.15 of the dissertation with overlapping clusters; IEEE Std 952 annex C, NIST SP 1065 section 5.2.4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.input_error import InputError

Floats = NDArray[np.float64]

LEAST_SAMPLES = 32  # minimum number of samples; with fewer, an Allan variance has too few degrees of freedom
LARGEST = 1e100  # maximum magnitude of a sample; with larger ones, the squares of sums overflow
REPEATED = 4  # a recording is quantized if each value occurs at least this many times on average
OFF_GRID = 0.05  # tolerance in LSB for values that were printed with few digits


class BadSeries(InputError):
    """A recording is unsuitable for identification. The message says what was found and expected."""


@dataclass(frozen=True, eq=False)
class Series:
    """A recording with a sample every `period` seconds.

    name: the name of the recording, for messages.
    lsb: the step between values; None if the values are not quantized.
    """

    name: str
    samples: Floats
    period: float
    lsb: float | None


def series(name: str, samples: ArrayLike, period: float) -> Series:
    """Check samples and return them as a series.

    Raise BadSeries if there are too few samples or not exactly one dimension, if a sample is not finite or too large,
    or if the period is not a finite number above 0.

    period: the time between two samples in seconds.
    """
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
    """Return the step between the values of a converter; None if the values are not quantized.

    Values count as quantized if they are not constant, have a common step, and repeat often enough (see REPEATED).
    """
    levels = np.unique(values)
    if len(levels) < 2 or len(levels) * REPEATED > len(values):
        return None
    apart = np.diff(levels)
    steps = np.rint(apart / apart.min())
    lsb = float((levels[-1] - levels[0]) / steps.sum())
    return lsb if (np.abs(apart - steps * lsb) < OFF_GRID * lsb).all() else None


AT_ONCE = 1 << 16  # number of differences that are calculated at once, chosen so that they fit into the CPU's cache


@dataclass(frozen=True, eq=False)
class Allan:
    """The Allan variances of a series.

    counts: the number of samples m in each average.
    taus: the averaging times, which are m times the period, in seconds.
    variance: the variances in unit**2.
    length: the number of samples of the series.
    """

    counts: NDArray[np.int64]
    taus: Floats
    variance: Floats
    length: int

    @property
    def deviation(self) -> Floats:
        """The square root of the variance, in the unit of the samples."""
        return np.sqrt(self.variance)


def octaves(length: int) -> list[int]:
    """Return the powers of two, 1, 2, 4 ..., up to half of `length`, which is a number of samples."""
    return [1 << k for k in range((length // 2).bit_length())]


def allan(samples: Floats, period: float, counts: Sequence[int] | None = None) -> Allan:
    """Calculate the overlapping Allan variance at the averaging time m * period for each m of `counts`.

    The calculation needs memory for two arrays as long as `samples`.

    samples: a vector of finite values.
    counts: the values of m; None for 1, 2, 4 ... up to half the number of samples.

    Raise BadSeries if an m is less than 1 or more than half the number of samples.
    """
    length = len(samples)
    wanted = octaves(length) if counts is None else list(counts)
    for m in wanted:
        if not 1 <= m <= length // 2:
            raise BadSeries(f"an average over {m} of {length} samples; expected 1 to {length // 2}")
    sums = np.empty(length + 1)
    sums[0] = 0.0
    # The mean is subtracted: it does not affect the Allan variance, but would reduce the precision of the sums.
    np.cumsum(samples - samples.mean(), out=sums[1:])
    variance = np.array([_variance(sums, m) for m in wanted])
    taken = np.array(wanted, dtype=np.int64)
    taus: Floats = taken * np.float64(period)
    return Allan(taken, taus, variance, length)


def _variance(sums: Floats, m: int) -> float:
    places = len(sums) - 2 * m
    total = 0.0
    for begin in range(0, places, AT_ONCE):
        end = min(begin + AT_ONCE, places)
        change = sums[begin + 2 * m : end + 2 * m] - 2 * sums[begin + m : end + m] + sums[begin:end]
        total += float(np.square(change, out=change).sum())  # The result of np.dot would depend on the thread count.
    return total / (2 * places * m * m)
