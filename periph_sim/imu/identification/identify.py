"""Identification of one axis of a sensor at rest: bias, noise density, and optionally the slow terms.

The bias is the mean minus the expected value (equation 4.9), hard iron is the mean with minus the mean without the
disturbance (4.10). Three parts of a mean's uncertainty add up in squares:

    white noise       density / length in seconds
    drift             where the curve is above the white noise's line at long tau, averaging does not help any more
    whole LSB         if the noise is small compared with an LSB, the mean of rounded values is not the mean rounded
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import chdtrc

from .allan import Allan, BadSeries, Series, allan, series
from .confidence import edf
from .noise_terms import Density, SlowTerms, density, slow_terms, white_part

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


LEAST_SIGMA = 0.4  # LSB of noise; below that rounding adds more than LSB**2 / 12


@dataclass(frozen=True, eq=False)
class Identified:
    """Results for one axis. bias: the mean minus the expected one, or minus the mean without the disturbance.

    density: as measured, rounding to LSB included; fitted together with slow terms, if any.
    notes: warnings for the reader, a sentence each.
    """

    series: Series
    allan: Allan
    density: Density
    bias: Mean
    slow: SlowTerms | None
    notes: tuple[str, ...]

    @property
    def quantisation_density(self) -> float:
        """The part of the density due to rounding to whole LSB, unit**2 s: LSB**2 / 12 a sample."""
        return 0.0 if self.series.lsb is None else self.series.lsb**2 / 12 * self.series.period

    @property
    def sensor_density(self) -> float:
        """The density of the sensor's own noise, for models, which round by themselves."""
        return max(self.density.value - self.quantisation_density, 0.0)


def identify(
    name: str,
    samples: ArrayLike,
    period: float,
    *,
    expected: float = 0.0,
    undisturbed: ArrayLike | None = None,
    slow: bool = False,
) -> Identified:
    """Identify the parameters of one axis, recorded at rest every `period` seconds.

    expected: the true mean. undisturbed: samples without the disturbance, whose mean is used instead (hard iron).
    Raise BadSeries if nothing can be identified: too few samples, NaN, a constant.
    """
    given = series(name, samples, period)
    found, noise, terms = _fitted(given, slow)
    level = mean(given, found, noise)
    if undisturbed is None:
        bias = level.minus(expected)
    else:
        other = series(f"{name} undisturbed", undisturbed, period)
        bias = level.less(mean(other, *_fitted(other, slow)[:2]))
    return Identified(given, found, noise, bias, terms, tuple(_notes(given, noise, bias)))


def _fitted(given: Series, slow: bool) -> tuple[Allan, Density, SlowTerms | None]:
    first = given.samples[0]
    if (given.samples == first).all():
        raise BadSeries(
            f"{given.name}: all {len(given.samples)} samples are {first:g}; the noise is less than the resolution, "
            "so neither it nor the error of the mean can be determined"
        )
    found = allan(given.samples, given.period)
    if not slow:
        return found, density(given.name, found), None
    terms = slow_terms(found)
    return found, white_part(found, terms), terms


def _notes(given: Series, noise: Density, bias: Mean) -> list[str]:
    notes = []
    if given.lsb is not None:
        sigma = np.sqrt(noise.value / given.period) / given.lsb
        if sigma < LEAST_SIGMA:
            notes.append(
                f"{given.name}: the noise is {sigma:.2g} LSB of {given.lsb:.4g}; below {LEAST_SIGMA} LSB rounding "
                "hides it, and the density is unreliable"
            )
    if bias.drift:
        notes.append(
            f"{given.name}: the averages drift by {bias.drift:.2g}, more than white noise does; averaging longer "
            "does not improve the bias"
        )
    return notes
