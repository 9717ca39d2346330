"""A pose of a body: the six values of a host frame, as in a case."""

from __future__ import annotations

from dataclasses import dataclass

from .quantities import Acceleration, Angle


@dataclass(frozen=True)
class Pose:
    """Attitude in rad, linear acceleration in g."""

    phi: Angle = 0.0
    theta: Angle = 0.0
    psi: Angle = 0.0
    ax: Acceleration = 0.0
    ay: Acceleration = 0.0
    az: Acceleration = 0.0


LEVEL = Pose()  # and north, at rest


def row(pose: Pose) -> list[float]:
    """Return the six values of a pose, in the order of a host frame."""
    return [pose.phi, pose.theta, pose.psi, pose.ax, pose.ay, pose.az]
