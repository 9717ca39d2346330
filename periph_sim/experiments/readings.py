"""Why the published means of Table 5.1 are what they are: a parameter set goes in, four readings of it come out.

Each takes one thing more into account than the one before it, and is held against the published emulator's means.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot, sqrt
from typing import Any

from ..devices.models.parameters import Imu
from ..devices.noise import AXES
from . import published
from .rest import SENSORS, Expected, expected_at_rest
from .static_table import PRINTED


@dataclass(frozen=True)
class Reading:
    """One way to read the model: what it says, and the published emulator's means less its, in standard errors."""

    says: str
    off: dict[str, tuple[float, ...]]

    def rms(self, sensor: str) -> float:
        """Root mean square over the sensor's axes; 1 or so where chance explains it."""
        return sqrt(sum(off**2 for off in self.off[sensor]) / len(AXES))


def readings(imu: Imu) -> list[Reading]:
    """The published means against four readings of this set, each with one thing more taken into account."""
    return [Reading(says, _off(expected_at_rest(changed(imu)))) for says, changed in READINGS]


def _off(expected: Mapping[str, Sequence[Expected]]) -> dict[str, tuple[float, ...]]:
    return {
        sensor: tuple(
            (found - axis.mean) / hypot(axis.mean_error(published.SAMPLES), PRINTED, PRINTED)  # theirs, and the bias
            for found, axis in zip(published.EMULATOR[sensor].mean, expected[sensor], strict=True)
        )
        for sensor in SENSORS
    }


def _each(imu: Imu, **changes: Any) -> Imu:
    changed: dict[str, Any] = {sensor: replace(getattr(imu, sensor), **changes) for sensor in SENSORS}
    return replace(imu, **changed)


def without_cross_axis(imu: Imu) -> Imu:
    """Each axis tells itself only."""
    return _each(imu, cross_axis=0.0)


def with_printed_means(imu: Imu) -> Imu:
    """The biases as the real IMU's means in Table 5.1 have them, to four decimals; Table 4.1 rounds them to two."""
    x, y, z = published.REAL["accelerometer"].mean
    return replace(
        imu,
        accelerometer=replace(imu.accelerometer, bias=(x, y, z + 1.0)),
        gyroscope=replace(imu.gyroscope, bias=published.REAL["gyroscope"].mean),
    )


def with_floor(imu: Imu) -> Imu:
    """The same, and codes cut off towards minus infinity, as a shift of a fixed-point number does."""
    return _each(with_printed_means(imu), rounding="floor")


READINGS: list[tuple[str, Callable[[Imu], Imu]]] = [
    ("bias of Table 4.1 alone", without_cross_axis),
    ("and cross-axis sensitivity", lambda imu: imu),
    ("and bias to four decimals", with_printed_means),
    ("and codes rounded down", with_floor),
]
