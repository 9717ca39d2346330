"""Sweeps of motions and of parameters.

Motions: pitch through 90 degrees, wraps of yaw and of int16, rates and accelerations beyond full scale. Parameters:
fields along an axis, weak and strong, and lever arms whose products exceed the Q format. Each sweep converts a value,
from ordinary to extreme, to parameters of the sensors and to the counts that a host would send (`Sample`).
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi, radians

import numpy as np
from msgspec.structs import replace

from ..host_frame import ACCELERATION, ANGLE
from ..models.parameters import (
    NONE,
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)
from ..models.quantity import Vector
from .frames import Ints
from .sweep import Floats, InputSweep, Sample

Attitude = tuple[float, float, float]  # roll, pitch, yaw in rad

INT16 = 0x8000
AS_BUILT = ImuParameters()
CORRECTED = ImuParameters(gyroscope=GyroscopeParameters(rates="corrected"))
UNWRAPPED = ImuParameters(wrap="unwrapped")
SLOW = radians(1)  # a slow rate in rad per sample, which is 50 deg/s
FAST = 500.0  # a fast rate in deg/s
ONE_COUNT = 5.0  # maximum change of the gyroscope's codes for one count of an angle: 4.1 LSB, plus cross-axis effects


def sent(attitude: Callable[[int], Attitude], acceleration: float = 0.0) -> Ints:
    """Return the counts that a host without range checks sends, int64[12]. Counts beyond int16 wrap.

    attitude, acceleration: the same as for `meant`.
    """
    counts: Ints = (meant(attitude, acceleration) + INT16) % (2 * INT16) - INT16
    return counts


def meant(attitude: Callable[[int], Attitude], acceleration: float = 0.0) -> Ints:
    """Return the counts of a host whose frames could hold counts of any size, int64[12].

    The counts are the angles of three samples, oldest first, and then the accelerations of the last sample.

    attitude: a function that returns the attitude n samples before the last sample. It is called with n = 2, 1 and 0.
    acceleration: the acceleration on all three axes in g.
    """
    angles = [np.asarray(attitude(k)) / ANGLE for k in (2, 1, 0)]
    exact: Floats = np.concatenate([*angles, np.full(3, acceleration / ACCELERATION)])
    return np.rint(exact).astype(np.int64)


def still(ago: int) -> Attitude:
    return (0.0, 0.0, 0.0)


def pitching(value: float, imu: ImuParameters) -> Sample:
    """Return the sample of a body that pitches past 90 degrees and is then upside down.

    The host sends pitch angles up to 90 degrees only. For example, it sends a pitch of 100 degrees as a pitch of 80
    degrees, with roll and yaw of 180 degrees. The reference gets the pitch of 100 degrees, with roll and yaw of 0.

    value: the pitch in degrees at the last of the three successive attitudes of the sample.
    """

    def level(ago: int) -> Attitude:
        return (0.0, radians(value) - ago * SLOW, 0.0)

    def over(ago: int) -> Attitude:
        pitch = level(ago)[1]
        return (0.0, pitch, 0.0) if pitch <= pi / 2 else (pi, pi - pitch, pi)

    return Sample(imu, sent(over), imu, meant(level))


def yawing(value: float, imu: ImuParameters, wrapped_by_host: bool) -> Sample:
    """Return the sample of a body that yaws through 180 degrees. The reference gets a yaw that does not wrap.

    value: the yaw at the last of the three attitudes, in degrees.
    wrapped_by_host: True if the host wraps angles; False if only int16 wraps.
    """

    def on(ago: int) -> Attitude:
        return (0.0, 0.0, radians(value) - ago * SLOW)

    def wrapped(ago: int) -> Attitude:
        return (0.0, 0.0, (on(ago)[2] + pi) % (2 * pi) - pi)

    return Sample(imu, sent(wrapped if wrapped_by_host else on), imu, meant(on))


def yaw_step(value: float) -> Sample:
    """Return the sample of a yaw step from rest, centred at 0 so that no angle wraps. value: the step in degrees."""
    half = radians(value) / 2
    return Sample(AS_BUILT, sent(lambda ago: (0.0, 0.0, -half if ago else half)))


def rolling(value: float, late: float = 0.0) -> Sample:
    """Return the sample of a body that rolls at a constant rate.

    value: the rate in deg/s.
    late: the time by which the interval between two frames exceeds Ts, as a fraction of Ts.
    """
    step = radians(value) * AS_BUILT.period

    def steady(ago: int) -> Attitude:
        return (-ago * step, 0.0, 0.0)

    return Sample(AS_BUILT, sent(lambda ago: (-ago * step * (1 + late), 0.0, 0.0)), AS_BUILT, meant(steady))


def spinning(value: float) -> Sample:
    """Return the sample of a roll, with angles that may exceed the 16 bits of a frame. value: the rate in deg/s."""
    step = radians(value) * AS_BUILT.period
    counts = meant(lambda ago: (-ago * step, 0.0, 0.0))
    return Sample(AS_BUILT, counts)


def accelerated(value: float) -> Sample:
    return Sample(AS_BUILT, sent(still, value))


MOTIONS = (
    InputSweep(
        "pitch through 90, as built",
        "50 deg/s past 90, where roll and yaw jump by 180",
        "deg",
        87,
        93,
        lambda value: pitching(value, AS_BUILT),
        ONE_COUNT,
    ),
    InputSweep(
        "pitch through 90, corrected",
        "the same with the rates of appendix B",
        "deg",
        87,
        93,
        lambda value: pitching(value, CORRECTED),
        ONE_COUNT,
    ),
    InputSweep(
        "yaw through 180, as built",
        "50 deg/s; the plain difference is a step of -359",
        "deg",
        177,
        183,
        lambda value: yawing(value, AS_BUILT, wrapped_by_host=True),
        ONE_COUNT,
    ),
    InputSweep(
        "yaw through 180, unwrapped",
        "the same with the short way round",
        "deg",
        177,
        183,
        lambda value: yawing(value, UNWRAPPED, wrapped_by_host=True),
        ONE_COUNT,
    ),
    InputSweep(
        "yaw beyond int16",
        "50 deg/s, unwrapped; a host that does not wrap, so its int16 does",
        "deg",
        185,
        191,
        lambda value: yawing(value, UNWRAPPED, wrapped_by_host=False),
        ONE_COUNT,
    ),
    InputSweep("yaw step in one sample", "from rest, as built", "deg", 0, 359, yaw_step),
    InputSweep("roll rate", "full scale is 2000, the converter's highest code 2279", "deg/s", 0, 8000, rolling),
    InputSweep(
        "roll rate beyond frames",
        "angles of any size; cross-axis sensitivity takes y and z to full scale at 114 000",
        "deg/s",
        0,
        1e6,
        spinning,
    ),
    InputSweep("acceleration", "on all axes, up to a frame's limit", "g", 0, 32.767, accelerated),
    InputSweep(
        "Ts jitter",
        "500 deg/s, frames late by a part of Ts, unknown to the model",
        "% of Ts",
        0,
        50,
        lambda value: rolling(FAST, value / 100),
    ),
)


VERTICAL = 0.2  # vertical field in gauss, which remains when the horizontal field goes to 0
TURN_RATE = 500.0  # rate of the rotation for lever arms, in deg/s


def in_field(field: Vector, attitude: Callable[[int], Attitude] = still, **examined: str) -> Sample:
    """Return the sample of a resting body in a field.

    field: the field in gauss, in the axes of a body whose roll, pitch and yaw are 0.
    attitude: the same as for `meant`.
    examined: the method that is examined, as the argument `spherical` or `norm` of MagnetometerParameters. The
        reference uses the default method.
    """
    sensor = MagnetometerParameters(earth_field=field, hard_iron=NONE)
    true = ImuParameters(magnetometer=sensor)
    return Sample(ImuParameters(magnetometer=replace(sensor, **examined)), sent(attitude), true)


def turned(value: float) -> Sample:
    """Return the sample of a resting body in a field that points north and down. value: the yaw in degrees."""
    return in_field((0.3, 0.0, 0.2), lambda ago: (0.0, 0.0, radians(value)), spherical="plain")


def lever(value: float, reversing: bool) -> Sample:
    """Return the sample of a rotating accelerometer with a lever arm.

    value: the x component of the lever arm in m. The y component is value / 2, and the z component is -value.
    reversing: True if the rotation reverses within a sample; False if it is steady.
    """
    step = radians(TURN_RATE) * ImuParameters().period
    imu = ImuParameters(
        accelerometer=AccelerometerParameters(lever_arm=(value, value / 2, -value), bits=16, scale=1.0, cross_axis=0.0)
    )

    def moved(ago: int) -> Attitude:
        angle = (0.0 if ago == 1 else -step) if reversing else -ago * step
        return (angle, angle / 2, angle)

    return Sample(imu, sent(moved))


FIELDS = (
    InputSweep(
        "field along z, four-quadrant",
        "its horizontal part goes to 0",
        "gauss",
        0.3,
        0.0,
        lambda value: in_field((value, 0.0, VERTICAL), spherical="four-quadrant"),
    ),
    InputSweep(
        "field along z, plain",
        "the same with plain arctangents: 0/0",
        "gauss",
        0.3,
        0.0,
        lambda value: in_field((value, 0.0, VERTICAL), spherical="plain"),
    ),
    InputSweep(
        "field along z, rotation",
        "the same without angles",
        "gauss",
        0.3,
        0.0,
        lambda value: in_field((value, 0.0, VERTICAL), spherical="rotation"),
    ),
    InputSweep(
        "no field, plain",
        "a horizontal field that goes to 0 without a vertical one",
        "gauss",
        0.3,
        0.0,
        lambda value: in_field((value, 0.0, 0.0), spherical="plain"),
    ),
    InputSweep(
        "yaw of the field, plain",
        "plain arctangents, against four quadrants",
        "deg",
        0,
        180,
        turned,
    ),
    InputSweep(
        "field strength",
        "rho from squares, as written",
        "gauss",
        0.5,
        1000,
        lambda value: in_field((value / 3**0.5,) * 3, norm="squares"),
    ),
    InputSweep(
        "field strength, IQmag",
        "rho from magnitudes of two",
        "gauss",
        0.5,
        1000,
        lambda value: in_field((value / 3**0.5,) * 3, norm="mag"),
    ),
    InputSweep(
        "lever arm, steady",
        "500, 250, 500 deg/s: w x (w x d), at 1 LSB a g",
        "m",
        0.01,
        100,
        lambda value: lever(value, reversing=False),
    ),
    InputSweep(
        "lever arm, reversing",
        "the same reversed in one sample: w' x d",
        "m",
        0.01,
        100,
        lambda value: lever(value, reversing=True),
    ),
)
