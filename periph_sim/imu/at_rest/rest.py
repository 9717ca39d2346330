"""The sensors at rest: samples, and their expected mean and variance.

    Imu --> models + noise --> codes / scale --> samples       random
    Imu --> bias, S, Gaussian over the codes --> Expected      exact: rounding and saturation included

Dissertation section 5.2: level, pointing north, no acceleration, 10 000 samples at 50 Hz.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import erf, inf, isnan, sqrt
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..imu_noise import ImuNoise
from ..models.arrays import codes_of
from ..models.chips import Magnetometer
from ..models.parameters import (
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)
from ..noise import AXES
from ..numeric.float64 import Float64

Floats = NDArray[np.float64]
Sensor = AccelerometerParameters | GyroscopeParameters | MagnetometerParameters

SENSORS = ("accelerometer", "gyroscope", "magnetometer")
UNITS = {"accelerometer": "g", "gyroscope": "deg/s", "magnetometer": "gauss"}
FAR = 12.0  # codes further off than this multiple of sigma are ignored; their probability is below 1e-30


@dataclass(frozen=True)
class Expected:
    """Mean, variance and fourth central moment of one axis, in its unit."""

    mean: float
    variance: float
    fourth: float

    def mean_error(self, samples: int) -> float:
        """Return the standard error of the mean of this many samples."""
        return sqrt(self.variance / samples)

    def variance_error(self, samples: int) -> float:
        """Return the standard error of the variance of this many samples."""
        return sqrt((self.fourth - self.variance**2 * (samples - 3) / (samples - 1)) / samples)


def at_rest(imu: ImuParameters, samples: int, seed: int) -> dict[str, Floats]:
    """Return the samples of each sensor in its unit, shape (samples, 3)."""
    still = np.zeros(samples)
    codes = codes_of(imu, (still, still, still), (still, still, still), ImuNoise(imu, seed).values(0, samples))
    return {name: np.stack(getattr(codes, name), axis=1) / getattr(imu, name).scale for name in SENSORS}


def sensed_at_rest(imu: ImuParameters) -> dict[str, tuple[float, float, float]]:
    """Return the input of the matrix S of each sensor without noise, which is gravity or field plus bias."""
    accelerometer, gyroscope, magnetometer = imu.accelerometer, imu.gyroscope, imu.magnetometer
    x, y, z = accelerometer.bias
    north, east, down = (h + v for h, v in zip(magnetometer.earth_field, magnetometer.hard_iron, strict=True))
    on_board = Magnetometer(Float64(), magnetometer).on_board((north, east, down))
    return {"accelerometer": (x, y, z - 1.0), "gyroscope": gyroscope.bias, "magnetometer": on_board}


def expected_at_rest(imu: ImuParameters) -> dict[str, list[Expected]]:
    """Return the expectation of each axis with white noise alone.

    Bias instability and random walk have no fixed mean.
    """
    felt = sensed_at_rest(imu)
    return {name: _expected(getattr(imu, name), felt[name], imu.period) for name in SENSORS}


def variances_before_rounding(sensor: Sensor, period: float) -> Floats:
    """Return the variances of the three axes due to white noise after S, in LSB squared."""
    matrix = np.array(sensor.matrix)
    return matrix**2 @ (np.array(sensor.noise_density) / period)


def _expected(sensor: Sensor, felt: tuple[float, float, float], period: float) -> list[Expected]:
    means, variances = np.array(sensor.matrix) @ np.array(felt), variances_before_rounding(sensor, period)
    return [_of_codes(sensor, mean, sqrt(variance)) for mean, variance in zip(means, variances, strict=True)]


def _of_codes(sensor: Sensor, mean: float, sigma: float) -> Expected:
    """Return moments, in the sensor's unit, of a Gaussian (in LSB) after rounding and saturation."""
    if isnan(mean):
        return Expected(0.0, 0.0, 0.0)  # NaN has code 0 in float64, with or without noise
    least, most = sensor.limits
    reach = FAR * sigma + 2
    first, last = (int(np.clip(end, least, most)) for end in (mean - reach, mean + reach))
    ends = [_upper_end(sensor, code, least, most) for code in range(first - 1, last + 1)]
    share = np.diff([_below(end, mean, sigma) for end in ends])
    codes = np.arange(first, last + 1)
    values = codes / sensor.scale
    centre = float(share @ values)
    return Expected(centre, float(share @ (values - centre) ** 2), float(share @ (values - centre) ** 4))


def _upper_end(sensor: Sensor, code: int, least: int, most: int) -> float:
    """Return the value, in LSB, below which a converter returns at most this code."""
    if code < least:
        return -inf
    if code >= most:
        return inf
    if sensor.rounding == "nearest":
        return code + 0.5
    return code + 1.0 if sensor.rounding == "floor" or code >= 0 else float(code)


def _below(value: float, mean: float, sigma: float) -> float:
    if not sigma:
        return float(mean <= value)
    return (1 + erf((value - mean) / (sigma * sqrt(2)))) / 2


def write(samples: dict[str, Floats], imu: ImuParameters, path: Path) -> None:
    """Write samples as CSV: `time [s]`, then `gyroscope_x [deg/s]` and so on, with full precision."""
    titles = [f"{name}_{axis} [{UNITS[name]}]" for name in samples for axis in AXES]
    rows = np.hstack(list(samples.values())).tolist()
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(",".join(["time [s]", *titles]) + "\n")
        for number, row in enumerate(rows):
            file.write(",".join([f"{number * imu.period:.9g}", *map(repr, row)]) + "\n")
