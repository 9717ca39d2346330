"""Check that attitude, acceleration and noise are finite; NotFinite otherwise.

Without this check a NaN would have a different effect in each arithmetic: 0 LSB in float64, full scale in float32.
"""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .imu import Noise

ATTITUDE = ("attitude, roll", "attitude, pitch", "attitude, yaw")
ACCELERATION = ("acceleration, x", "acceleration, y", "acceleration, z")
NOISE = tuple(
    f"noise of the {chip}, {axis}" for chip in ("gyroscope", "accelerometer", "magnetometer") for axis in "xyz"
)
INPUTS = (*ATTITUDE, *ACCELERATION, *NOISE)


class NotFinite(ValueError):
    """An input of the models that is NaN or infinite. axis: such as "attitude, pitch"; index: of the sample."""

    def __init__(self, axis: str, value: object, index: int | None = None) -> None:
        where = "" if index is None else f" at sample {index}"
        super().__init__(f"{axis}: {value}{where}; expected a finite number")
        self.axis = axis
        self.index = index


def inputs_of(attitude: Any, acceleration: Any, noise: Noise[Any] | None) -> tuple[Any, ...]:
    """Return the values in the order of INPUTS; six of them without noise."""
    return (*attitude, *acceleration, *(axis for chip in noise or () for axis in chip))


def check_sample(attitude: Any, acceleration: Any, noise: Noise[Any]) -> None:
    """Check one sample, in numbers of any arithmetic. NotFinite names the axis."""
    gyroscope, accelerometer, magnetometer = noise
    values = (*attitude, *acceleration, *gyroscope, *accelerometer, *magnetometer)
    if not all(map(isfinite, values)):
        axis = next(place for place, value in enumerate(values) if not isfinite(value))
        raise NotFinite(INPUTS[axis], float(values[axis]))


def check_before(attitude: tuple[float, float, float]) -> None:
    """Check the attitude one period before the first sample. NotFinite names the axis."""
    for axis, value in zip(ATTITUDE, attitude, strict=True):
        if not isfinite(value):
            raise NotFinite(f"{axis} before the first sample", value)


def check_arrays(arrays: tuple[Any, ...]) -> None:
    """Check arrays in the order of INPUTS. NotFinite names the axis and the index of the first such sample."""
    import numpy as np

    for axis, array in enumerate(arrays):
        finite = np.isfinite(array)
        if not finite.all():
            index = int(np.argmin(finite))
            raise NotFinite(INPUTS[axis], float(array[index]), index)
