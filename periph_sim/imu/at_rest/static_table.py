"""Table 5.1 from samples at rest: mean, 3 sigma and variance beside published and expected values.

ours, published --less expectation, in standard errors of 10 000 samples--> which differences chance explains
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, sqrt

import numpy as np
from numpy.typing import NDArray

from ..models.parameters import ImuParameters
from ..noise import AXES
from . import published
from .rest import SENSORS, Expected, expected_at_rest

Floats = NDArray[np.float64]

PRINTED = 1e-4 / sqrt(12)  # standard error of a number printed with four decimals


@dataclass(frozen=True)
class Figure:
    """One number of the table, in the sensor's unit. error, published_error: standard errors."""

    real: float
    emulator: float
    ours: float
    expected: float
    error: float
    published_error: float

    @property
    def ours_off(self) -> float | None:
        """Our value less the expected one, in standard errors; None if it is not random."""
        return (self.ours - self.expected) / self.error if self.error else None

    @property
    def emulator_off(self) -> float:
        """The published emulator's value less the expected one, in standard errors; printed with four decimals."""
        return (self.emulator - self.expected) / hypot(self.published_error, PRINTED)


@dataclass(frozen=True)
class AxisRow:
    """The table's figures for one axis."""

    sensor: str
    axis: str
    mean: Figure
    three_sigma: Figure
    variance: Figure


def static_table(imu: ImuParameters, samples: Mapping[str, Floats]) -> list[AxisRow]:
    """Return the nine rows for samples from `rest.at_rest` of this set."""
    expected = expected_at_rest(imu)
    return [
        _row(sensor, axis, samples[sensor][:, axis], expected[sensor][axis]) for sensor in SENSORS for axis in range(3)
    ]


def _row(sensor: str, axis: int, values: Floats, expected: Expected) -> AxisRow:
    variance, sigma = float(values.var(ddof=1)), sqrt(expected.variance)
    real, emulator = published.REAL[sensor], published.EMULATOR[sensor]
    means, variances = (
        [error(count) for count in (len(values), published.SAMPLES)]
        for error in (expected.mean_error, expected.variance_error)
    )
    sigmas = [3 * error / (2 * sigma) if sigma else 0.0 for error in variances]
    return AxisRow(
        sensor,
        AXES[axis],
        Figure(real.mean[axis], emulator.mean[axis], float(values.mean()), expected.mean, *means),
        Figure(real.three_sigma[axis], emulator.three_sigma[axis], 3 * sqrt(variance), 3 * sigma, *sigmas),
        Figure(real.variance[axis], emulator.variance[axis], variance, expected.variance, *variances),
    )
