"""Model of firmware that emulates the sensor chips of an IMU. It returns the bytes that the firmware should send.

firmware's settings with sensors, arithmetic, noise_seed --firmware_model--> ImuFirmware

A scene (a simulated case) uses an ImuFirmware as a `scene.unit.FirmwareModel`.
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
    """A `FirmwareModel` of firmware that calculates the data of the sensor chips of an IMU.

    parameters: the parameters of the sensors.
    settings: the settings of the firmware. The settings `arithmetic` and `noise_seed`, if present, affect the results.
    arithmetic: the name of the arithmetic in which the firmware calculates; None if no setting names it.
    noise_seed: the seed of the noise; None for no noise.
    """

    def __init__(self, parameters: ImuParameters, settings: object) -> None:
        self.parameters = parameters
        self._settings = settings
        arithmetic: object = getattr(settings, "arithmetic", None)
        self.arithmetic = arithmetic if isinstance(arithmetic, str) else None
        self.noise_seed: Any = getattr(settings, "noise_seed", None)

    @property
    def runs_per_frame(self) -> bool:
        """True if the firmware runs the models once per host frame instead of once per round."""
        return getattr(self._settings, "models_run", "round") == "frame"

    def check(self, case: Case, unit: str) -> None:
        """Raise BadCase if the models' Ts is not the period at which this firmware runs the models in the case.

        The firmware runs the models once per host frame if the setting `models_run` is "frame" or the case has no
        rounds; otherwise once per round. If the case has neither frames nor rounds, nothing is checked.
        """
        rounds = case.controller or case.rounds
        per_frame = self.runs_per_frame or rounds is None
        table = case.host if per_frame else rounds
        if table is None:
            return
        per_round = f"once a round ({'controller' if case.rounds is None else 'rounds'}.period)"
        try:
            self.parameters.check_period(table.period, "once a host frame (host.period)" if per_frame else per_round)
        except BadParameter as error:
            raise case.mistake(error.what, "unit", unit, "settings", "parameters") from None

    def codes(self) -> ChipModel | None:
        """Return the model that calculates the bytes of the chips; None if no setting names the arithmetic."""
        if self.arithmetic is None:
            return None
        from .model_codes import model_codes

        return model_codes(self.parameters, self.arithmetic, self.noise_seed)

    def truth(self, motion: Motion, first: Fraction) -> MotionTruth:
        """Return the readings that the sensors would give during a motion if they had no noise and did not round.

        The readings include the biases and cross-axis sensitivities of the parameters.

        first: the instant of the motion, in seconds, that frame 0 describes.
        """
        return MotionTruth(self.parameters, motion, first)

    def attitude(self, readings: Mapping[str, Sequence[float]]) -> list[float] | None:
        """Return roll, pitch, yaw of the resting body in degrees; None before accelerometer and magnetometer were read.

        readings: x, y, z of each chip in its unit, by the name of the chip. The function subtracts the known biases.
        """
        accel, mag, sensors = readings.get("accelerometer"), readings.get("magnetometer"), self.parameters
        if accel is None or mag is None:
            return None
        gravity = _less(accel, sensors.accelerometer.bias)
        field = _less(mag, sensors.magnetometer.hard_iron)
        return [*resting_attitude(gravity, field, sensors.magnetometer.earth_field)]


def firmware_model(settings: object) -> ImuFirmware | None:
    """Return the model of firmware with these settings; None if the setting `sensors` is not an ImuParameters."""
    sensors: object = getattr(settings, "sensors", None)
    return ImuFirmware(sensors, settings) if isinstance(sensors, ImuParameters) else None


def _less(values: Sequence[float], bias: Sequence[float]) -> list[float]:
    return [value - known for value, known in zip(values, bias, strict=True)]


class MotionTruth:
    """The readings that sensors without noise or rounding would give during the true motion, calculated in float64.

    The readings contain no noise, because noise is not a property of the body. Besides, the timing of the firmware
    determines which sample of the noise a read contains, and the truth must not depend on this timing.

    imu: the parameters of the sensors.
    first: the instant of the motion, in seconds, that frame 0 describes.
    """

    KEPT = 64  # number of instants whose readings are cached, because several chips and budgets use the same instant

    def __init__(self, imu: ImuParameters, motion: Motion, first: Fraction) -> None:
        self._imu = imu
        self._motion = motion
        self._first = first

    @cached_property
    def at(self) -> Callable[[Fraction], Mapping[str, Axes]]:
        """A function from a time, in seconds after frame 0 is due, to the readings of each chip in LSB.

        The function is created when this property is first used, since few runs need it.
        """
        from .models.sensed_motion import SensedMotion

        felt = SensedMotion(self._imu, self._motion)
        return lru_cache(self.KEPT)(lambda seconds: felt.at(float(self._first + seconds)))


def resting_attitude(
    accel: Sequence[float], mag: Sequence[float], field: Sequence[float]
) -> tuple[float, float, float]:
    """Return roll, pitch, yaw in degrees of a resting body, from one sample of accelerometer and magnetometer.

        gravity --> roll, pitch --turn the field level--> yaw

    An accelerometer that is at rest and level, with z down, reads (0, 0, -1 g). For a moving body, use the filter in
    `attitude`.

    accel, mag: x, y, z of the sample, in any unit.
    field: the north, east and down components of the magnetic field, in any unit; only north and east are used.
    """
    x, y, z = (-value for value in accel)
    roll, pitch = atan2(y, z), atan2(-x, hypot(y, z))
    mx, my, mz = mag
    down = my * sin(roll) + mz * cos(roll)
    north, west = mx * cos(pitch) + down * sin(pitch), my * cos(roll) - mz * sin(roll)
    yaw = (degrees(atan2(-west, north) + atan2(field[1], field[0])) + 180) % 360 - 180
    return degrees(roll), degrees(pitch), yaw
