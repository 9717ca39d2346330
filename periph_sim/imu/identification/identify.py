"""Identification of one axis of a sensor at rest: bias, noise density, and optionally the slow terms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .allan import Allan, allan
from .density import Density, density
from .mean import Mean, mean
from .series import BadSeries, Series, series
from .slow_terms import SlowTerms, slow_terms, white_part

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
    BadSeries if nothing can be identified: too few samples, NaN, a constant.
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
