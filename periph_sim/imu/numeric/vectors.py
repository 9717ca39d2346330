"""Vectors of three numbers: operations on x, y, z in an arithmetic of single numbers.

    Arithmetic[T] --vectors_of--> plus, minus, times, transformed, cross, turned, whole

Each consists of the arithmetic's own operations, in an order that is part of the result: they round and overflow.
Q implements them itself, with one call for a vector instead of one for each number.
"""

from __future__ import annotations

from typing import Any, Generic, Protocol, TypeVar

from .arithmetic import Arithmetic, Rounding
from .q import Q

T = TypeVar("T")
Triple = tuple[T, T, T]


class Vectors(Protocol[T]):
    """Operations on vectors, by their numbers x, y, z."""

    def plus(self, u: Triple[T], v: Triple[T]) -> Triple[T]:
        """Return u + v."""

    def minus(self, u: Triple[T], v: Triple[T]) -> Triple[T]:
        """Return u - v."""

    def times(self, u: Triple[T], k: T) -> Triple[T]:
        """Return u times a number."""

    def transformed(self, rows: tuple[Triple[T], ...], u: Triple[T]) -> Triple[T]:
        """Return a matrix of three rows times u."""

    def cross(self, u: Triple[T], v: Triple[T]) -> Triple[T]:
        """Return u x v."""

    def turned(self, c: T, s: T, x: T, y: T) -> tuple[T, T]:
        """Return x and y in axes turned by the angle of this cosine and sine: c x + s y, c y - s x."""

    def whole(self, u: Triple[T], low: T, high: T, rounding: Rounding) -> Triple[T]:
        """Return the nearest vector to u with numbers from low to high, as whole numbers: counts of LSB."""


class ByNumbers(Generic[T]):
    """Vector operations of an arithmetic, number by number."""

    def __init__(self, a: Arithmetic[T]) -> None:
        self._a = a

    def plus(self, u: Triple[T], v: Triple[T]) -> Triple[T]:
        add = self._a.add
        return add(u[0], v[0]), add(u[1], v[1]), add(u[2], v[2])

    def minus(self, u: Triple[T], v: Triple[T]) -> Triple[T]:
        sub = self._a.sub
        return sub(u[0], v[0]), sub(u[1], v[1]), sub(u[2], v[2])

    def times(self, u: Triple[T], k: T) -> Triple[T]:
        mul = self._a.mul
        return mul(u[0], k), mul(u[1], k), mul(u[2], k)

    def transformed(self, rows: tuple[Triple[T], ...], u: Triple[T]) -> Triple[T]:
        first, second, third = rows
        return self._dot(first, u), self._dot(second, u), self._dot(third, u)

    def _dot(self, u: Triple[T], v: Triple[T]) -> T:
        add, mul = self._a.add, self._a.mul
        return add(add(mul(u[0], v[0]), mul(u[1], v[1])), mul(u[2], v[2]))

    def cross(self, u: Triple[T], v: Triple[T]) -> Triple[T]:
        sub, mul = self._a.sub, self._a.mul
        (x, y, z), (p, q, r) = u, v
        return sub(mul(y, r), mul(z, q)), sub(mul(z, p), mul(x, r)), sub(mul(x, q), mul(y, p))

    def turned(self, c: T, s: T, x: T, y: T) -> tuple[T, T]:
        mul = self._a.mul
        return self._a.add(mul(c, x), mul(s, y)), self._a.sub(mul(c, y), mul(s, x))

    def whole(self, u: Triple[T], low: T, high: T, rounding: Rounding) -> Triple[T]:
        clamp, to_integer = self._a.clamp, self._a.to_integer
        x, y, z = clamp(u[0], low, high), clamp(u[1], low, high), clamp(u[2], low, high)
        return to_integer(x, rounding), to_integer(y, rounding), to_integer(z, rounding)


def vectors_of(a: Arithmetic[T]) -> Vectors[T]:
    """Return the vector operations of an arithmetic."""
    vectors: Any = a if isinstance(a, Q) else ByNumbers(a)
    found: Vectors[T] = vectors
    return found
