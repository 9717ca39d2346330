"""Arrays of a sensor head's readings: samples in deg/s, g and gauss, round by round.

    SensorHead --transfers--> SampleLog --> Samples: seconds, gyro, accel, mag

Source: scales as set up by the drivers, `sensors.SENSORS`.
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
    """One row for each round in which all three chips answered.

    seconds: float64[n], the round's due time, from the start of the run. gyro, accel, mag: float64[n, 3] in
    deg/s, g, gauss; NaN for a chip's overflow code.
    """

    seconds: Floats
    gyro: Floats
    accel: Floats
    mag: Floats


@dataclass(frozen=True)
class Readings:
    """Codes of three chips, one row per round. seconds: float64[n], due times. codes: by chip, int64[n, 3], x, y, z.

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


def in_units(chip: ChipData, counts: ArrayLike) -> Floats:
    """Convert int[n, 3] counts to float64[n, 3] in deg/s, g or gauss."""
    raw = np.asarray(counts, np.float64)
    values = raw / float(chip.lsb_per_unit)
    return values if chip.overflow is None else np.where(raw == chip.overflow, np.nan, values)


class SampleLog:
    """Log of a head's readings from its creation on. start: the tick of time 0; ticks: ticks per second.

    chips: by name as in SENSORS, if their scale differs from their driver's.
    """

    def __init__(self, head: SensorHead, start: int, ticks: int, chips: dict[str, ChipData] | None = None) -> None:
        self._chips = SENSORS | (chips or {})
        self._start = start
        self._ticks = ticks
        self._due = array("q")
        self._counts = {name: array("h") for name in self._chips}
        self._round: dict[str, tuple[int, ...]] = {}
        head.on_transfer.append(self._transfer)
        head.on_round.append(self._round_over)

    def samples(self) -> Samples:
        """Return all samples so far."""
        seconds = (np.array(self._due, np.int64) - self._start) / self._ticks
        counts = self.counts()
        gyro, accel, mag = (
            in_units(self._chips[name], counts[name]) for name in ("gyroscope", "accelerometer", "magnetometer")
        )
        return Samples(seconds, gyro, accel, mag)

    def counts(self) -> dict[str, Ints]:
        """Return all samples so far as raw counts: by chip, int64[n, 3]."""
        return {name: np.array(counts, np.int64).reshape(-1, 3) for name, counts in self._counts.items()}

    def _transfer(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            for name, chip in self._chips.items():
                if phase.read and phase.address == chip.address and len(phase.got) == 6:
                    self._round[name] = chip.values(bytes(phase.got))

    def _round_over(self, over: Round) -> None:
        found, self._round = self._round, {}
        if len(found) == len(self._chips):
            self._due.append(over.due)
            for name, values in found.items():
                self._counts[name].extend(values)
