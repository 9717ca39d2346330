"""Uncertainty of Allan variances: degrees of freedom and confidence intervals.

An Allan variance has a chi-square distribution with `edf` equivalent degrees of freedom. So its relative variance is
2 / edf. For error bars at any slope, `edf` uses the approximations of NIST SP 1065, table 5 (overlapping). The points
of a curve are calculated from the same samples, so they are correlated. For white noise, `white_covariance` returns the
exact covariances, which a fit to several points needs.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri, ndtr

from .allan import Allan, Floats

# Levels of confidence. The first is the probability that a Gaussian value is within one standard deviation of its mean.
LEVELS = {"68 %": float(2 * ndtr(1) - 1), "95 %": 0.95}


def interval(edf: Floats, level: float) -> tuple[Floats, Floats]:
    """Return the factors by which a variance is multiplied to get the lower and upper end of its confidence interval.

    edf: the equivalent degrees of freedom of each variance.
    level: the probability that the interval contains the true variance.
    """
    tail = (1 - level) / 2
    return edf / chdtri(edf, tail), edf / chdtri(edf, 1 - tail)


def slopes(found: Allan) -> NDArray[np.int64]:
    """Return the type of noise at each tau: -1 (white), 0 (flicker) or 1 (random walk).

    The type is the integer from -1 to 1 that is nearest to the slope of log(variance) over log(tau). If no slope can be
    calculated, because there is only one tau or a variance is 0, the type is -1.
    """
    if len(found.taus) < 2 or not (found.variance > 0).all():
        return np.full(len(found.taus), -1)
    slope = np.gradient(np.log(found.variance), np.log(found.taus))
    nearest: NDArray[np.int64] = np.clip(np.rint(slope), -1, 1).astype(np.int64)
    return nearest


def edf(found: Allan) -> Floats:
    """Return the equivalent degrees of freedom of each variance, at least 1, for the type of noise from `slopes`."""
    points = found.length + 1.0  # number of points of the phase, which is the running sum of the samples
    m = found.counts.astype(np.float64)
    white = (3 * (points - 1) / (2 * m) - 2 * (points - 2) / points) * 4 * m**2 / (4 * m**2 + 5)
    flicker = np.where(m == 1, 2 * (points - 2) ** 2 / (2.3 * points - 4.9), 5 * points**2 / (4 * m * (points + 3 * m)))
    walk = (points - 2) / m * ((points - 1) ** 2 - 3 * m * (points - 1) + 4 * m**2) / (points - 3) ** 2
    freedom: Floats = np.maximum(np.choose(slopes(found) + 1, [white, flicker, walk]), 1.0)
    return freedom


def white_covariance(counts: NDArray[np.int64], length: int) -> Floats:
    """Return the exact relative covariances of the overlapping Allan variances of white Gaussian noise, float64[n, n].

    Each covariance is divided by the expected values of both variances. A difference of two averages over m samples is
    a sum of samples with the weights -1/m and 1/m, so it is Gaussian. The covariance of the squares of two Gaussian
    values is twice the square of the covariance of the values.

    counts: for each variance, the number m of samples in an average, int64[n].
    length: the number of samples of the recording.
    """
    pairs = [[_covariance(min(m, n), max(m, n), length) * m * n for n in counts.tolist()] for m in counts.tolist()]
    return np.array(pairs)


@lru_cache(maxsize=4096)
def _covariance(m: int, n: int, length: int) -> float:
    """Return the covariance of the Allan variances with averages over m and n samples. Samples have the variance 1."""
    places_m, places_n = length - 2 * m + 1, length - 2 * n + 1
    corners = np.array([a * m - b * n for a in range(3) for b in range(3)], dtype=np.float64)
    weights = np.outer([-1, 2, -1], [-1, 2, -1]).ravel() / (2.0 * m * n)

    def term(lag: Floats) -> Floats:
        """Return the number of pairs with a distance of `lag`, times the square of the covariance of such a pair.

        A pair consists of a difference of two averages over m samples, and of a difference of two averages over n
        samples that begins `lag` samples later.
        """
        shared = -(np.abs(lag[:, np.newaxis] - corners) @ weights)
        pairs = np.minimum(places_n, places_m + lag) - np.maximum(0.0, lag)
        together: Floats = np.maximum(pairs, 0.0) * shared**2
        return together

    # Between two adjacent lags in `bends`, the value of `term` is a cubic polynomial of the lag. To sum it over the
    # integer lags in between, only its value in the middle and half of its second derivative there (`curve`) are
    # needed, because the odd powers of the distance from the middle cancel.
    bends = [*corners, 0, places_n - places_m, -places_m, places_n]
    edges = np.unique(np.clip(bends, max(-2 * n, -places_m), min(2 * m, places_n)))
    begin, end = edges[:-1], edges[1:] - 1
    end[-1] += 1
    many = end - begin + 1
    middle, half = (begin + end) / 2, np.maximum((end - begin) / 2, 0.5)
    curve = (term(middle + half) + term(middle - half) - 2 * term(middle)) / (2 * half**2)
    total = many * term(middle) + curve * many * (many**2 - 1) / 12
    return float(total.sum()) * 2 / (4 * places_m * places_n)
