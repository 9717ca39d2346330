"""Identification of the terms of a sensor's noise: white noise N, bias instability B and random walk K.

    variance(tau) = N**2 / tau + (2 ln 2 / pi) B**2 + K**2 tau / 3        slopes -1/2, 0 and +1/2 of the deviation

Without slow terms, only the density of white noise, N squared, is identified. This density follows from the part of the
Allan deviation with slope -1/2:

    tau near 1 s, or below --> points on this slope around this tau --> weighted mean of variance * tau = density

Dissertation section 4.3.4: the density is the square of the Allan deviation at tau = 1 s, where the slope must be -1/2.
On this slope, variance * tau is the same at every tau. So every point on the slope gives the value at 1 s, and the mean
of all these points has a smaller error. If the curve leaves the slope before 1 s, the line through the part with this
slope is extended to 1 s, as in IEEE 952.

With slow terms, all three terms (IEEE Std 952 annex C) are fitted together, because the parts of slope 0 and +1/2
seldom occur alone. The fit uses weighted least squares, and no term is below 0. The points of the curve are calculated
from the same samples, so they are correlated. The correlation is assumed to be the same as for white noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from scipy.optimize import nnls
from scipy.special import ndtri

from .allan import Allan, BadSeries, Floats
from .confidence import edf, interval, white_covariance

READ_AT = 1.0  # tau in seconds at which the density is read
LEAST_EDF_OF_SLOPE = 8.0  # minimum degrees of freedom of a variance from which a slope is determined
LEAST_EDF = 2.0  # minimum degrees of freedom of a variance that is used in the fit of all terms
LEAST_POINTS = 3  # minimum number of points on the line of slope -1/2
ZERO_VARIANCE = "an Allan variance is 0, so there is no noise to be found"
AGREE = 3.0  # a point is on a line if it differs from the line by less than this number of standard errors


@dataclass(frozen=True, eq=False)
class Density:
    """The density of white noise, N squared, in unit**2 s.

    value, error: the density and its standard error.
    edf: the degrees of freedom of the chi-square distribution of `value`.
    region: the indices of the points of the Allan curve from which the density was calculated. It can be empty if slow
        terms were fitted, too (see `white_part`).
    at_one_second: the square of the Allan deviation at the tau nearest to 1 s, times this tau.
    """

    value: float
    error: float
    edf: float
    region: slice
    at_one_second: float

    def bounds(self, level: float) -> tuple[float, float]:
        """Return the ends of the interval that contains the true density with the probability `level`.

        Below LEAST_EDF degrees of freedom, the interval is that of a normal distribution, without the part below 0.
        """
        if self.edf < LEAST_EDF:
            aside = float(ndtri((1 + level) / 2)) * self.error
            return max(self.value - aside, 0.0), self.value + aside
        low, high = interval(np.array([self.edf]), level)
        return self.value * float(low[0]), self.value * float(high[0])


def density(name: str, found: Allan) -> Density:
    """Return the density of white noise from Allan variances at octaves (m = 1, 2, 4 ...).

    name: the name of the series, for messages.

    Raise BadSeries if an Allan variance is 0, or if there is no slope of -1/2 at 1 s or below.
    """
    relative = white_covariance(found.counts, found.length)
    known = int(np.count_nonzero(2 / np.diag(relative) >= LEAST_EDF_OF_SLOPE))
    relative = relative[:known, :known]
    scaled_variance = found.variance[:known] * found.taus[:known]
    if not scaled_variance.all():
        raise BadSeries(f"{name}: {ZERO_VARIANCE}")
    about = int(np.abs(np.log(found.taus[:known] / READ_AT)).argmin())
    regions = (_region(scaled_variance, relative, centre) for centre in range(about, -1, -1))
    region = next((one for one in regions if one.stop - one.start >= LEAST_POINTS), None)
    if region is None:
        slope = np.gradient(np.log(found.deviation[:known]), np.log(found.taus[:known]))[about]
        raise BadSeries(
            f"{name}: the Allan deviation has slope {slope:.2f} at {found.taus[about]:g} s, and less than three points "
            "in a row on a slope of -0.5, that of white noise; fit the slow terms with it"
        )
    weights = _weights(relative, region)
    value = float(weights @ scaled_variance[region])
    variance = float(weights @ relative[region, region] @ weights)
    return Density(value, value * variance**0.5, 2 / variance, region, float(scaled_variance[about]))


def _region(scaled_variance: Floats, relative: Floats, centre: int) -> slice:
    """Return the largest range of adjacent points around the point `centre` that are on a line of slope -1/2.

    scaled_variance: variance * tau of each point, which is constant on this slope.
    relative: the relative covariances of the variances (see `white_covariance`).
    """
    begin, end = centre, centre + 1
    grows = True
    while grows:
        grows = False
        if end < len(scaled_variance) and _agrees(scaled_variance, relative, begin, end, end):
            end, grows = end + 1, True
        if begin and _agrees(scaled_variance, relative, begin, end, begin - 1):
            begin, grows = begin - 1, True
    return slice(begin, end)


def _weights(relative: Floats, region: slice) -> Floats:
    """Return the weights of the points of a region. The sum of the weights is 1.

    Each weight follows from the uncertainty of its point alone. Weights that also use the correlation would be optimal
    for white noise, but worse for noise that is not exactly white.
    """
    weights = 1 / np.diag(relative)[region]
    scaled: Floats = weights / weights.sum()
    return scaled


def _agrees(scaled_variance: Floats, relative: Floats, begin: int, end: int, candidate: int) -> bool:
    """Return True if the point `candidate` is on the line of slope -1/2 through the points `begin` to `end` - 1.

    The tolerance is AGREE standard errors, which are calculated for white noise.
    """
    region = slice(begin, end)
    weights = _weights(relative, region)
    mean = weights @ scaled_variance[region]
    variance = (
        relative[candidate, candidate]
        - 2 * weights @ relative[region, candidate]
        + weights @ relative[region, region] @ weights
    )
    return bool(abs(scaled_variance[candidate] / mean - 1) < AGREE * variance**0.5)


ROUNDS = 4  # number of fits; the weights of a fit follow from the previous fit and converge after a few fits
FLOOR = 2 * log(2) / pi  # the variance of the flat part divided by B squared, so its deviation is 0.664 B


@dataclass(frozen=True)
class Term:
    """A fitted coefficient of the noise: N, B or K.

    squared: the square of the coefficient.
    squared_error: the standard error of this square.
    """

    squared: float
    squared_error: float

    @property
    def value(self) -> float:
        return sqrt(self.squared)

    @property
    def found(self) -> bool:
        """True if the square of the coefficient differs from 0 by more than two standard errors."""
        return self.squared > 2 * self.squared_error

    def bounds(self, errors: float) -> tuple[float, float]:
        """Return the lower and the upper bound of the coefficient.

        The squares of the bounds are `errors` standard errors below and above the square of the coefficient, and at
        least 0.
        """
        aside = errors * self.squared_error
        return sqrt(max(self.squared - aside, 0.0)), sqrt(self.squared + aside)


@dataclass(frozen=True)
class SlowTerms:
    """The three terms of the noise, fitted together.

    white: N in unit * sqrt(s).
    bias_instability: B in unit.
    random_walk: K in unit / sqrt(s).
    """

    white: Term
    bias_instability: Term
    random_walk: Term


def white_part(found: Allan, terms: SlowTerms) -> Density:
    """Return the fitted density of white noise.

    Its region begins at the first point. The length of the region is the number of points at which white noise is more
    than half of the variance; the region is empty if there is none.
    """
    most = int(np.count_nonzero(terms.white.squared / found.taus > found.variance / 2))
    about = int(np.abs(np.log(found.taus / READ_AT)).argmin())
    freedom = 2 * (terms.white.squared / terms.white.squared_error) ** 2
    read = float(found.variance[about] * found.taus[about])
    return Density(terms.white.squared, terms.white.squared_error, freedom, slice(0, most), read)


def slow_terms(name: str, found: Allan) -> SlowTerms:
    """Fit N, B and K to Allan variances at octaves (m = 1, 2, 4 ...).

    name: the name of the series, for messages.

    Raise BadSeries if an Allan variance is 0.
    """
    used = edf(found) >= LEAST_EDF
    taus, variance, freedom = found.taus[used], found.variance[used], edf(found)[used]
    if not variance.all():
        raise BadSeries(f"{name}: {ZERO_VARIANCE}")
    parts = np.stack([1 / taus, np.full_like(taus, FLOOR), taus / 3], axis=1)
    relative = white_covariance(found.counts[used], found.length)
    correlation = relative / np.sqrt(np.outer(np.diag(relative), np.diag(relative)))
    fitted: Floats = variance
    for _ in range(ROUNDS):
        spread = fitted * np.sqrt(2 / freedom)
        squares, _ = nnls(parts / spread[:, np.newaxis], variance / spread)
        fitted = parts @ squares
    scaled = parts / spread[:, np.newaxis]
    inverse = np.linalg.pinv(scaled)
    errors = np.sqrt(np.diag(inverse @ correlation @ inverse.T))
    white, instability, walk = (Term(*pair) for pair in zip(squares.tolist(), errors.tolist(), strict=True))
    return SlowTerms(white, instability, walk)
