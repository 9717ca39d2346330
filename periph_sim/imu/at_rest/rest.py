"""The sensors at rest: samples, and their expected mean and variance.

    Imu --> values at rest + S * noise --> codes / scale --> samples               random
    Imu --> values at rest --> probability of each code for Gaussian noise --> ExpectedMoments

ExpectedMoments include rounding and saturation. Only codes whose probability is below 1e-30 are ignored (see FAR).

The models add noise just before the matrix S, which is linear. So the models are evaluated once without noise, and S
times the noise is added to the result.

Dissertation section 5.2: level, pointing north, no acceleration, 10 000 samples at 50 Hz.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import erf, inf, isnan, sqrt
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..models.imu import Imu, Inputs
from ..models.parameters import (
    NONE,
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)
from ..noise import AXES, ImuNoise
from ..numeric.arithmetic import Rounding, Triple
from ..numeric.float64 import Float64

Floats = NDArray[np.float64]
Sensor = AccelerometerParameters | GyroscopeParameters | MagnetometerParameters

SENSORS = ("accelerometer", "gyroscope", "magnetometer")
UNITS = {"accelerometer": "g", "gyroscope": "deg/s", "magnetometer": "gauss"}
ROUNDED: dict[Rounding, Callable[[Floats], Floats]] = {
    "nearest": lambda lsb: np.floor(lsb + 0.5),
    "floor": np.floor,
    "toward zero": np.trunc,
}
FAR = 12.0  # codes at more than this multiple of sigma from the mean are ignored; their probability is below 1e-30


@dataclass(frozen=True)
class ExpectedMoments:
    """Expected moments of the samples of one axis. `unit` is the unit of the sensor.

    mean: in unit.
    variance: in unit^2.
    fourth: the fourth central moment, in unit^4.
    """

    mean: float
    variance: float
    fourth: float

    def mean_error(self, samples: int) -> float:
        """Return the standard error of the mean. samples: the number of samples."""
        return sqrt(self.variance / samples)

    def variance_error(self, samples: int) -> float:
        """Return the standard error of the variance. samples: the number of samples."""
        return sqrt((self.fourth - self.variance**2 * (samples - 3) / (samples - 1)) / samples)


def at_rest(imu: ImuParameters, samples: int, seed: int) -> dict[str, Floats]:
    """Return the samples of each sensor in its unit, float64[samples, 3], by the name of the sensor.

    samples: the number of samples.
    seed: the seed of the noise.
    """
    noise, still = ImuNoise(imu, seed).values(0, samples), lsb_at_rest(imu)
    found = {}
    for name in SENSORS:
        sensor: Sensor = getattr(imu, name)
        lsb = still[name] + np.stack(getattr(noise, name), axis=1) @ np.array(sensor.matrix).T
        codes = ROUNDED[sensor.rounding](lsb.clip(*sensor.limits))
        found[name] = np.nan_to_num(codes, nan=0.0) / sensor.scale
    return found


def lsb_at_rest(imu: ImuParameters, attitude: Triple[float] = NONE) -> dict[str, Triple[float]]:
    """Return x, y, z of each sensor at rest, in LSB, by the sensor's name, before noise, saturation and rounding.

    attitude: roll, pitch, yaw in rad.
    """
    model = Imu(Float64(), imu)
    turned, body = model.motion(attitude, attitude)
    inputs = Inputs(turned, NONE, body, NONE, model.silence)
    return {name: model.lsb_of(name, inputs) for name in SENSORS}


def expected_at_rest(imu: ImuParameters) -> dict[str, list[ExpectedMoments]]:
    """Return the expected moments of the three axes of each sensor, by the name of the sensor.

    The only noise is white noise, because bias instability and random walk have no fixed mean.
    """
    found = {}
    for name, means in lsb_at_rest(imu).items():
        sensor: Sensor = getattr(imu, name)
        variances = variances_before_rounding(sensor, imu.period)
        found[name] = [_of_codes(sensor, mean, sqrt(one)) for mean, one in zip(means, variances, strict=True)]
    return found


def variances_before_rounding(sensor: Sensor, period: float) -> Floats:
    """Return the variances that white noise causes on the three axes after the matrix S, in LSB squared.

    period: Ts in seconds.
    """
    matrix = np.array(sensor.matrix)
    return matrix**2 @ (np.array(sensor.noise_density) / period)


def _of_codes(sensor: Sensor, mean: float, sigma: float) -> ExpectedMoments:
    """Return the moments, in the sensor's unit, of a Gaussian value after rounding and saturation.

    mean, sigma: the mean and the standard deviation of the Gaussian value in LSB.
    """
    if isnan(mean):
        return ExpectedMoments(0.0, 0.0, 0.0)  # For a NaN, a converter in float64 always returns code 0.
    least, most = sensor.limits
    reach = FAR * sigma + 2
    first, last = (int(np.clip(end, least, most)) for end in (mean - reach, mean + reach))
    ends = [_upper_end(sensor, code, least, most) for code in range(first - 1, last + 1)]
    share = np.diff([_below(end, mean, sigma) for end in ends])
    codes = np.arange(first, last + 1)
    values = codes / sensor.scale
    centre = float(share @ values)
    return ExpectedMoments(centre, float(share @ (values - centre) ** 2), float(share @ (values - centre) ** 4))


def _upper_end(sensor: Sensor, code: int, least: int, most: int) -> float:
    """Return the value, in LSB, up to which a converter returns this code or a lower code.

    The result is -inf below the lowest code, and inf for the highest code, because the converter saturates.

    least, most: the converter's lowest and highest code.
    """
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
    """Write samples as CSV: `time [s]`, and columns such as `gyroscope_x [deg/s]` with full precision."""
    titles = [f"{name}_{axis} [{UNITS[name]}]" for name in samples for axis in AXES]
    rows = np.hstack(list(samples.values())).tolist()
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(",".join(["time [s]", *titles]) + "\n")
        for number, row in enumerate(rows):
            file.write(",".join([f"{number * imu.period:.9g}", *map(repr, row)]) + "\n")
