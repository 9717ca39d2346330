"""Readings of a sensor head as arrays: samples in deg/s, g and gauss, with one row per round.

    SensorHead --transfers--> SampleLog --> Samples: seconds, gyro, accel, mag

The scales are those that the start-up requests in `sensors.SENSORS` select.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bus.i2c.transfer import Transfer
from ..devices.sensor_head import SensorHead
from ..devices.sensor_rounds import Round
from .models.parameters import ImuParameters
from .rotations import Floats
from .sensors import SENSORS

Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Samples:
    """Samples of the three chips, with one row for each round in which all three were read.

    seconds: the times at which the rounds are due, counted from the start of the run, float64[n].
    gyro: the samples of the gyroscope in deg/s, float64[n, 3].
    accel: the samples of the accelerometer in g, float64[n, 3].
    mag: the samples of the magnetometer in gauss, float64[n, 3]. Values that the chip reported as overflows are NaN.
    """

    seconds: Floats
    gyro: Floats
    accel: Floats
    mag: Floats


@dataclass(frozen=True)
class Readings:
    """Codes of the three chips, with one row per round.

    seconds: the times at which the rounds are due, float64[n].
    codes: the codes of each chip on x, y, z, int64[n, 3], by the name of the chip.
    lsb_per_unit: the number of LSB per unit (deg/s, g or gauss) of each chip, by the name of the chip.
    overflow: the code with which the magnetometer reports an overflow; None if there is no such code.
    """

    seconds: Floats
    codes: dict[str, Ints]
    lsb_per_unit: dict[str, float]
    overflow: int | None = None

    def in_units(self) -> dict[str, Floats]:
        """Return the values in deg/s, g and gauss, by the name of the chip. A value with an overflow is NaN."""
        found = {name: codes / self.lsb_per_unit[name] for name, codes in self.codes.items()}
        if self.overflow is not None:
            found["magnetometer"][self.codes["magnetometer"] == self.overflow] = np.nan
        return found

    def samples(self, imu: ImuParameters) -> Samples:
        """Return the readings in deg/s, g and gauss, in the body's axes.

        Cross-axis sensitivity, biases and hard iron, as given by the parameters `imu`, are removed. If one axis of the
        magnetometer has an overflow, all three values of this sample are NaN.
        """
        found = {}
        for name, values in self.in_units().items():
            sensor = getattr(imu, name)
            known = sensor.hard_iron if name == "magnetometer" else sensor.bias
            # A NaN on one axis makes all three values NaN.
            found[name] = np.linalg.solve(np.array(sensor.matrix) / sensor.scale, values.T).T - known
        mounted = found["gyroscope"]
        body = np.empty_like(mounted)
        for column, axis in enumerate(imu.gyroscope.mounting):
            body[:, abs(int(axis)) - 1] = np.sign(axis) * mounted[:, column]
        return Samples(self.seconds, body, found["accelerometer"], found["magnetometer"])


class SampleLog:
    """Log of the readings of a sensor head, from the creation of the log on.

    Rounds in which the six data bytes of a chip were not read are left out.

    start: the tick of time 0.
    ticks: the number of ticks per second.
    """

    def __init__(self, head: SensorHead, start: int, ticks: int) -> None:
        self._start = start
        self._ticks = ticks
        self._due = array("q")
        self._counts = {name: array("h") for name in SENSORS}
        self._round: dict[str, tuple[int, ...]] = {}
        head.on_transfer.append(self._transfer)
        head.on_round.append(self._round_over)

    def readings(self) -> Readings:
        """Return the codes of all samples so far."""
        seconds = (np.array(self._due, np.int64) - self._start) / self._ticks
        codes = {name: np.array(counts, np.int64).reshape(-1, 3) for name, counts in self._counts.items()}
        scales = {name: float(chip.lsb_per_unit) for name, chip in SENSORS.items()}
        return Readings(seconds, codes, scales, SENSORS["magnetometer"].overflow)

    def samples(self) -> Samples:
        """Return all samples so far, in the axes of the chips and with biases."""
        readings = self.readings()
        found = readings.in_units()
        return Samples(readings.seconds, found["gyroscope"], found["accelerometer"], found["magnetometer"])

    def _transfer(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            for name, chip in SENSORS.items():
                if phase.read and phase.address == chip.address and len(phase.got) == 6:
                    self._round[name] = chip.values(bytes(phase.got))

    def _round_over(self, over: Round) -> None:
        found, self._round = self._round, {}
        if len(found) == len(SENSORS):
            self._due.append(over.due)
            for name, values in found.items():
                self._counts[name].extend(values)
