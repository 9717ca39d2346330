"""Host motion: attitude and acceleration as functions of time, of several kinds.

One file of this folder that has a function `motion` is one kind of motion, found by its presence. It defines

    Settings             a dataclass of the keys of [host.motion], with units (`quantities`)
    motion(settings)     the `Motion`; BadMotion for invalid settings

Angles are the usual aerospace ones, z down: roll phi, pitch theta, yaw psi in rad. Accelerations are linear ones
of the body in g, without gravity (dissertation sections 3.4 and 4.3.1).
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Protocol, TypeAlias, cast, runtime_checkable

from ...core.discover import module_with, modules_with
from ...core.input_error import InputError
from .quantities import ACCELERATION_RANGE, ANGLE_RANGE, shown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats: TypeAlias = NDArray[np.float64]

ANGLES = ("phi", "theta", "psi")
ACCELERATIONS = ("ax", "ay", "az")
VALUES = ANGLES + ACCELERATIONS


class BadMotion(InputError):
    """Invalid motion: the message names the value and the range, or the file and the line."""


class Motion(Protocol):
    """A motion from time 0 on. Times are float64 seconds of shape (n,); results have shape (n, 3)."""

    ends: float  # seconds after which nothing moves any more; infinite if it continues

    @property
    def truth(self) -> Motion:
        """The body's true motion, if its reported attitude is coarser; else the same motion."""
        return self

    def attitude(self, times: Floats) -> Floats:
        """Return phi, theta, psi in rad."""
        ...

    def rates(self, times: Floats) -> Floats:
        """Return the true rates of phi, theta, psi in rad/s; at a corner, those after it."""
        ...

    def acceleration(self, times: Floats) -> Floats:
        """Return ax, ay, az in g."""
        ...


@runtime_checkable
class SingleTimes(Protocol):
    """A motion that can also compute a single time without numpy, whose import takes longer than many runs.

    Its values are within 1e-12 of those of the arrays.
    """

    def at(self, seconds: float) -> tuple[float, ...]:
        """Return the six values at a time, rad and g."""
        ...


class MotionKind(Protocol):
    """The definitions of every kind of motion."""

    Settings: type[object]

    def motion(self, settings: object) -> Motion: ...


@cache
def kinds() -> dict[str, MotionKind]:
    """Return every kind of motion, by the name of its file."""
    return {name: cast(MotionKind, module) for name, module in modules_with("motion", __name__, __path__).items()}


@cache
def kind_named(name: str) -> MotionKind | None:
    """Return the kind of motion of that name; None if there is none."""
    return cast("MotionKind | None", module_with("motion", __name__, __path__, name))


def sampled(motion: Motion, times: Floats) -> Floats:
    """Return the six values at these times, shape (n, 6): rad and g. Raise BadMotion for the first out of range."""
    import numpy as np

    values = np.hstack([motion.attitude(times), motion.acceleration(times)])
    for first, limit, unit in ((0, ANGLE_RANGE, "rad"), (3, ACCELERATION_RANGE, "g")):
        wrong = np.argwhere(~(np.abs(values[:, first : first + 3]) <= limit))  # so that NaN is wrong too
        if len(wrong):
            row, column = wrong[0][0], wrong[0][1] + first
            raise BadMotion(
                f"motion: {VALUES[column]} is {values[row, column]:.6g} {unit} at {times[row]:.6g} s; "
                f"expected {shown(limit, unit)}"
            )
    return values
