"""Search for the worst deviation of each arithmetic from float64 in the sensors' working range.

Working range: any roll and yaw; pitch between -90 and 90 degrees; no angle that wraps around between two frames; angle
rates up to the gyroscope's 2000 deg/s; linear acceleration up to the accelerometer's 2 g. The caller gives the
parameters of the sensors.

Search: samples are drawn uniformly from the range, and then ever closer to the worst sample of each sensor. The largest
error that is found is a lower bound of the true maximum. More samples improve this bound.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from ..host_frame import ACCELERATION, ANGLE
from ..models import parameters
from .frames import REFERENCE, SENSORS, Ints, codes_of

LIMITS = np.array([int(pi / ANGLE), int(pi / 2 / ANGLE), int(pi / ANGLE)])  # largest roll, pitch, yaw in counts
ROUNDS = 10  # number of refinements of the search


@dataclass(frozen=True)
class Worst:
    """The largest errors of an arithmetic in the working range.

    error: the largest error of each sensor before saturation and rounding, in LSB, by the name of the sensor.
    at: the inputs of the models that lead to this error, int64[12] in counts, by the name of the sensor. They are roll,
        pitch, yaw two samples ago, one sample ago and now, followed by the linear acceleration on x, y, z.
    """

    error: dict[str, float]
    at: dict[str, Ints]

    @property
    def largest(self) -> float:
        return max(self.error.values())

    def allowed(self) -> NDArray[np.float64]:
        """Return, for each axis, the largest difference between rounded codes to which `error` can lead, float64[9]."""
        return np.repeat([np.floor(self.error[name]) + 1 for name in SENSORS], 3)


def drawn(samples: int, seed: int, rate: float = 2000.0) -> Ints:
    """Draw the counts of random samples from the working range, int64[12, samples].

    rate: the largest rate of an angle in deg/s.
    """
    random = np.random.default_rng(seed)
    before = random.integers(-LIMITS[:, None], LIMITS[:, None], (3, samples), endpoint=True)
    most = int(np.radians(rate) * parameters.ImuParameters().period / ANGLE)
    last = _stepped(before, random.integers(-most, most, (3, samples), endpoint=True))
    now = _stepped(last, random.integers(-most, most, (3, samples), endpoint=True))
    g = int(parameters.AccelerometerParameters().full_scale / ACCELERATION)
    return np.concatenate([before, last, now, random.integers(-g, g, (3, samples), endpoint=True)])


def worst(
    arithmetic: str, imu: parameters.ImuParameters, samples: int = 2000, seed: int = 0, rate: float = 2000.0
) -> Worst:
    """Search for the largest errors of an arithmetic.

    The search tries random samples from the whole working range. Then it tries, ROUNDS times for each sensor, samples
    near the worst one so far, each time at smaller distances.

    arithmetic: the name of the arithmetic.
    samples: the number of samples drawn from the whole range. Each later step draws a quarter of this number.
    rate: the largest rate of an angle in deg/s.
    """
    counts = drawn(samples, seed, rate)
    random = np.random.default_rng(seed + 1)
    error: dict[str, float] = {}
    at: dict[str, Ints] = {}
    for place, name in enumerate(SENSORS):
        near = counts
        for around in range(ROUNDS + 1):
            off = _errors(arithmetic, imu, near)[3 * place : 3 * place + 3].max(axis=0)
            best = int(off.argmax())
            if name not in error or off[best] > error[name]:
                error[name], at[name] = float(off[best]), near[:, best]
            near = _around(at[name], random, samples // 4, 2000 >> around, rate)
    return Worst(error, at)


def _errors(arithmetic: str, imu: parameters.ImuParameters, counts: Ints) -> NDArray[np.float64]:
    exact = codes_of(REFERENCE, imu, counts).exact
    off: NDArray[np.float64] = np.abs(codes_of(arithmetic, imu, counts).exact - exact)
    return np.nan_to_num(off, nan=np.inf)


def _around(at: Ints, random: np.random.Generator, samples: int, reach: int, rate: float) -> Ints:
    """Draw samples near the sample `at`, within the working range.

    reach: the largest distance of a count from the same count of `at`.
    rate: as for `drawn`.
    """
    near = at[:, None] + random.integers(-reach, reach, (12, samples), endpoint=True)
    most = int(np.radians(rate) * parameters.ImuParameters().period / ANGLE)
    g = int(parameters.AccelerometerParameters().full_scale / ACCELERATION)
    before = np.clip(near[0:3], -LIMITS[:, None], LIMITS[:, None])
    last = _stepped(before, np.clip(near[3:6] - before, -most, most))
    now = _stepped(last, np.clip(near[6:9] - last, -most, most))
    return np.concatenate([before, last, now, np.clip(near[9:12], -g, g)])


def _stepped(counts: Ints, step: Ints) -> Ints:
    stepped: Ints = np.clip(counts + step, -LIMITS[:, None], LIMITS[:, None])
    return stepped
