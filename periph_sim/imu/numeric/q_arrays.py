"""Fixed point for arrays: the arithmetic of q.py element by element, with 32-bit values in int64[n]."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .arithmetic import Rounding
from .float64_arrays import Floats
from .q import (
    A0,
    A1,
    A2,
    COSINE,
    HIGH,
    LOW,
    SINE,
    Overflow,
    Product,
    Q,
    RoundedQ,
    arctangent,
    factor_of,
    quarter_turn,
    sine_and_cosine,
)
from .tables import PARABOLAS

Ints = NDArray[np.int64]

SINES_AT, COSINES_AT, A0_AT, A1_AT, A2_AT = (np.array(table, dtype=np.int64) for table in (SINE, COSINE, A0, A1, A2))


def atan2_of_arrays(y: Ints, x: Ints, bits: int) -> Ints:
    """Return the angles of the points (x, y); 0 for the origin."""
    wide, high = np.abs(x), np.abs(y)
    steep = wide < high
    under = np.maximum(wide, high)
    ratio = (np.minimum(wide, high) << bits) // np.maximum(under, 1)
    index = np.minimum(ratio * PARABOLAS >> bits, PARABOLAS - 1)
    angle = arctangent(ratio, index, bits, A0_AT, A1_AT, A2_AT)
    quarter = quarter_turn(bits)
    up = quarter + np.where(x >= 0, -angle, angle)
    angle = np.where(steep, up, np.where(x < 0, 2 * quarter - angle, angle))
    signed: Ints = np.where(y >= 0, angle, -angle)
    return signed


def root_of_arrays(square: NDArray[np.uint64]) -> Ints:
    """Return roots of whole numbers up to 2**63, rounded to nearest.

    The root in float64 is corrected by 1 if needed.
    """
    near = np.rint(np.sqrt(square.astype(np.float64))).astype(np.uint64)
    near = near - ((near > 0) & (square <= near * near - near)).astype(np.uint64)
    near = near + (square > near * near + near).astype(np.uint64)
    return near.astype(np.int64)


class QArrays:
    """The arithmetic of a Q format for arrays. T = int64[n]: value * 2**bits.

    overflown: True for elements of which a result did not fit, bool[n].
    """

    def __init__(self, bits: int = 16, overflow: Overflow = "wrap", product: Product = "cut") -> None:
        self._one_number = (Q if product == "cut" else RoundedQ)(bits, overflow)  # for constants, the name and checks
        self.name = self._one_number.name
        self.bits = bits
        self.overflown = np.zeros((), dtype=np.bool_)
        self._saturates = overflow == "saturate"
        self._half = 1 << (bits - 1) if product == "rounded" else 0

    def constant(self, value: float) -> Ints:
        return np.asarray(self._one_number.constant(value), dtype=np.int64)

    def value(self, x: Ints) -> Floats:
        return x / float(1 << self.bits)

    def scaled(self, count: Ints, lsb: float) -> Ints:
        factor, shift = factor_of(lsb, self.bits)
        return self._fit(count * factor >> shift)

    def add(self, x: Ints, y: Ints) -> Ints:
        return self._fit(x + y)

    def sub(self, x: Ints, y: Ints) -> Ints:
        return self._fit(x - y)

    def mul(self, x: Ints, y: Ints) -> Ints:
        return self._fit((x * y + self._half) >> self.bits)

    def div(self, x: Ints, y: Ints) -> Ints:
        by_zero = np.broadcast_to(y == 0, np.broadcast(x, y).shape)
        quotient = ((x << (self.bits + 1)) // np.where(y == 0, 1, y) + 1) >> 1
        return self._saturated(np.where(by_zero, HIGH + 1, quotient))

    def neg(self, x: Ints) -> Ints:
        return self._fit(-x)

    def sqrt(self, x: Ints) -> Ints:
        return root_of_arrays((np.maximum(x, 0) << self.bits).astype(np.uint64))

    def mag(self, x: Ints, y: Ints) -> Ints:
        return self._saturated(root_of_arrays((x * x).astype(np.uint64) + (y * y).astype(np.uint64)))

    def sincos(self, x: Ints) -> tuple[Ints, Ints]:
        return sine_and_cosine(x, self.bits, SINES_AT, COSINES_AT)

    def atan(self, x: Ints) -> Ints:
        return atan2_of_arrays(x, np.full_like(x, 1 << self.bits), self.bits)

    def atan2(self, y: Ints, x: Ints) -> Ints:
        return atan2_of_arrays(y, x, self.bits)

    def select_greater(self, x: Ints, y: Ints, yes: Ints, no: Ints) -> Ints:
        return np.where(x > y, yes, no)

    def clamp(self, x: Ints, low: Ints, high: Ints) -> Ints:
        return np.clip(x, low, high)

    def to_integer(self, x: Ints, rounding: Rounding) -> Ints:
        if rounding == "nearest":
            return self._fit(x + (1 << (self.bits - 1))) >> self.bits
        if rounding == "toward zero":
            return np.where(x < 0, -(-x >> self.bits), x >> self.bits)
        return x >> self.bits

    def _saturated(self, x: Ints) -> Ints:
        return self._with_overflow(x, np.clip(x, LOW, HIGH))

    def _fit(self, x: Ints) -> Ints:
        return self._saturated(x) if self._saturates else self._with_overflow(x, ((x - LOW) & 0xFFFFFFFF) + LOW)

    def _with_overflow(self, x: Ints, fitting: Ints) -> Ints:
        over = fitting != x
        if over.any():
            self.overflown = np.logical_or(self.overflown, over)
        return fitting
