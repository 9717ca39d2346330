"""Readings of ideal sensors in an attitude, by the matrices of the dissertation's section 4.1.

The functions use no code of the product, so that tests can compare it with them.
"""

from __future__ import annotations

import numpy as np

FIELD = np.array([0.18, -0.07, -0.12])  # gauss, north, east, down: approximately the field in the south of Brazil


def to_body(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """Rx(roll) Ry(pitch) Rz(yaw), which rotates a vector from north, east, down to the body."""
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (np.cos, np.sin))
    about_x = np.array([[1, 0, 0], [0, cr, sr], [0, -sr, cr]])
    about_y = np.array([[cp, 0, -sp], [0, 1, 0], [sp, 0, cp]])
    about_z = np.array([[cy, sy, 0], [-sy, cy, 0], [0, 0, 1]])
    return about_x @ about_y @ about_z


def at_rest(roll: float, pitch: float, yaw: float) -> tuple[np.ndarray, np.ndarray]:
    """(accel in g, mag in gauss) of a body that does not move: accel is -A_pig of equation 4.2."""
    gravity = np.array([-np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)])
    return -gravity, to_body(roll, pitch, yaw) @ FIELD


def body_rates(angles: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """p, q, r of appendix B from roll, pitch, yaw and their derivatives; float64[n, 3] each, in radians."""
    (roll, pitch, _), (d_roll, d_pitch, d_yaw) = angles.T, rates.T
    return np.stack(
        [
            d_roll - d_yaw * np.sin(pitch),
            d_pitch * np.cos(roll) + d_yaw * np.sin(roll) * np.cos(pitch),
            d_yaw * np.cos(pitch) * np.cos(roll) - d_pitch * np.sin(roll),
        ],
        axis=1,
    )
