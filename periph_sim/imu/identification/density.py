"""Density of white noise, N squared, from the part of the Allan deviation with slope -1/2.

    tau nearest 1 s, or below it --> neighbours that agree, on both sides --> weighted mean of variance * tau = density

Dissertation section 4.3.4: the density is the square of the Allan deviation at tau = 1 s, read where its slope is -1/2.
There variance * tau is the same at every tau, so all these points give the same value as at 1 s, with a smaller error.
If the curve has left that slope before 1 s, the line through its earlier part is read there, as IEEE 952 does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .allan import Allan
from .confidence import interval, white_covariance
from .series import BadSeries, Floats

READ_AT = 1.0  # s
LEAST_EDF = 8.0  # below that a variance is too uncertain to determine a slope
LEAST_POINTS = 3  # needed for a line
AGREE = 3.0  # standard errors within which a point belongs to the region


@dataclass(frozen=True, eq=False)
class Density:
    """value, error in unit**2 s: N squared and its standard error; edf of its chi-square. region: indices fitted."""

    value: float
    error: float
    edf: float
    region: slice
    at_one_second: float  # the square of the deviation at the tau nearest 1 s, times that tau

    def bounds(self, level: float) -> tuple[float, float]:
        """Return the interval that contains the true density with this probability."""
        low, high = interval(np.array([self.edf]), level)
        return self.value * float(low[0]), self.value * float(high[0])


def density(name: str, found: Allan) -> Density:
    """Return the density of white noise in a curve of octaves. BadSeries if its slope is not -1/2 about 1 s."""
    relative = white_covariance(found.counts, found.length)
    known = int(np.count_nonzero(2 / np.diag(relative) >= LEAST_EDF))
    relative = relative[:known, :known]
    scaled_variance = found.variance[:known] * found.taus[:known]
    if not scaled_variance.all():
        raise BadSeries(f"{name}: an Allan variance is 0, so there is no noise to be found")
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
    """Return the points around one that are on a line of slope -1/2."""
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
    """Weight each point by its own uncertainty: optimal weights would be worse for a sensor that is not quite white."""
    weights = 1 / np.diag(relative)[region]
    scaled: Floats = weights / weights.sum()
    return scaled


def _agrees(scaled_variance: Floats, relative: Floats, begin: int, end: int, candidate: int) -> bool:
    """True if a point is on the line of the region so far, within the scatter of white noise."""
    region = slice(begin, end)
    weights = _weights(relative, region)
    mean = weights @ scaled_variance[region]
    variance = (
        relative[candidate, candidate]
        - 2 * weights @ relative[region, candidate]
        + weights @ relative[region, region] @ weights
    )
    return bool(abs(scaled_variance[candidate] / mean - 1) < AGREE * variance**0.5)
