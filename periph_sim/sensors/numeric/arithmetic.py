"""What a model may compute with: numbers of one kind go in, numbers of the same kind come out.

    equations --add, mul, sin ...--> Arithmetic[T] --> float64, float32, Q16, arrays of them, or counts

A model is written once, against this protocol. T is whatever an arithmetic keeps its numbers
in: a float, an int that stands for value * 2**16, an array of either. Angles are in radians.
"""

from __future__ import annotations

from typing import Any, Literal, Protocol, TypeVar

T = TypeVar("T")

Rounding = Literal["nearest", "floor", "toward zero"]


class Arithmetic(Protocol[T]):
    """One kind of numbers and the operations on them. Nothing raises for a value: each kind says what it gives instead.

    name: for tables. constant is for what a compiler would have computed: it costs nothing at run time.
    """

    name: str

    def constant(self, value: float) -> T:
        """The number nearest to `value`."""

    def value(self, x: T) -> Any:
        """What a number of this kind stands for: float, or float64[n]."""

    def scaled(self, count: T, lsb: float) -> T:
        """What a whole number of steps of `lsb` stands for: an int16 of a host frame, say."""

    def add(self, x: T, y: T) -> T: ...
    def sub(self, x: T, y: T) -> T: ...
    def mul(self, x: T, y: T) -> T: ...
    def div(self, x: T, y: T) -> T: ...
    def neg(self, x: T) -> T: ...
    def sqrt(self, x: T) -> T: ...

    def mag(self, x: T, y: T) -> T:
        """The square root of x**2 + y**2, without forming the squares in this kind of numbers."""

    def sincos(self, x: T) -> tuple[T, T]:
        """Sine and cosine of an angle: what needs one here needs the other."""

    def atan(self, x: T) -> T: ...

    def atan2(self, y: T, x: T) -> T:
        """The angle of the point (x, y), -pi to pi."""

    def select_greater(self, x: T, y: T, yes: T, no: T) -> T:
        """`yes` where x > y, else `no`."""

    def clamp(self, x: T, low: T, high: T) -> T:
        """The nearest number to x from low to high."""

    def to_integer(self, x: T, rounding: Rounding) -> T:
        """A whole number, kept as such: a count of LSB, no longer a number of this kind."""
