"""Extremes of parameters: fields along an axis, weak and strong, and lever arms whose products exceed the format."""

from __future__ import annotations

from math import radians

from msgspec.structs import replace

from ..models.parameters import AccelerometerParameters, ImuParameters, MagnetometerParameters, Norm, Spherical
from .motions import Attitude, sent
from .sweep import Sample, Sweep

VERTICAL = 0.2  # gauss: the part of the field that remains when the horizontal one goes to 0
TURN_RATE = 500.0  # deg/s


def still(ago: int) -> Attitude:
    return (0.0, 0.0, 0.0)


def along_z(value: float, spherical: Spherical, vertical: float = VERTICAL) -> Sample:
    """Return a field whose horizontal part goes to 0; the reference uses "four-quadrant"."""
    sensor = MagnetometerParameters(earth_field=(value, 0.0, vertical), hard_iron=(0.0, 0.0, 0.0))
    true = ImuParameters(magnetometer=sensor)
    return Sample(ImuParameters(magnetometer=replace(sensor, spherical=spherical)), sent(still), true)


def turned(value: float, spherical: Spherical) -> Sample:
    """Return a field to the north and down, measured at a yaw in deg."""
    sensor = MagnetometerParameters(earth_field=(0.3, 0.0, 0.2), hard_iron=(0.0, 0.0, 0.0))
    true = ImuParameters(magnetometer=sensor)
    counts = sent(lambda ago: (0.0, 0.0, radians(value)))
    return Sample(ImuParameters(magnetometer=replace(sensor, spherical=spherical)), counts, true)


def strong(value: float, norm: Norm) -> Sample:
    """Return a field of a strength in gauss, in a direction between the axes."""
    part = value / 3**0.5
    sensor = MagnetometerParameters(earth_field=(part, part, part), hard_iron=(0.0, 0.0, 0.0))
    return Sample(
        ImuParameters(magnetometer=replace(sensor, norm=norm)), sent(still), ImuParameters(magnetometer=sensor)
    )


def lever(value: float, reversing: bool) -> Sample:
    """Return a lever arm in m on x, half on y, negative on z; in steady rotation, or reversed within one sample."""
    step = radians(TURN_RATE) * ImuParameters().period
    imu = ImuParameters(
        accelerometer=AccelerometerParameters(lever_arm=(value, value / 2, -value), bits=16, scale=1.0, cross_axis=0.0)
    )

    def moved(ago: int) -> Attitude:
        angle = (0.0 if ago == 1 else -step) if reversing else -ago * step
        return (angle, angle / 2, angle)

    return Sample(imu, sent(moved))


FIELDS = (
    Sweep(
        "field along z, four-quadrant",
        "its horizontal part goes to 0",
        "gauss",
        0.3,
        0.0,
        lambda value: along_z(value, "four-quadrant"),
    ),
    Sweep(
        "field along z, plain",
        "the same with plain arctangents: 0/0",
        "gauss",
        0.3,
        0.0,
        lambda value: along_z(value, "plain"),
    ),
    Sweep(
        "field along z, rotation",
        "the same without angles",
        "gauss",
        0.3,
        0.0,
        lambda value: along_z(value, "rotation"),
    ),
    Sweep(
        "no field, plain",
        "a horizontal field that goes to 0 without a vertical one",
        "gauss",
        0.3,
        0.0,
        lambda value: along_z(value, "plain", vertical=0.0),
    ),
    Sweep(
        "yaw of the field, plain",
        "plain arctangents, against four quadrants",
        "deg",
        0,
        180,
        lambda value: turned(value, "plain"),
    ),
    Sweep("field strength", "rho from squares, as written", "gauss", 0.5, 1000, lambda value: strong(value, "squares")),
    Sweep(
        "field strength, IQmag",
        "rho from magnitudes of two",
        "gauss",
        0.5,
        1000,
        lambda value: strong(value, "mag"),
    ),
    Sweep(
        "lever arm, steady",
        "500, 250, 500 deg/s: w x (w x d), at 1 LSB a g",
        "m",
        0.01,
        100,
        lambda value: lever(value, reversing=False),
    ),
    Sweep(
        "lever arm, reversing",
        "the same reversed in one sample: w' x d",
        "m",
        0.01,
        100,
        lambda value: lever(value, reversing=True),
    ),
)
