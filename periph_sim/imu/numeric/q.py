"""Fixed point as in TI's IQmath: 32-bit numbers with a given number of fraction bits, one at a time.

    value * 2**bits --> int32 --> add, mul, sin ... --> int32

Overflows wrap, as in plain additions and IQmpy, or saturate, as in additions with the CPU's overflow mode (OVM) and in
IQrsmpy. Products are truncated (IQmpy) or rounded (IQrmpy, IQrsmpy). `overflows` counts the results that did not fit
and so wrapped or saturated.

IQdiv, IQsqrt and IQmag always saturate. x/0 is the largest number, also for 0/0 and for negative x.

    sine, cosine   a table of 512 sines in Q30 and a cubic; the result is truncated to Q (IQNcos.asm)
    arctangent     a quotient that is truncated to Q, and 64 parabolas in Q30; the result is truncated to Q
    quotient       rounded to nearest and saturated (IQNdiv.asm)
    root           rounded to nearest; the root of a negative number is 0 (IQNsqrt.asm)

Source: comments in the sources of IQmath V1.4 for the C28x. In these sources, division and root take a first value from
a table and improve it by two Newton steps; the comments call the results 32-bit accurate. Here, division and root are
exact before rounding. Everything else follows the sources step by step; only the coefficients of the parabolas are
fitted (see `tables`). `bits` is the number of fraction bits, 1 to 29.
"""

# core: compiled

from __future__ import annotations

from functools import cache, lru_cache
from math import floor, frexp, isnan, isqrt, ldexp, pi
from typing import Literal

from ...core.input_error import InputError
from ...form.c_types import BigInt
from .arithmetic import Rounding
from .tables import ARCTANGENT, COSINES, PARABOLAS, SINES, TURN

Q30 = 1 << 30
STEPS_PER_RADIAN = 0x517CC1B7  # 512 / (2 pi) in Q24
RADIANS_PER_STEP = 0x03243F6B  # 2 pi / 512 in Q32
SIXTH = 0x2AAA  # 1/6 in Q16

SINE = [round(value * Q30) for value in SINES]
COSINE = [round(value * Q30) for value in COSINES]
A0, A1, A2 = ([round(a[i] * Q30) for a in ARCTANGENT] for i in range(3))
A0[0] = max(A0[0], 0)  # The sources shift angles as unsigned numbers, so a fitted A0 below 0 is set to 0.


def sine_and_cosine(angle: int, bits: int) -> tuple[int, int]:
    """Return the sine and the cosine of an angle in rad. All three numbers have `bits` fraction bits.

    The angle is the sum of the angle of entry k of the tables and a remainder x. Entry k has the sine s and the cosine
    c. The sine of the angle is s + x (c + x (-s/2 - x c/6)), and the cosine is c + x (-s + x (-c/2 + x s/6)).
    """
    # The angle in steps of the tables, as a fixed-point number with `bits` + 24 fraction bits. It has at most 62 bits.
    exact: int = abs(angle) * STEPS_PER_RADIAN
    # The same angle with 32 fraction bits. Only its lower 41 bits are used: 9 bits for the entry, and the fraction.
    # Without the mask, the left shift would exceed 64 bits.
    exact = exact >> (bits - 8) if bits >= 8 else (exact & 0x1FF_FFFF_FFFF) << (8 - bits)
    k: int = (exact >> 32) & (TURN - 1)
    x: int = (exact & 0xFFFFFFFF) * RADIANS_PER_STEP >> 32  # the remainder x in rad, with 32 fraction bits
    s: int = SINE[k]
    c: int = COSINE[k]
    up: int = s + (x * (c + (x * ((-s >> 1) - (x * c >> 48) * SIXTH) >> 32)) >> 32) >> (30 - bits)
    along: int = c + (x * ((x * ((-c >> 1) + (x * s >> 48) * SIXTH) >> 32) - s) >> 32) >> (30 - bits)
    return up if angle >= 0 else -up, along


@cache
def quarter_turn(bits: int) -> int:
    return round(pi / 2 * (1 << bits))


def atan2_of(y: int, x: int, bits: int) -> int:
    """Return the angle of the point (x, y) in rad; 0 for the origin. All numbers have `bits` fraction bits."""
    wide, high = abs(x), abs(y)
    steep: bool = wide < high
    over, under = (wide, high) if steep else (high, wide)
    ratio = (over << bits) // under if under else 0
    index = min(ratio * PARABOLAS >> bits, PARABOLAS - 1)
    bend: int = A1[index] + (ratio * A2[index] >> bits)
    angle: int = A0[index] + (ratio * bend >> bits) >> (30 - bits)
    if steep:
        angle = quarter_turn(bits) - angle if x >= 0 else quarter_turn(bits) + angle
    elif x < 0:
        angle = 2 * quarter_turn(bits) - angle
    return angle if y >= 0 else -angle


def root_of(square: BigInt) -> int:
    """Return the root of a whole number, rounded to nearest; 0 for a negative number."""
    if square <= 0:
        return 0
    low = isqrt(square)
    return low + (square > low * low + low)


def length_of(x: BigInt, y: BigInt) -> int:
    """Return the root of x*x + y*y, rounded to nearest. The squares cannot overflow."""
    return root_of(x * x + y * y)


Overflow = Literal["wrap", "saturate"]
Triple = tuple[int, int, int]

LOW, HIGH = -(1 << 31), (1 << 31) - 1


class DoesNotFit(InputError):
    """A Q format cannot hold a constant, or its number of fraction bits is invalid. The message is one sentence."""


def nearest_in(value: float, bits: BigInt) -> BigInt:
    """Return the integer nearest to value * 2**bits. Raise DoesNotFit if it exceeds 32 bits, or for NaN."""
    if isnan(value):
        raise DoesNotFit(f"nan is no number; Q{bits} has none for it")
    raw = floor(value * (1 << bits) + 0.5) if abs(value) < 1 << 40 else HIGH + 1
    if not LOW <= raw <= HIGH:
        most = (1 << (31 - bits)) - 2.0**-bits
        raise DoesNotFit(f"{value:g} does not fit Q{bits}, which ends at {most:g}; take fewer fraction bits")
    return raw


constant_in = lru_cache(maxsize=4096)(nearest_in)  # cached, because all scenes of a case use the same constants


def factor_of(lsb: float, bits: int) -> tuple[int, int]:
    """Return a factor of 30 bits and a shift: (count * factor) >> shift is count * lsb with `bits` fraction bits.

    A factor with `bits` fraction bits would be too coarse: 1e-4 rad is 6.55 / 2**16, which Q16 rounds to 7 / 2**16.
    """
    shift = 30 - frexp(lsb)[1]
    return round(ldexp(lsb, shift)), shift - bits


class Q:
    """The arithmetic of a Q format for single numbers. T is int and means value * 2**bits.

    The methods that are called most contain the limits of 32 bits as literals, because looking up the names LOW and
    HIGH would take a tenth of their time.

    overflows: the number of results so far that did not fit the format.
    """

    name: str
    saturates: bool

    def __init__(self, bits: int = 16, overflow: Overflow = "wrap") -> None:
        if not 1 <= bits <= 29:
            raise DoesNotFit(f"Q{bits}: IQmath has angles up to pi in Q1 to Q29 only")
        self.name = f"q{bits}"
        self.bits = bits
        self.overflows = 0
        self.saturates = overflow == "saturate"
        if self.saturates:
            self.name += " saturating"
        self._factors: dict[float, tuple[int, int]] = {}
        self._one, self._half = 1 << bits, 1 << (bits - 1)

    def constant(self, value: float) -> BigInt:
        return constant_in(value, self.bits)

    def nearest(self, value: float) -> BigInt:
        """Return the same number as `constant`, but do not cache it. This is for values that seldom occur again."""
        return nearest_in(value, self.bits)

    def value(self, x: int) -> float:
        return x / self._one

    def scaled(self, count: int, lsb: float) -> int:
        factor: int
        shift: int
        factor, shift = self._factors.get(lsb) or self._factors.setdefault(lsb, factor_of(lsb, self.bits))
        product: int = count * factor >> shift
        return product if -0x80000000 <= product <= 0x7FFFFFFF else self._overflow(product)

    def add(self, x: int, y: int) -> int:
        total = x + y
        return total if -0x80000000 <= total <= 0x7FFFFFFF else self._overflow(total)

    def sub(self, x: int, y: int) -> int:
        rest = x - y
        return rest if -0x80000000 <= rest <= 0x7FFFFFFF else self._overflow(rest)

    def mul(self, x: int, y: int) -> int:
        product = (x * y) >> self.bits
        return product if -0x80000000 <= product <= 0x7FFFFFFF else self._overflow(product)

    def div(self, x: int, y: int) -> int:
        if not y:
            self.overflows += 1
            return HIGH
        return self._saturated((((x << (self.bits + 1)) // y) + 1) >> 1)

    def neg(self, x: int) -> int:
        return self._overflow(-x) if x == LOW else -x

    def sqrt(self, x: int) -> int:
        return root_of(x << self.bits)

    def mag(self, x: int, y: int) -> int:
        return self._saturated(length_of(x, y))

    def sincos(self, x: int) -> tuple[int, int]:
        return sine_and_cosine(x, self.bits)

    def atan(self, x: int) -> int:
        return atan2_of(x, self._one, self.bits)

    def atan2(self, y: int, x: int) -> int:
        return atan2_of(y, x, self.bits)

    def select_greater(self, x: int, y: int, yes: int, no: int) -> int:
        return yes if x > y else no

    def clamp(self, x: int, low: int, high: int) -> int:
        return low if x < low else high if x > high else x

    def to_integer(self, x: int, rounding: Rounding) -> int:
        if rounding == "nearest":
            x += self._half
            return (x if x <= 0x7FFFFFFF else self._overflow(x)) >> self.bits
        if rounding == "toward zero" and x < 0:
            return -(-x >> self.bits)
        return x >> self.bits

    # Vectors: see arithmetic.py ---------------------------------------------------

    def plus(self, u: Triple, v: Triple) -> Triple:
        return self.add(u[0], v[0]), self.add(u[1], v[1]), self.add(u[2], v[2])

    def minus(self, u: Triple, v: Triple) -> Triple:
        return self.sub(u[0], v[0]), self.sub(u[1], v[1]), self.sub(u[2], v[2])

    def times(self, u: Triple, k: int) -> Triple:
        return self.mul(u[0], k), self.mul(u[1], k), self.mul(u[2], k)

    def transformed(self, rows: tuple[Triple, ...], u: Triple) -> Triple:
        first, second, third = rows
        return self._dot(first, u), self._dot(second, u), self._dot(third, u)

    def _dot(self, u: Triple, v: Triple) -> int:
        return self.add(self.add(self.mul(u[0], v[0]), self.mul(u[1], v[1])), self.mul(u[2], v[2]))

    def cross(self, u: Triple, v: Triple) -> Triple:
        x: int
        y: int
        z: int
        x, y, z = u
        p: int
        q: int
        r: int
        p, q, r = v
        return (
            self.sub(self.mul(y, r), self.mul(z, q)),
            self.sub(self.mul(z, p), self.mul(x, r)),
            self.sub(self.mul(x, q), self.mul(y, p)),
        )

    def turned(self, c: int, s: int, x: int, y: int) -> tuple[int, int]:
        return self.add(self.mul(c, x), self.mul(s, y)), self.sub(self.mul(c, y), self.mul(s, x))

    def whole(self, u: Triple, low: int, high: int, rounding: Rounding) -> Triple:
        x, y, z = self.clamp(u[0], low, high), self.clamp(u[1], low, high), self.clamp(u[2], low, high)
        return self.to_integer(x, rounding), self.to_integer(y, rounding), self.to_integer(z, rounding)

    # Results that do not fit ------------------------------------------------------

    def _saturated(self, x: int) -> int:
        if LOW <= x <= HIGH:
            return x
        self.overflows += 1
        return LOW if x < 0 else HIGH

    def _overflow(self, x: int) -> int:
        if self.saturates:
            return self._saturated(x)
        self.overflows += 1
        return ((x - LOW) & 0xFFFFFFFF) + LOW


class RoundedQ(Q):
    """A Q format whose products are rounded to nearest and not truncated."""

    def __init__(self, bits: int = 16, overflow: Overflow = "wrap") -> None:
        super().__init__(bits, overflow)
        if not self.saturates:
            self.name += " rounded"

    def mul(self, x: int, y: int) -> int:
        product = (x * y + self._half) >> self.bits
        return product if -0x80000000 <= product <= 0x7FFFFFFF else self._overflow(product)
