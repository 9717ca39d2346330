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
from .rotations import Floats
from .sensors import SENSORS


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


def in_units(chip: ChipData, counts: ArrayLike) -> Floats:
    """Convert int[n, 3] counts to float64[n, 3] in deg/s, g or gauss."""
    raw = np.asarray(counts, np.float64)
    values = raw / float(chip.lsb_per_unit)
    return values if chip.overflow is None else np.where(raw == chip.overflow, np.nan, values)


class SampleLog:
    """Log of a head's readings from its creation on. start: the tick of time 0; ticks: ticks a second.

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

    def counts(self) -> dict[str, NDArray[np.int64]]:
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
