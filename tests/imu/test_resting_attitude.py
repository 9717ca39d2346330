"""Attitude of a body at rest, against its rotation matrix written out."""

from __future__ import annotations

from math import cos, radians, sin

import pytest

from periph_sim.imu.resting_attitude import resting_attitude

FIELD = (0.3, -0.05, 0.4)


def in_body(vector: tuple[float, float, float], roll: float, pitch: float, yaw: float) -> list[float]:
    """Rx(roll) Ry(pitch) Rz(yaw) of a vector that is north, east, down."""
    n, e, d = vector
    p, t, s = map(radians, (roll, pitch, yaw))
    x, y = n * cos(s) + e * sin(s), e * cos(s) - n * sin(s)
    x, z = x * cos(t) - d * sin(t), d * cos(t) + x * sin(t)
    return [x, y * cos(p) + z * sin(p), z * cos(p) - y * sin(p)]


@pytest.mark.parametrize("roll", [0.0, 25.0, -80.0, 150.0])
@pytest.mark.parametrize("pitch", [0.0, 40.0, -70.0])
@pytest.mark.parametrize("yaw", [0.0, 60.0, -100.0, 179.0])
def test_every_attitude_is_found(roll: float, pitch: float, yaw: float) -> None:
    accel = in_body((0.0, 0.0, -1.0), roll, pitch, yaw)
    assert resting_attitude(accel, in_body(FIELD, roll, pitch, yaw), FIELD) == pytest.approx((roll, pitch, yaw))
