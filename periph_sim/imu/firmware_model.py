"""Firmware that computes the sensors: what a scene asks it about (`scene.unit.FirmwareModel`).

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
    """A `FirmwareModel`. settings: of the firmware; its `arithmetic` and `noise_seed` say how it computes."""

    def __init__(self, parameters: ImuParameters, settings: object) -> None:
        self.parameters = parameters
        self._settings = settings
        arithmetic: object = getattr(settings, "arithmetic", None)
        self._arithmetic = arithmetic if isinstance(arithmetic, str) else None
        self._noise_seed: Any = getattr(settings, "noise_seed", None)

    def check(self, case: Case, unit: str) -> None:
        """Raise BadCase unless the models' period is that at which this firmware runs them.

        That is the period of the rounds; or of the host, if `models_run` is "frame" or there are no rounds.
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
        """Return the model of the chips' bytes; None if no setting says its arithmetic."""
        if self._arithmetic is None:
            return None
        from .model_codes import ModelCodes

        return ModelCodes(self.parameters, self._arithmetic, self._noise_seed)

    def truth(self, motion: Motion, first: Fraction) -> MotionTruth:
        """Return the true values. first: seconds of the motion's time at which frame 0 is due."""
        return MotionTruth(self.parameters, motion, first)

    def attitude(self, readings: Mapping[str, Sequence[float]]) -> list[float] | None:
        """Return roll, pitch, yaw of the resting body in degrees; None before accelerometer and magnetometer were read.

        readings: by chip, x, y, z in its unit. The known errors of the sensors are subtracted.
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
    """The readings of ideal sensors with the same parameters, of the true motion, in float64.

    It has no noise: a sensor's noise is not a property of the body, and the sample in a read depends on the firmware's
    timing, of which truth is independent. first: seconds of the motion's time at which frame 0 is due.
    """

    KEPT = 64  # cached instants: each is used for several chips and budgets

    def __init__(self, imu: ImuParameters, motion: Motion, first: Fraction) -> None:
        self._imu = imu
        self._motion = motion
        self._first = first

    @cached_property
    def at(self) -> Callable[[Fraction], Mapping[str, Axes]]:
        """Return the readings by chip as a function of time. Built on first use, which few runs need."""
        import numpy as np

        from .models.sensed_motion import SensedMotion  # computes arrays

        felt = SensedMotion(self._imu, self._motion)

        def at(seconds: Fraction) -> Mapping[str, Axes]:
            values = felt.lsb(np.array([float(self._first + seconds)]))
            return {chip: tuple(axes[0].tolist()) for chip, axes in values.items()}

        return lru_cache(self.KEPT)(at)


def resting_attitude(
    accel: Sequence[float], mag: Sequence[float], field: Sequence[float]
) -> tuple[float, float, float]:
    """Return roll, pitch, yaw in degrees of a resting body, from one sample of accelerometer and magnetometer.

        gravity --> roll, pitch --turn the field level--> yaw

    An accelerometer at rest, level and z down, reads (0, 0, -1 g). field: north and east components of the magnetic
    field at the body. `attitude` has a filter that tolerates motion.
    """
    x, y, z = (-value for value in accel)
    roll, pitch = atan2(y, z), atan2(-x, hypot(y, z))
    mx, my, mz = mag
    down = my * sin(roll) + mz * cos(roll)
    north, west = mx * cos(pitch) + down * sin(pitch), my * cos(roll) - mz * sin(roll)
    yaw = (degrees(atan2(-west, north) + atan2(field[1], field[0])) + 180) % 360 - 180
    return degrees(roll), degrees(pitch), yaw
