"""The density of white noise: Allan variances go in, the part of the curve that falls with slope -1/2, and N squared.

    tau nearest 1 s, or below it --> neighbours that agree, on both sides --> weighted mean of variance * tau = density

Dissertation section 4.3.4: the density is the square of the Allan deviation at tau = 1 s, read where its slope is -1/2.
There variance * tau is the same at every tau, so all of them tell what the one at 1 s tells, and tell it better.
Where the curve has left that slope before 1 s, the line through its earlier part is read there, as IEEE 952 does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .allan import Allan
from .confidence import interval, white_covariance
from .series import BadSeries, Floats

READ_AT = 1.0  # s
LEAST_EDF = 8.0  # below that a variance is too uncertain to say anything about a slope
LEAST_POINTS = 3  # that make a line
AGREE = 3.0  # standard errors within which a point belongs to the region


@dataclass(frozen=True, eq=False)
class Density:
    """value, error in unit**2 s: N squared and its standard error; edf of its chi-square. region: indices fitted."""

    value: float
    error: float
    edf: float
    region: slice
    at_one_second: float  # the square of the deviation at the tau nearest 1 s, times that tau: as read off

    def bounds(self, level: float) -> tuple[float, float]:
        """The interval in which the true density lies with this probability."""
        low, high = interval(np.array([self.edf]), level)
        return self.value * float(low[0]), self.value * float(high[0])


def density(name: str, found: Allan) -> Density:
    """The density of the white noise in a curve of octaves. BadSeries where it has no part of slope -1/2 about 1 s."""
    relative = white_covariance(found.counts, found.length)
    known = int(np.count_nonzero(2 / np.diag(relative) >= LEAST_EDF))
    relative = relative[:known, :known]
    told = found.variance[:known] * found.taus[:known]
    if not told.all():
        raise BadSeries(f"{name}: an Allan variance is 0, so there is no noise to be found")
    about = int(np.abs(np.log(found.taus[:known] / READ_AT)).argmin())
    regions = (_region(told, relative, centre) for centre in range(about, -1, -1))
    region = next((one for one in regions if one.stop - one.start >= LEAST_POINTS), None)
    if region is None:
        slope = np.gradient(np.log(found.deviation[:known]), np.log(found.taus[:known]))[about]
        raise BadSeries(
            f"{name}: the Allan deviation has slope {slope:.2f} at {found.taus[about]:g} s, and less than three points "
            "in a row on a slope of -0.5, that of white noise; fit the slow terms with it"
        )
    weights = _weights(relative, region)
    value = float(weights @ told[region])
    variance = float(weights @ relative[region, region] @ weights)
    return Density(value, value * variance**0.5, 2 / variance, region, float(told[about]))


def _region(told: Floats, relative: Floats, centre: int) -> slice:
    """The points about one that lie on a line of slope -1/2."""
    begin, end = centre, centre + 1
    grows = True
    while grows:
        grows = False
        if end < len(told) and _agrees(told, relative, begin, end, end):
            end, grows = end + 1, True
        if begin and _agrees(told, relative, begin, end, begin - 1):
            begin, grows = begin - 1, True
    return slice(begin, end)


def _weights(relative: Floats, region: slice) -> Floats:
    """Each point by how well it is known alone: best would be worse where a sensor is not quite as white as said."""
    weights = 1 / np.diag(relative)[region]
    scaled: Floats = weights / weights.sum()
    return scaled


def _agrees(told: Floats, relative: Floats, begin: int, end: int, candidate: int) -> bool:
    """Whether a point lies on the line of the region so far, within what white noise would scatter."""
    region = slice(begin, end)
    weights = _weights(relative, region)
    mean = weights @ told[region]
    variance = (
        relative[candidate, candidate]
        - 2 * weights @ relative[region, candidate]
        + weights @ relative[region, region] @ weights
    )
    return bool(abs(told[candidate] / mean - 1) < AGREE * variance**0.5)
