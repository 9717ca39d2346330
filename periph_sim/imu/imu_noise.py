"""The noise of a whole IMU by sample number, as added before the scale S.

Imu, seed --> values(first, count), at(n) --> Noise: deg/s, g and gauss on x, y, z
"""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, Any

from .models.imu import Noise
from .models.parameters import ImuParameters
from .noise import AXES, AxisNoise, NoiseTerms

if TYPE_CHECKING:
    from .noise import Floats


class ImuNoise:
    """Noise of the three sensors. Sample n is the same in `values` and in `at`, to the last bit."""

    def __init__(self, imu: ImuParameters, seed: int) -> None:
        self._sensors = [_axes_of(name, getattr(imu, name), imu.period, seed) for name in Noise._fields]

    def values(self, first: int, count: int) -> Noise[Floats]:
        """Return samples `first` up to `first + count - 1`: nine float64[count]."""
        sensors = ([axis.values(first, count) for axis in axes] for axes in self._sensors)
        return Noise(*((x, y, z) for x, y, z in sensors))

    def at(self, number: int) -> Noise[float]:
        """Return the noise of sample `number`."""
        sensors = ([axis.at(number) for axis in axes] for axes in self._sensors)
        return Noise(*((x, y, z) for x, y, z in sensors))

    def near(self, number: int) -> list[tuple[float, float]] | None:
        """Return the nine values of a sample with their maximum errors; None if this is impossible without numpy."""
        found = []
        for axis in chain(*self._sensors):
            value = axis.near(number)
            if value is None:
                return None
            found.append(value)
        return found


def _axes_of(name: str, sensor: Any, period: float, seed: int) -> list[AxisNoise]:
    columns = zip(AXES, sensor.noise_density, sensor.bias_instability, sensor.random_walk, strict=True)
    return [AxisNoise(NoiseTerms(*terms), period, seed, f"{name}/{axis}") for axis, *terms in columns]
