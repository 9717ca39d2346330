"""Identification of one axis of a sensor at rest: bias, noise density, and optionally the slow terms.

The bias is the mean minus the expected value (equation 4.9 of the dissertation). Hard iron is the mean with the
magnetic disturbance minus the mean without it (equation 4.10). The standard error of a mean is the root of the sum of
the squares of three parts:

    white noise       the root of (density of white noise / duration of the recording in seconds)
    drift             the Allan deviation at long tau, if it is above the line of white noise; a longer recording does
                      not reduce this part
    quantisation      the systematic error of the mean of rounded values; large if the noise is much less than an LSB
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

LEAST_EDF = 2.0  # minimum degrees of freedom of the longest tau that is used to detect drift
UNLIKELY = 1e-3  # a variance shows drift if white noise alone would exceed it with less than this probability


@dataclass(frozen=True)
class Mean:
    """A mean and the parts of its standard error, in the unit of the samples.

    value: the mean.
    white, drift, quantisation: the parts of the standard error, as in the head of this module.
    """

    value: float
    white: float
    drift: float
    quantisation: float

    @property
    def error(self) -> float:
        return sqrt(self.white**2 + self.drift**2 + self.quantisation**2)

    def less(self, other: Mean) -> Mean:
        """Return this mean minus an independent mean. The parts of the two standard errors are added as squares."""
        return Mean(
            self.value - other.value,
            sqrt(self.white**2 + other.white**2),
            sqrt(self.drift**2 + other.drift**2),
            sqrt(self.quantisation**2 + other.quantisation**2),
        )


def mean(series: Series, found: Allan, noise: Density) -> Mean:
    """Return the mean of a series, with the parts of its standard error.

    found: the Allan variances of the series.
    noise: the density of its white noise.
    """
    length = len(series.samples) * series.period
    return Mean(
        float(series.samples.mean()),
        sqrt(noise.value / length),
        _drift(found, noise),
        _quantisation(series, noise),
    )


def _drift(found: Allan, noise: Density) -> float:
    """Return the largest Allan deviation from the tau at which drift begins; 0 if there is no drift.

    Drift begins at the first long tau at which the variance is significantly above the line of white noise. A tau is
    long if it is above the region from which the density of white noise was calculated. Taus with fewer than LEAST_EDF
    degrees of freedom are not used.
    """
    freedom = edf(found)
    behind = slice(noise.region.stop, int(np.count_nonzero(freedom >= LEAST_EDF)))
    with np.errstate(divide="ignore"):  # without white noise, each ratio is inf
        ratio = found.variance[behind] * found.taus[behind] / noise.value
    by_chance = chdtrc(freedom[behind], freedom[behind] * ratio)
    above = np.flatnonzero(by_chance < UNLIKELY)
    return float(found.deviation[behind][above[0] :].max()) if len(above) else 0.0


def _quantisation(series: Series, noise: Density) -> float:
    """Return the error that rounding causes in the mean of a series, as RMS over all true means; 0 without rounding.

    The RMS error follows from the first term of the Fourier series of the rounding error, whose amplitude is
    LSB / pi * exp(-2 pi**2 (sigma / LSB)**2) (Widrow and Kollar, "Quantization noise", chapter 4).
    """
    if series.lsb is None:
        return 0.0
    variance = max(noise.value / series.period / series.lsb**2 - 1 / 12, 0.0)
    return series.lsb / pi * exp(-2 * pi**2 * variance) / sqrt(2)


LEAST_SIGMA = 0.4  # minimum sigma of the noise in LSB; below, rounding does not simply add LSB**2 / 12 to the variance


@dataclass(frozen=True, eq=False)
class Identified:
    """The parameters of one axis.

    unit: the unit of the samples, for reports; "" if it is not known.
    bias: the mean minus a reference. The reference is the expected value or, for hard iron, the mean of the recording
        without the magnetic disturbance.
    density: the measured density of white noise, which includes the density of rounding to LSB. If slow terms (bias
        instability and random walk) are requested, the density is fitted together with them.
    slow: the fit of all terms of the noise; None if the slow terms are not requested.
    notes: warnings for the reader, as sentences.
    """

    unit: str
    series: Series
    allan: Allan
    density: Density
    bias: Mean
    slow: SlowTerms | None
    notes: tuple[str, ...]

    @property
    def quantisation_density(self) -> float:
        """The density of the noise from rounding to whole LSB: LSB**2 / 12 times the period; 0 without rounding."""
        return 0.0 if self.series.lsb is None else self.series.lsb**2 / 12 * self.series.period

    @property
    def sensor_density(self) -> float:
        """The measured density minus the density of the rounding noise (`quantisation_density`), but at least 0.

        This is the density in the parameters of the models. The models round their codes, so they add the rounding
        noise themselves.
        """
        return max(self.density.value - self.quantisation_density, 0.0)


def identify(
    name: str,
    samples: ArrayLike,
    period: float,
    *,
    unit: str = "",
    expected: float = 0.0,
    undisturbed: ArrayLike | None = None,
    slow: bool = False,
) -> Identified:
    """Identify the parameters of one axis, recorded at rest every `period` seconds.

    unit: the unit of the samples, for reports.
    expected: the mean that a sensor without bias would have.
    undisturbed: for hard iron, samples without the disturbance; their mean replaces `expected`.
    slow: True to fit bias instability and random walk, too.

    Raise BadSeries if nothing can be identified: samples or period are invalid (see `series`), all samples are equal,
    an Allan variance is 0, or, if `slow` is False, the Allan deviation has no slope of -1/2 at 1 s or below.
    """
    given = series(name, samples, period)
    found, noise, terms = _fitted(given, slow)
    level = mean(given, found, noise)
    if undisturbed is None:
        bias = level.less(Mean(expected, 0.0, 0.0, 0.0))
    else:
        other = series(f"{name} undisturbed", undisturbed, period)
        bias = level.less(mean(other, *_fitted(other, slow)[:2]))
    return Identified(unit, given, found, noise, bias, terms, tuple(_notes(given, noise, bias)))


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
    terms = slow_terms(given.name, found)
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
