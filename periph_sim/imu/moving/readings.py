"""Readings of a sensor head: codes of three chips per round, and conversion to units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..attitude import estimate
from ..models.parameters import ImuParameters
from ..rotations import Floats, quaternions
from ..samples import Samples
from .subject import EmulatorUnderTest

Ints = NDArray[np.int64]
NAMES = ("gyroscope", "accelerometer", "magnetometer")  # in the order of Samples


@dataclass(frozen=True)
class Readings:
    """One row per round. seconds: float64[n], due times. codes: by chip, int64[n, 3], x, y, z.

    lsb_per_unit: by chip. overflow: the magnetometer's code for an invalid value, if it has one.
    """

    seconds: Floats
    codes: dict[str, Ints]
    lsb_per_unit: dict[str, float]
    overflow: int | None = None

    def samples(self, imu: ImuParameters) -> Samples:
        """Convert to deg/s, g and gauss of the body, without cross-axis sensitivity, known biases and hard iron."""
        found = {}
        for name, codes in self.codes.items():
            sensor = getattr(imu, name)
            values = codes / self.lsb_per_unit[name]
            if name == "magnetometer" and self.overflow is not None:
                values[(codes == self.overflow).any(axis=1)] = np.nan
            known = sensor.hard_iron if name == "magnetometer" else sensor.bias
            found[name] = np.linalg.solve(np.array(sensor.matrix) / sensor.scale, values.T).T - known
        mounted = found["gyroscope"]
        body = np.empty_like(mounted)
        for column, axis in enumerate(imu.gyroscope.mounting):
            body[:, abs(int(axis)) - 1] = np.sign(axis) * mounted[:, column]
        return Samples(self.seconds, body, found["accelerometer"], found["magnetometer"])


def attitudes(subject: EmulatorUnderTest, readings: Readings) -> Floats:
    """Filter the readings, from the true attitude on, as the experiment began at 0: float64[n, 4]."""
    s = readings.samples(subject.sensors)
    start = truth(subject, readings.seconds[:1])[0] if len(readings.seconds) else None
    return estimate(s.seconds, s.gyro, s.accel, s.mag, subject.sensors.magnetometer.earth_field, start=start)


def truth(subject: EmulatorUnderTest, seconds: Floats) -> Floats:
    """Return the true attitude: float64[n, 4]."""
    return quaternions(subject.motion.attitude(seconds))
