"""The interface of arithmetics, with which models compute.

    equations --add, mul, sin ...--> Arithmetic[T] --> float64, float32, Q16, arrays of them, or counts

A model is written once, against this protocol. T is an arithmetic's representation of numbers: a float, an int that
stands for value * 2**16, an array of either. Angles are in radians.
"""

from __future__ import annotations

from typing import Any, Literal, Protocol, TypeVar

T = TypeVar("T")

Rounding = Literal["nearest", "floor", "toward zero"]


class Arithmetic(Protocol[T]):
    """One kind of numbers and the operations on them. No value raises an exception: each kind documents its result.

    name: for tables. constant: converts constants of the compiled program, which cost nothing at run time.
    """

    name: str

    def constant(self, value: float) -> T:
        """Return the number nearest to `value`."""

    def value(self, x: T) -> Any:
        """Return the value of a number of this kind: float, or float64[n]."""

    def scaled(self, count: T, lsb: float) -> T:
        """Convert a whole number of steps of `lsb`, such as an int16 of a host frame."""

    def add(self, x: T, y: T) -> T: ...
    def sub(self, x: T, y: T) -> T: ...
    def mul(self, x: T, y: T) -> T: ...
    def div(self, x: T, y: T) -> T: ...
    def neg(self, x: T) -> T: ...
    def sqrt(self, x: T) -> T: ...

    def mag(self, x: T, y: T) -> T:
        """Return the square root of x**2 + y**2, without forming the squares in this kind of numbers."""

    def sincos(self, x: T) -> tuple[T, T]:
        """Return sine and cosine of an angle: all models need both."""

    def atan(self, x: T) -> T: ...

    def atan2(self, y: T, x: T) -> T:
        """Return the angle of the point (x, y), -pi to pi."""

    def select_greater(self, x: T, y: T, yes: T, no: T) -> T:
        """Return `yes` where x > y, else `no`."""

    def clamp(self, x: T, low: T, high: T) -> T:
        """Return the nearest number to x from low to high."""

    def to_integer(self, x: T, rounding: Rounding) -> T:
        """Return a whole number: a count of LSB, no longer a number of this kind."""
