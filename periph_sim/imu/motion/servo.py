"""Motion of the moving experiment: three servos move one after the other. Their positions are read and interpolated.

    pitch: 0 --fast--> +limit, hold, --slow--> -limit, hold, and so on, --fast--> 0, hold; then yaw, then roll

Dissertation section 5.3: 52.2 and 2.9 rpm, 50, 50 and 80 degrees, servos AX-18A with a resolution of 0.29 degrees. The
positions of the servos were read over a slow serial line, and interpolated before they were sent to the emulator. The
dissertation does not state the duration of a hold, the number of swings and the reading interval, so their defaults are
our choice. A modelled servo reaches its speed at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import Annotated, Literal

from msgspec import Meta

from . import ANGLES, BadMotion, Motion
from .pieces import Held, Straight
from .quantities import ANGLE_UNITS, RATE_UNITS, Angle, Rate, Seconds

DEGREE = ANGLE_UNITS["deg"]
RPM = RATE_UNITS["rpm"]
LEAST_RESOLUTION = 1e-300  # in rad; an angle divided by a smaller resolution can exceed the range of a float
MOST_READS = 1_000_000  # maximum number of positions that are held in memory


@dataclass(frozen=True)
class Settings:
    """The settings of the servos.

    pitch, yaw, roll: the largest angle of each servo, to both sides of 0.
    fast: the rate of motions from 0 or the negative limit to the positive limit, and of the last motion back to 0.
    slow: the rate of motions from the positive to the negative limit.
    hold: the time without movement after each motion.
    swings: the number of swings of each servo. A swing goes to the positive and then to the negative limit.
    resolution: the positions that are read are rounded to multiples of this step; 0 for exact positions.
    read_every: the time between two readings; 0 if positions are read continuously, so that nothing is interpolated.
    interpolate: the interpolation between readings: "straight" for a line, "hold" for the value of the last reading.
    """

    pitch: Angle = 50 * DEGREE
    yaw: Angle = 50 * DEGREE
    roll: Angle = 80 * DEGREE
    fast: Rate = 52.2 * RPM
    slow: Rate = 2.9 * RPM
    hold: Seconds = 2.0
    swings: Annotated[int, Meta(ge=1, le=100)] = 3
    resolution: Angle = 0.29 * DEGREE
    read_every: Seconds = 0.1
    interpolate: Literal["straight", "hold"] = "straight"


def path(settings: Settings) -> Straight:
    """Return the true motion of the servos, without rounding to their resolution and without interpolation."""
    times, poses = [0.0], [[0.0] * 6]

    def go(angle: str, to: float, rate: float) -> None:
        pose = poses[-1].copy()
        column = ANGLES.index(angle)
        if pose[column] != to:
            times.append(times[-1] + abs(to - pose[column]) / rate)
            pose[column] = to
            poses.append(pose)
        if settings.hold:
            times.append(times[-1] + settings.hold)
            poses.append(pose)

    for angle, swing in (("theta", settings.pitch), ("psi", settings.yaw), ("phi", settings.roll)):
        for _ in range(settings.swings):
            go(angle, swing, settings.fast)
            go(angle, -swing, settings.slow)
        go(angle, 0.0, settings.fast)
    return Straight(times, poses)


class Servo(Motion):
    """The motion of the servos: the attitude as read from the servos and interpolated, and the true rates.

    The servos rotate the sensors about the sensors' own position, so there is no acceleration.
    """

    def __init__(self, settings: Settings) -> None:
        self._path = path(settings)
        self.ends = self._path.ends
        self._resolution = settings.resolution
        self._read: Straight | Held | None = None
        if settings.read_every:
            steps = self.ends / settings.read_every  # inf if the quotient exceeds the range of a float
            if steps + 2 > MOST_READS:
                raise BadMotion(
                    f"read_every: {steps + 2:.0f} positions in {self.ends:g} s; expected at most {MOST_READS}, "
                    "or 0 s for no interpolation"
                )
            times = [number * settings.read_every for number in range(ceil(steps) + 2)]
            shape = Straight if settings.interpolate == "straight" else Held
            self._read = shape(times, [self._positions(seconds) for seconds in times])
            self.ends = self._read.ends

    @property
    def truth(self) -> Straight:
        """The true motion of the servos, which is neither rounded nor interpolated."""
        return self._path

    def at(self, seconds: float) -> Sequence[float]:
        return self._positions(seconds) if self._read is None else self._read.at(seconds)

    def rates_at(self, seconds: float) -> Sequence[float]:
        return self._path.rates_at(seconds)

    def _positions(self, seconds: float) -> Sequence[float]:
        """Return positions that are rounded to the resolution of the servos."""
        positions, resolution = self._path.at(seconds), self._resolution
        return [round(angle / resolution) * resolution for angle in positions] if resolution else positions


def motion(settings: Settings) -> Servo:
    """Build the motion. Raise BadMotion if the resolution is invalid, or if too many positions would be read."""
    if settings.resolution < 0:
        raise BadMotion(f"resolution: it is {settings.resolution:g} rad; expected 0 rad or more")
    if 0 < settings.resolution < LEAST_RESOLUTION:
        expected = f"0 rad, or {LEAST_RESOLUTION:g} rad or more"
        raise BadMotion(f"resolution: it is {settings.resolution:g} rad; expected {expected}")
    return Servo(settings)
