"""Attitudes as quaternions and as roll, pitch, yaw: conversions of arrays, and angles between attitudes.

An attitude is the rotation from the body's axes (x ahead, y right, z down) to north, east, down. A quaternion is
w, x, y, z with length 1; q and -q are the same attitude. Roll, pitch and yaw are the angles of aerospace in radians: a
rotation of the axes north, east, down first about z (yaw), then about the new y (pitch), then about the new x (roll)
gives the body's axes. So a vector v in north, east, down is Rx(roll) Ry(pitch) Rz(yaw) v in the body's axes, as in the
dissertation's section 4.1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def quaternions(angles: ArrayLike) -> Floats:
    """Convert roll, pitch, yaw, float64[n, 3], to quaternions, float64[n, 4]."""
    half = np.atleast_2d(np.asarray(angles, np.float64)) / 2
    (cr, cp, cy), (sr, sp, sy) = np.cos(half).T, np.sin(half).T
    return np.stack(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ],
        axis=1,
    )


def angles(attitudes: ArrayLike) -> Floats:
    """Convert quaternions, float64[n, 4], to roll, pitch, yaw, float64[n, 3].

    If the nose points straight up or down, roll is 0.
    """
    m = matrices(attitudes)
    horizontal = np.hypot(m[:, 2, 1], m[:, 2, 2])  # the cosine of the pitch
    locked = horizontal < 1e-9
    roll = np.where(locked, 0.0, np.arctan2(m[:, 2, 1], m[:, 2, 2]))
    yaw = np.where(locked, np.arctan2(-m[:, 0, 1], m[:, 1, 1]), np.arctan2(m[:, 1, 0], m[:, 0, 0]))
    return np.stack([roll, np.arctan2(-m[:, 2, 0], horizontal), yaw], axis=1)


def matrices(attitudes: ArrayLike) -> Floats:
    """Convert quaternions, float64[n, 4], to matrices from the body's axes to north, east, down, float64[n, 3, 3]."""
    w, x, y, z = np.atleast_2d(np.asarray(attitudes, np.float64)).T
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def angle_between(a: ArrayLike, b: ArrayLike) -> Floats:
    """Return the angle of the rotation from each attitude in `a` to that in the same row of `b`, in rad, 0 to pi.

    The result is float64[n].

    a, b: quaternions, float64[n, 4].
    """
    one, other = (np.atleast_2d(np.asarray(q, np.float64)) for q in (a, b))
    apart = np.linalg.norm(one - other, axis=1)
    against = np.linalg.norm(one + other, axis=1)
    return np.asarray(4 * np.arctan2(np.minimum(apart, against), np.maximum(apart, against)), np.float64)


def wrapped(angle: ArrayLike) -> Floats:
    """Return each angle, in radians, reduced to the range from -pi to pi."""
    return np.asarray(np.arctan2(np.sin(angle), np.cos(angle)), np.float64)
