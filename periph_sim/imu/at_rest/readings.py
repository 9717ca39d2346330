"""Interpretations of the parameters, compared with the emulated means of Table 5.1.

Each reading adds one effect to the previous one; the last but one is the shipped set `table_5_1`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Any

from msgspec.structs import replace

from ..models.parameters import NONE, ImuParameters
from ..noise import AXES
from . import published
from .rest import SENSORS, Expected, expected_at_rest
from .static_table import PRINTED


@dataclass(frozen=True)
class Reading:
    """An interpretation of the parameters. off: published emulator's means less its own, in standard errors."""

    says: str
    off: dict[str, tuple[float, ...]]

    def rms(self, sensor: str) -> float:
        """Return the root mean square over the sensor's axes; about 1 if explained by chance."""
        return sqrt(sum(off**2 for off in self.off[sensor]) / len(AXES))


def readings() -> list[Reading]:
    """Compare the published means with each reading."""
    return [Reading(says, _off(expected_at_rest(imu()))) for says, imu in READINGS]


def _off(expected: Mapping[str, Sequence[Expected]]) -> dict[str, tuple[float, ...]]:
    return {
        sensor: tuple(
            (found - axis.mean) / hypot(axis.mean_error(published.SAMPLES), PRINTED, PRINTED)  # of mean and bias
            for found, axis in zip(published.EMULATOR[sensor].mean, expected[sensor], strict=True)
        )
        for sensor in SENSORS
    }


def _each(imu: ImuParameters, sensors: Sequence[str] = SENSORS, **changes: Any) -> ImuParameters:
    changed: dict[str, Any] = {sensor: replace(getattr(imu, sensor), **changes) for sensor in sensors}
    return replace(imu, **changed)


def table_4_1() -> ImuParameters:
    """Table 4.1 without hard iron: Table 5.1 was measured away from iron (section 5.2)."""
    return _each(ImuParameters(), ("magnetometer",), hard_iron=NONE)


def without_cross_axis() -> ImuParameters:
    """The same without cross-axis sensitivity."""
    return _each(table_4_1(), cross_axis=0.0)


def with_printed_means() -> ImuParameters:
    """The same with biases to four decimals from the real IMU's means in Table 5.1; Table 4.1 rounds to two."""
    imu = table_4_1()
    x, y, z = published.REAL["accelerometer"].mean
    return replace(
        imu,
        accelerometer=replace(imu.accelerometer, bias=(x, y, round(z + 1.0, 4))),
        gyroscope=replace(imu.gyroscope, bias=published.REAL["gyroscope"].mean),
    )


def with_floor() -> ImuParameters:
    """The same with codes of accelerometer and magnetometer rounded down, like a shift of a fixed-point number."""
    return _each(with_printed_means(), ("accelerometer", "magnetometer"), rounding="floor")


def with_floor_everywhere() -> ImuParameters:
    return _each(with_printed_means(), rounding="floor")


READINGS: list[tuple[str, Callable[[], ImuParameters]]] = [
    ("bias of Table 4.1 alone", without_cross_axis),
    ("and cross-axis sensitivity", table_4_1),
    ("and bias to four decimals", with_printed_means),
    ("and floor for two: table_5_1", with_floor),
    ("and floor for the gyroscope", with_floor_everywhere),
]
