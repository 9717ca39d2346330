"""Readings of a sensor head as arrays: samples in deg/s, g and gauss, with one row per round.

    SensorHead --transfers--> SampleLog --> Samples: seconds, gyro, accel, mag

The scales are those that the start-up requests in `sensors.SENSORS` select.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bus.i2c.transfer import Transfer
from ..devices.sensor_head import SensorHead
from ..devices.sensor_rounds import ChipData, Round
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

    def samples(self, imu: ImuParameters) -> Samples:
        """Return the readings in deg/s, g and gauss, in the body's axes.

        Cross-axis sensitivity, biases and hard iron, as given by the parameters `imu`, are removed. If one axis of the
        magnetometer has an overflow, all three values of this sample are NaN.
        """
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


def in_units(chip: ChipData, counts: ArrayLike) -> Floats:
    """Convert the codes of a chip, int[n, 3], to deg/s, g or gauss, float64[n, 3]. An overflow code becomes NaN."""
    raw = np.asarray(counts, np.float64)
    values = raw / float(chip.lsb_per_unit)
    return values if chip.overflow is None else np.where(raw == chip.overflow, np.nan, values)


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

    def samples(self) -> Samples:
        """Return all samples so far."""
        seconds = (np.array(self._due, np.int64) - self._start) / self._ticks
        counts = self.counts()
        gyro, accel, mag = (
            in_units(SENSORS[name], counts[name]) for name in ("gyroscope", "accelerometer", "magnetometer")
        )
        return Samples(seconds, gyro, accel, mag)

    def counts(self) -> dict[str, Ints]:
        """Return the codes of all samples so far, int64[n, 3], by the name of the chip."""
        return {name: np.array(counts, np.int64).reshape(-1, 3) for name, counts in self._counts.items()}

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
