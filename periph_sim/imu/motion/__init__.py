"""Motions: attitude and acceleration as functions of time. A host sends frames of a motion.

Each file in this folder that has a function `motion` is a kind of motion. The files are found automatically. A file
defines

    Settings             a dataclass of the keys of [host.motion], with units (`quantities`)
    motion(settings)     returns the `Motion`; raises BadMotion, or BadCapture for a file, if it cannot be made

Angles are roll phi, pitch theta and yaw psi as usual in aerospace, with z down, in rad. Accelerations are linear
accelerations of the body in g, without gravity (dissertation sections 3.4 and 4.3.1).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Protocol, cast

from ...core.discover import module_with, modules_with
from ...core.input_error import InputError
from .quantities import ACCELERATION_RANGE, ANGLE_RANGE, shown

ANGLES = ("phi", "theta", "psi")
ACCELERATIONS = ("ax", "ay", "az")
VALUES = ANGLES + ACCELERATIONS


class BadMotion(InputError):
    """A motion, an encoding or the values of a frame are invalid. The message says what was found and expected."""


class Motion:
    """A motion from time 0 on.

    ends: a time in seconds after which all values are constant; infinite if no such time is known.
    """

    ends: float

    @property
    def truth(self) -> Motion:
        """The true motion of the body.

        Normally it is this motion itself. If the values of this motion are only coarse readings of the true motion, it
        is another object.
        """
        return self

    def at(self, seconds: float) -> Sequence[float]:
        """Return phi, theta, psi in rad, and ax, ay, az in g, at a time in seconds."""
        raise NotImplementedError

    def rates_at(self, seconds: float) -> Sequence[float]:
        """Return the true rates of phi, theta, psi in rad/s. If the rates jump at this time, return the later rates."""
        raise NotImplementedError


class MotionKind(Protocol):
    """The names that the file of a kind of motion must define."""

    Settings: type[object]

    def motion(self, settings: object) -> Motion: ...


@cache
def kinds() -> dict[str, MotionKind]:
    """Return all kinds of motion by their names. The name of a kind is the name of its file."""
    return {name: cast(MotionKind, module) for name, module in modules_with("motion", __name__, __path__).items()}


@cache
def kind_named(name: str) -> MotionKind | None:
    """Return the kind of motion with this name; None if there is no such kind."""
    return cast("MotionKind | None", module_with("motion", __name__, __path__, name))


def sampled(motion: Motion, seconds: float) -> Sequence[float]:
    """Return the six values of a motion at a time, in rad and g. Raise BadMotion if a value is out of range."""
    values = motion.at(seconds)
    for name, value in zip(VALUES, values, strict=True):
        limit, unit = (ANGLE_RANGE, "rad") if name in ANGLES else (ACCELERATION_RANGE, "g")
        if not abs(value) <= limit:  # `abs(value) > limit` would be false for NaN
            expected = shown(limit, unit)
            raise BadMotion(f"motion: {name} is {value:.6g} {unit} at {seconds:.6g} s; expected {expected}")
    return values
