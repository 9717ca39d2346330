"""Motions of the host: attitude and acceleration as functions of time.

Each file in this folder that has a function `motion` is a kind of motion; it needs no registration. It defines

    Settings             a dataclass of the keys of [host.motion], with units (`quantities`)
    motion(settings)     the `Motion`; BadMotion for invalid settings

Angles are the usual ones of aerospace with z down: roll phi, pitch theta and yaw psi, in rad. Accelerations are linear
accelerations of the body in g, without gravity (dissertation sections 3.4 and 4.3.1).
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
    """A motion is invalid. The message names the value and the range, or the file and the line."""


class Motion(Protocol):
    """A motion from time 0 on. Times are float64 seconds of shape (n,); results have shape (n, 3)."""

    ends: float  # time in seconds after which nothing changes any more; infinite if the motion continues

    @property
    def truth(self) -> Motion:
        """The true motion of the body. It is another motion if the reported attitude is coarser than the true one."""
        return self

    def attitude(self, times: Floats) -> Floats:
        """Return phi, theta, psi in rad."""
        ...

    def rates(self, times: Floats) -> Floats:
        """Return the true rates of phi, theta, psi in rad/s. At a corner, they are those after it."""
        ...

    def acceleration(self, times: Floats) -> Floats:
        """Return ax, ay, az in g."""
        ...


@runtime_checkable
class SingleTimes(Protocol):
    """A motion that can also be evaluated at a single time without numpy, whose import takes longer than many runs.

    Its values differ from those of the arrays by less than 1e-12.
    """

    def at(self, seconds: float) -> tuple[float, ...]:
        """Return the six values at a time, in rad and g."""
        ...


class MotionKind(Protocol):
    """The definitions in the file of a kind of motion."""

    Settings: type[object]

    def motion(self, settings: object) -> Motion: ...


@cache
def kinds() -> dict[str, MotionKind]:
    """Return every kind of motion, indexed by the name of its file."""
    return {name: cast(MotionKind, module) for name, module in modules_with("motion", __name__, __path__).items()}


@cache
def kind_named(name: str) -> MotionKind | None:
    """Return the kind of motion of that name; None if there is none."""
    return cast("MotionKind | None", module_with("motion", __name__, __path__, name))


def sampled(motion: Motion, times: Floats) -> Floats:
    """Return the six values at these times in rad and g, shape (n, 6). Raise BadMotion if a value is out of range."""
    import numpy as np

    values = np.hstack([motion.attitude(times), motion.acceleration(times)])
    for first, limit, unit in ((0, ANGLE_RANGE, "rad"), (3, ACCELERATION_RANGE, "g")):
        wrong = np.argwhere(~(np.abs(values[:, first : first + 3]) <= limit))  # this form also finds NaN
        if len(wrong):
            row, column = wrong[0][0], wrong[0][1] + first
            raise BadMotion(
                f"motion: {VALUES[column]} is {values[row, column]:.6g} {unit} at {times[row]:.6g} s; "
                f"expected {shown(limit, unit)}"
            )
    return values
