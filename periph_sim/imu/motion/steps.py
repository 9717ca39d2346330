"""Motion in steps: the values of a pose change at given times and are constant in between.

start = { theta = "10 deg" }
steps = [ { at = "1 s", theta = "20 deg" }, { at = "2 s", ax = "0.5 g" } ]
"""

from __future__ import annotations

from dataclasses import dataclass

from . import BadMotion
from .pieces import Held
from .quantities import LEVEL, Acceleration, Angle, Pose, Seconds, six_values


@dataclass(frozen=True)
class Step:
    """A step at the time `at`. Values that are not None change to the given values; the others do not change."""

    at: Seconds
    phi: Angle | None = None
    theta: Angle | None = None
    psi: Angle | None = None
    ax: Acceleration | None = None
    ay: Acceleration | None = None
    az: Acceleration | None = None


@dataclass(frozen=True)
class Settings:
    """The settings of the steps. start: the values before the first step. steps: the steps, at increasing times."""

    steps: tuple[Step, ...]
    start: Pose = LEVEL


def motion(settings: Settings) -> Held:
    """Build the motion. Raise BadMotion if the times do not increase."""
    times, rows = [0.0], [[*six_values(settings.start)]]
    for number, step in enumerate(settings.steps):
        if step.at <= times[-1] and number:
            raise BadMotion(
                f"steps.{number}: it is at {step.at:g} s; expected later than {times[-1]:g} s, the one before"
            )
        times.append(step.at)
        rows.append([old if new is None else new for old, new in zip(rows[-1], six_values(step), strict=True)])
    return Held(times, rows)
