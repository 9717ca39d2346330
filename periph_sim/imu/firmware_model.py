"""Firmware that computes the sensors, as a `scene.unit.FirmwareModel` for the scene.

settings with sensors, arithmetic, noise_seed --firmware_model--> ImuFirmware
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property, lru_cache
from math import atan2, cos, degrees, hypot, sin
from typing import TYPE_CHECKING, Any

from ..scene.case.model import Case
from .models.parameters import ImuParameters
from .models.quantity import BadParameter

if TYPE_CHECKING:
    from ..devices.chip_model import ChipModel
    from ..devices.truth import Axes
    from .motion import Motion


class ImuFirmware:
    """A `FirmwareModel` of firmware that computes the sensors of an IMU.

    settings: the settings of the firmware. Its `arithmetic` and `noise_seed` determine the results.
    """

    def __init__(self, parameters: ImuParameters, settings: object) -> None:
        self.parameters = parameters
        self._settings = settings
        arithmetic: object = getattr(settings, "arithmetic", None)
        self._arithmetic = arithmetic if isinstance(arithmetic, str) else None
        self._noise_seed: Any = getattr(settings, "noise_seed", None)

    def check(self, case: Case, unit: str) -> None:
        """Raise BadCase unless the models' period is the period at which this firmware runs them.

        This is the period of the host if `models_run` is "frame" or there are no rounds; otherwise that of the rounds.
        """
        rounds = case.controller or case.rounds
        per_frame = getattr(self._settings, "models_run", "round") == "frame" or rounds is None
        table = case.host if per_frame else rounds
        if table is None:
            return
        per_round = f"once a round ({'controller' if case.rounds is None else 'rounds'}.period)"
        try:
            self.parameters.check_period(table.period, "once a host frame (host.period)" if per_frame else per_round)
        except BadParameter as error:
            raise case.mistake(error.what, "unit", unit, "settings", "parameters") from None

    def codes(self) -> ChipModel | None:
        """Return the model of the chips' bytes; None if no setting names the arithmetic."""
        if self._arithmetic is None:
            return None
        from .model_codes import model_codes

        return model_codes(self.parameters, self._arithmetic, self._noise_seed)

    def truth(self, motion: Motion, first: Fraction) -> MotionTruth:
        """Return the true values of a motion. first: the time of the motion, in seconds, at which frame 0 is due."""
        return MotionTruth(self.parameters, motion, first)

    def attitude(self, readings: Mapping[str, Sequence[float]]) -> list[float] | None:
        """Return roll, pitch, yaw of the resting body in degrees; None before accelerometer and magnetometer were read.

        readings: x, y, z of each chip in its unit. The known errors of the sensors are subtracted.
        """
        accel, mag, sensors = readings.get("accelerometer"), readings.get("magnetometer"), self.parameters
        if accel is None or mag is None:
            return None
        gravity = _less(accel, sensors.accelerometer.bias)
        field = _less(mag, sensors.magnetometer.hard_iron)
        return [*resting_attitude(gravity, field, sensors.magnetometer.earth_field)]


def firmware_model(settings: object) -> ImuFirmware | None:
    """Return the model of a firmware with these settings; None if its `sensors` are not those of an IMU."""
    sensors: object = getattr(settings, "sensors", None)
    return ImuFirmware(sensors, settings) if isinstance(sensors, ImuParameters) else None


def _less(values: Sequence[float], bias: Sequence[float]) -> list[float]:
    return [value - known for value, known in zip(values, bias, strict=True)]


class MotionTruth:
    """The readings of the true motion by ideal sensors with the same parameters, in float64.

    They have no noise: the noise of a sensor is not a property of the body, and the sample that a read contains depends
    on the timing of the firmware, from which the truth is independent.

    first: the time of the motion, in seconds, at which frame 0 is due.
    """

    KEPT = 64  # number of cached instants; each is used for several chips and budgets

    def __init__(self, imu: ImuParameters, motion: Motion, first: Fraction) -> None:
        self._imu = imu
        self._motion = motion
        self._first = first

    @cached_property
    def at(self) -> Callable[[Fraction], Mapping[str, Axes]]:
        """Return a function from time to the readings of each chip.

        It is built at its first use, since few runs need it.
        """
        from .models.sensed_motion import SensedMotion

        felt = SensedMotion(self._imu, self._motion)
        return lru_cache(self.KEPT)(lambda seconds: felt.at(float(self._first + seconds)))


def resting_attitude(
    accel: Sequence[float], mag: Sequence[float], field: Sequence[float]
) -> tuple[float, float, float]:
    """Return roll, pitch, yaw in degrees of a resting body, from one sample of accelerometer and magnetometer.

        gravity --> roll, pitch --turn the field level--> yaw

    An accelerometer that is at rest and level, with z down, reads (0, 0, -1 g). `attitude` has a filter that tolerates
    motion.

    field: the north and east components of the magnetic field at the body.
    """
    x, y, z = (-value for value in accel)
    roll, pitch = atan2(y, z), atan2(-x, hypot(y, z))
    mx, my, mz = mag
    down = my * sin(roll) + mz * cos(roll)
    north, west = mx * cos(pitch) + down * sin(pitch), my * cos(roll) - mz * sin(roll)
    yaw = (degrees(atan2(-west, north) + atan2(field[1], field[0])) + 180) % 360 - 180
    return degrees(roll), degrees(pitch), yaw
