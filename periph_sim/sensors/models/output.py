"""The last blocks of every sensor: what it feels goes in, codes of its converter come out.

    physical + noise --> S (scale, cross-axis) --> saturation to the converter's codes --> whole LSB

Source: equations 4.4, 4.5, 4.8 (S) and the saturation block at the end of each model in section 4.3.
"""

from __future__ import annotations

from typing import Generic, TypeVar

from ..numeric.arithmetic import Arithmetic
from .derivative import Triple
from .parameters import SensorParameters

T = TypeVar("T")


class Output(Generic[T]):
    def __init__(self, a: Arithmetic[T], sensor: SensorParameters) -> None:
        self._a = a
        self._rows = tuple(triple(a, row) for row in sensor.matrix)
        self._low, self._high = (a.constant(limit) for limit in sensor.limits)
        self._rounding = sensor.rounding

    def codes(self, felt: Triple[T]) -> Triple[T]:
        """LSB on each axis, within the converter's codes."""
        first, second, third = self._rows
        return self._code(first, felt), self._code(second, felt), self._code(third, felt)

    def _code(self, row: Triple[T], felt: Triple[T]) -> T:
        a = self._a
        exact = a.add(a.add(a.mul(row[0], felt[0]), a.mul(row[1], felt[1])), a.mul(row[2], felt[2]))
        return a.to_integer(a.clamp(exact, self._low, self._high), self._rounding)


def triple(a: Arithmetic[T], values: tuple[float, float, float]) -> Triple[T]:
    """Three constants."""
    return a.constant(values[0]), a.constant(values[1]), a.constant(values[2])


def plus(a: Arithmetic[T], u: Triple[T], v: Triple[T]) -> Triple[T]:
    """u + v."""
    return a.add(u[0], v[0]), a.add(u[1], v[1]), a.add(u[2], v[2])


def minus(a: Arithmetic[T], u: Triple[T], v: Triple[T]) -> Triple[T]:
    """u - v."""
    return a.sub(u[0], v[0]), a.sub(u[1], v[1]), a.sub(u[2], v[2])


def cross(a: Arithmetic[T], u: Triple[T], v: Triple[T]) -> Triple[T]:
    """u x v."""
    (x, y, z), (p, q, r) = u, v
    return (
        a.sub(a.mul(y, r), a.mul(z, q)),
        a.sub(a.mul(z, p), a.mul(x, r)),
        a.sub(a.mul(x, q), a.mul(y, p)),
    )
