"""Attitude of a resting body, in degrees, from one sample of its accelerometer and magnetometer.

    gravity --> roll, pitch --turn the field level--> yaw

An accelerometer at rest, level and z down, reads (0, 0, -1 g). `attitude` has a filter that tolerates motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, degrees, hypot, sin


def resting_attitude(
    accel: Sequence[float], mag: Sequence[float], field: Sequence[float]
) -> tuple[float, float, float]:
    """Return roll, pitch, yaw in degrees. field: north and east components of the magnetic field at the body."""
    x, y, z = (-value for value in accel)
    roll, pitch = atan2(y, z), atan2(-x, hypot(y, z))
    mx, my, mz = mag
    down = my * sin(roll) + mz * cos(roll)
    north, west = mx * cos(pitch) + down * sin(pitch), my * cos(roll) - mz * sin(roll)
    yaw = (degrees(atan2(-west, north) + atan2(field[1], field[0])) + 180) % 360 - 180
    return degrees(roll), degrees(pitch), yaw
