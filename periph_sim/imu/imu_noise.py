"""The noise of a whole IMU by sample number, as added before the scale S.

Imu, seed --> values(first, count), at(n) --> Noise: deg/s, g and gauss on x, y, z
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .models.imu import Noise
from .models.parameters import AccelerometerParameters, GyroscopeParameters, ImuParameters, MagnetometerParameters
from .noise import NoiseTerms, SensorNoise

if TYPE_CHECKING:
    from .noise import Floats


class ImuNoise:
    """Noise of the three sensors. Sample n is the same in `values` and in `at`, to the last bit."""

    def __init__(self, imu: ImuParameters, seed: int) -> None:
        self._gyroscope, self._accelerometer, self._magnetometer = (
            SensorNoise(_terms(getattr(imu, name)), imu.period, seed, name) for name in Noise._fields
        )

    def values(self, first: int, count: int) -> Noise[Floats]:
        """Return samples `first` up to `first + count - 1`: nine float64[count]."""
        return Noise(
            _columns(self._gyroscope.values(first, count)),
            _columns(self._accelerometer.values(first, count)),
            _columns(self._magnetometer.values(first, count)),
        )

    def at(self, number: int) -> Noise[float]:
        """Return one sample."""
        return Noise(self._gyroscope.at(number), self._accelerometer.at(number), self._magnetometer.at(number))

    def near(self, number: int) -> Noise[tuple[float, float]] | None:
        """Return one sample as values with their maximum errors, without numpy; None if that needs numpy."""
        chips = []
        for chip in (self._gyroscope, self._accelerometer, self._magnetometer):
            axes = chip.near(number)
            if axes is None:
                return None
            x, y, z = axes
            chips.append((x, y, z))
        return Noise(*chips)


def _terms(sensor: GyroscopeParameters | AccelerometerParameters | MagnetometerParameters) -> list[NoiseTerms]:
    columns = zip(sensor.noise_density, sensor.bias_instability, sensor.random_walk, strict=True)
    return [NoiseTerms(*terms) for terms in columns]


def _columns(values: Floats) -> tuple[Floats, Floats, Floats]:
    return values[:, 0], values[:, 1], values[:, 2]
