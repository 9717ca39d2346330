"""The last blocks of every sensor: from the sensed quantity to codes of its converter.

    physical + noise --> S (scale, cross-axis) --> saturation to the converter's codes --> whole LSB

Source: equations 4.4, 4.5, 4.8 (S) and the saturation block at the end of each model in section 4.3.
"""

from __future__ import annotations

from typing import Generic, TypeVar

from ..numeric.arithmetic import Arithmetic
from ..numeric.vectors import Triple, vectors_of
from .parameters import SensorParameters

T = TypeVar("T")


class Output(Generic[T]):
    def __init__(self, a: Arithmetic[T], sensor: SensorParameters) -> None:
        self._v = vectors_of(a)
        self._rows = tuple(triple(a, row) for row in sensor.matrix)
        self._low, self._high = (a.constant(limit) for limit in sensor.limits)
        self._rounding = sensor.rounding

    def codes(self, sensed: Triple[T]) -> Triple[T]:
        """Return LSB on each axis, within the converter's codes."""
        return self._v.whole(self._v.transformed(self._rows, sensed), self._low, self._high, self._rounding)


def triple(a: Arithmetic[T], values: tuple[float, float, float]) -> Triple[T]:
    """Return three constants."""
    return a.constant(values[0]), a.constant(values[1]), a.constant(values[2])
