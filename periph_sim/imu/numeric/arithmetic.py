"""The interface of each arithmetic in which models calculate: operations on numbers and on vectors of three numbers.

    equations --add, mul, sin ...--> Arithmetic[T] --> float64, arrays of float32, Q16 ...

A model is written once, with the operations of this interface. T is an arithmetic's representation of numbers: a float,
an array of float32, or an int that means value * 2**bits. `models.counts` wraps an arithmetic to count its operations.
Angles are in radians.
"""

from __future__ import annotations

from typing import Any, Generic, Literal, Protocol, TypeVar

T = TypeVar("T")

Triple = tuple[T, T, T]
Rounding = Literal["nearest", "floor", "toward zero"]


class Arithmetic(Protocol[T]):
    """A kind of numbers and the operations on them.

    No operation except `constant` raises an exception. Each arithmetic documents its results for special values, such
    as overflows and divisions by 0.

    name: the name of the arithmetic in tables.
    """

    name: str

    def constant(self, value: float) -> T:
        """Return the number nearest to `value`. A compiler does this conversion, so it costs no cycles at run time.

        Raise DoesNotFit if a Q format cannot hold the value.
        """

    def value(self, x: T) -> Any:
        """Return the value of a number of this kind as a float, or as float64[n] if T is an array."""

    def scaled(self, count: T, lsb: float) -> T:
        """Return count * lsb for a whole number, such as an int16 of a host frame."""

    def add(self, x: T, y: T) -> T: ...
    def sub(self, x: T, y: T) -> T: ...
    def mul(self, x: T, y: T) -> T: ...
    def div(self, x: T, y: T) -> T: ...
    def neg(self, x: T) -> T: ...
    def sqrt(self, x: T) -> T: ...

    def mag(self, x: T, y: T) -> T:
        """Return the square root of x**2 + y**2. Except in float32, the squares cannot overflow."""

    def sincos(self, x: T) -> tuple[T, T]:
        """Return the sine and the cosine of an angle."""

    def atan(self, x: T) -> T: ...

    def atan2(self, y: T, x: T) -> T:
        """Return the angle of the point (x, y), from -pi to pi."""

    def select_greater(self, x: T, y: T, yes: T, no: T) -> T:
        """Return `yes` if x > y, else `no`; for arrays, element by element."""

    def clamp(self, x: T, low: T, high: T) -> T:
        """Return x limited to the range from low to high."""

    def to_integer(self, x: T, rounding: Rounding) -> T:
        """Round x to a whole number. In a Q format, the result is a plain int, which does not mean value * 2**bits."""


class Vectors(Generic[T]):
    """Operations on vectors of three numbers x, y, z.

    Each vector operation consists of operations on numbers, which round and overflow. So the order of these operations
    affects the result.
    """

    def __init__(self, a: Arithmetic[T]) -> None:
        self._a = a

    def plus(self, u: Triple[T], v: Triple[T]) -> Triple[T]:
        """Return u + v."""
        add = self._a.add
        return add(u[0], v[0]), add(u[1], v[1]), add(u[2], v[2])

    def minus(self, u: Triple[T], v: Triple[T]) -> Triple[T]:
        """Return u - v."""
        sub = self._a.sub
        return sub(u[0], v[0]), sub(u[1], v[1]), sub(u[2], v[2])

    def times(self, u: Triple[T], k: T) -> Triple[T]:
        """Return u times the number k."""
        mul = self._a.mul
        return mul(u[0], k), mul(u[1], k), mul(u[2], k)

    def transformed(self, rows: tuple[Triple[T], ...], u: Triple[T]) -> Triple[T]:
        """Return the product of a matrix with u. rows: the three rows of the matrix."""
        first, second, third = rows
        return self._dot(first, u), self._dot(second, u), self._dot(third, u)

    def _dot(self, u: Triple[T], v: Triple[T]) -> T:
        add, mul = self._a.add, self._a.mul
        return add(add(mul(u[0], v[0]), mul(u[1], v[1])), mul(u[2], v[2]))

    def cross(self, u: Triple[T], v: Triple[T]) -> Triple[T]:
        """Return u x v."""
        sub, mul = self._a.sub, self._a.mul
        (x, y, z), (p, q, r) = u, v
        return sub(mul(y, r), mul(z, q)), sub(mul(z, p), mul(x, r)), sub(mul(x, q), mul(y, p))

    def turned(self, c: T, s: T, x: T, y: T) -> tuple[T, T]:
        """Return x and y in axes that are rotated by the angle with cosine c and sine s: c x + s y, c y - s x."""
        mul = self._a.mul
        return self._a.add(mul(c, x), mul(s, y)), self._a.sub(mul(c, y), mul(s, x))

    def whole(self, u: Triple[T], low: T, high: T, rounding: Rounding) -> Triple[T]:
        """Limit the numbers of u to the range from low to high, and round them to whole numbers (`to_integer`)."""
        clamp, to_integer = self._a.clamp, self._a.to_integer
        x, y, z = clamp(u[0], low, high), clamp(u[1], low, high), clamp(u[2], low, high)
        return to_integer(x, rounding), to_integer(y, rounding), to_integer(z, rounding)


def vectors_of(a: Arithmetic[T]) -> Vectors[T]:
    """Return the vector operations of an arithmetic.

    `Q` implements these operations itself, with one call per vector instead of one call per number.
    """
    vectors: Any = a if hasattr(a, "plus") else Vectors(a)
    found: Vectors[T] = vectors
    return found
