"""The mean of a recording at rest and its uncertainty, for bias or hard iron.

Equations 4.9 (bias: mean minus expected value) and 4.10 (hard iron: mean with minus mean without the disturbance).
Three parts of a mean's uncertainty add up in squares:

    white noise       density / length in seconds
        drift             where the curve is above the white noise's line at long tau, averaging does not help any more
        whole LSB         if the noise is small compared with an LSB, the mean of rounded values is not the mean rounded
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi, sqrt

import numpy as np
from scipy.special import chdtrc

from .allan import Allan
from .confidence import edf
from .density import Density
from .series import Series

LEAST_EDF = 2.0  # of the longest tau used to detect drift
UNLIKELY = 1e-3  # that white noise alone is so high


@dataclass(frozen=True)
class Mean:
    """value and its standard error, in the unit of the samples; white, drift, quantisation: the parts of the error."""

    value: float
    white: float
    drift: float
    quantisation: float

    @property
    def error(self) -> float:
        return sqrt(self.white**2 + self.drift**2 + self.quantisation**2)

    def less(self, other: Mean) -> Mean:
        """Return the difference of two independent means: with minus without a disturbance."""
        return Mean(
            self.value - other.value,
            sqrt(self.white**2 + other.white**2),
            sqrt(self.drift**2 + other.drift**2),
            sqrt(self.quantisation**2 + other.quantisation**2),
        )

    def minus(self, expected: float) -> Mean:
        """Return the bias against an exactly known value."""
        return Mean(self.value - expected, self.white, self.drift, self.quantisation)


def mean(series: Series, found: Allan, noise: Density) -> Mean:
    """Return the mean of a series whose Allan variances and white noise are known."""
    length = len(series.samples) * series.period
    return Mean(
        float(series.samples.mean()),
        sqrt(noise.value / length),
        _drift(found, noise),
        _quantisation(series, noise),
    )


def _drift(found: Allan, noise: Density) -> float:
    """Return the highest deviation after the white noise's region where it is clearly above its line; else 0."""
    freedom = edf(found)
    behind = slice(noise.region.stop, int(np.count_nonzero(freedom >= LEAST_EDF)))
    ratio = found.variance[behind] * found.taus[behind] / noise.value
    by_chance = chdtrc(freedom[behind], freedom[behind] * ratio)
    above = np.flatnonzero(by_chance < UNLIKELY)
    return float(found.deviation[behind][above[0] :].max()) if len(above) else 0.0


def _quantisation(series: Series, noise: Density) -> float:
    """Return the RMS error, over all true means, of the mean of Gaussian values that are rounded to whole LSB.

    The first term of the Fourier series of the rounding error: LSB / pi * exp(-2 pi**2 (sigma / LSB)**2) at most
    (Widrow and Kollar, "Quantization noise", chapter 4).
    """
    if series.lsb is None:
        return 0.0
    variance = max(noise.value / series.period / series.lsb**2 - 1 / 12, 0.0)
    return series.lsb / pi * exp(-2 * pi**2 * variance) / sqrt(2)
