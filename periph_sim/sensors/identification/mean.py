"""The mean of a recording at rest and how well it is known: a series and its noise go in; bias or hard iron come out.

Equations 4.9 (bias: mean less what it should be) and 4.10 (hard iron: mean with less mean without the disturbance).
Three things make a mean uncertain, and they add up in squares:

    white noise       density / length in seconds
    what drifts       where the curve lies above the white noise's line at long tau, averaging does not help any more
    whole LSB         where the noise is small beside an LSB, the mean of rounded values is not the mean rounded
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

LEAST_EDF = 2.0  # of the longest tau that is asked whether the averages drift
UNLIKELY = 1e-3  # that white noise alone comes so high


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
        """The difference of two independent means: with a disturbance less without."""
        return Mean(
            self.value - other.value,
            sqrt(self.white**2 + other.white**2),
            sqrt(self.drift**2 + other.drift**2),
            sqrt(self.quantisation**2 + other.quantisation**2),
        )

    def minus(self, expected: float) -> Mean:
        """The bias against a value that is known exactly."""
        return Mean(self.value - expected, self.white, self.drift, self.quantisation)


def mean(series: Series, found: Allan, noise: Density) -> Mean:
    """The mean of a series whose Allan variances and white noise are known."""
    length = len(series.samples) * series.period
    return Mean(
        float(series.samples.mean()),
        sqrt(noise.value / length),
        _drift(found, noise),
        _quantisation(series, noise),
    )


def _drift(found: Allan, noise: Density) -> float:
    """The highest deviation behind the white noise's region, from where it lies clearly above its line; else 0."""
    freedom = edf(found)
    behind = slice(noise.region.stop, int(np.count_nonzero(freedom >= LEAST_EDF)))
    ratio = found.variance[behind] * found.taus[behind] / noise.value
    by_chance = chdtrc(freedom[behind], freedom[behind] * ratio)
    above = np.flatnonzero(by_chance < UNLIKELY)
    return float(found.deviation[behind][above[0] :].max()) if len(above) else 0.0


def _quantisation(series: Series, noise: Density) -> float:
    """Root mean square, over all true means, of what rounding Gaussian values to whole LSB does to their mean.

    The first term of the Fourier series of the rounding error: LSB / pi * exp(-2 pi**2 (sigma / LSB)**2) at most
    (Widrow and Kollar, "Quantization noise", chapter 4).
    """
    if series.lsb is None:
        return 0.0
    variance = max(noise.value / series.period / series.lsb**2 - 1 / 12, 0.0)
    return series.lsb / pi * exp(-2 * pi**2 * variance) / sqrt(2)
