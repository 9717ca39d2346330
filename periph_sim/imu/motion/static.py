"""No motion: a constant attitude and acceleration."""

from __future__ import annotations

from dataclasses import dataclass

from .pieces import Held
from .quantities import Pose, six_values


@dataclass(frozen=True)
class Settings(Pose):
    """The constant values; all zero is level, pointing north, at rest."""


def motion(settings: Settings) -> Held:
    return Held([0.0], [six_values(settings)])
