"""Table 5.1 again: samples at rest go in; mean, 3 sigma and variance beside the published ones and what they must be.

ours, published --less expectation, in standard errors of 10 000 samples--> what chance explains and what it does not
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, sqrt

import numpy as np
from numpy.typing import NDArray

from ...sensors.models.parameters import ImuParameters
from ...sensors.noise import AXES
from . import published
from .rest import SENSORS, Expected, expected_at_rest

Floats = NDArray[np.float64]

PRINTED = 1e-4 / sqrt(12)  # standard error of a figure printed with four decimals


@dataclass(frozen=True)
class Figure:
    """One number of the table, in the sensor's unit. error, published_error: standard errors of ours and theirs."""

    real: float
    emulator: float
    ours: float
    expected: float
    error: float
    published_error: float

    @property
    def ours_off(self) -> float | None:
        """Ours less what the model expects, in standard errors; None where nothing is left to chance."""
        return (self.ours - self.expected) / self.error if self.error else None

    @property
    def emulator_off(self) -> float:
        """The published emulator's less what our model expects, in standard errors; printed with four decimals."""
        return (self.emulator - self.expected) / hypot(self.published_error, PRINTED)


@dataclass(frozen=True)
class AxisRow:
    """What the table says of one axis."""

    sensor: str
    axis: str
    mean: Figure
    three_sigma: Figure
    variance: Figure


def static_table(imu: ImuParameters, samples: Mapping[str, Floats]) -> list[AxisRow]:
    """The nine rows for what `rest.at_rest` gave of this set."""
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
