"""IQmath's functions on raw Q numbers, for Python ints and int64 arrays alike.

    sine, cosine   512-entry table in Q30 and a cubic, then cut to Q        29 bits (IQNcos.asm)
    arctangent     quotient in Q, 64 parabolas in Q30, then cut to Q         the quotient is cut to Q first
    quotient       rounded to nearest, saturated; x/0 is the largest number  (IQNdiv.asm)
    root           rounded to nearest; of a negative number 0                (IQNsqrt.asm)

Source: comments in the sources of IQmath V1.4 for the C28x. Division and root are two Newton steps from a table there,
which the comments call 32-bit accurate; here they are exact before rounding. All else follows the sources step by
step, so the losses of the format are the same. `bits`: fraction bits, 1 to 29. A result may be wider than 32 bits;
the caller handles that.
"""

# core: compiled

from __future__ import annotations

from functools import cache
from math import isqrt, pi
from typing import TYPE_CHECKING, Any, TypeVar

from ...form.c_types import BigInt
from .tables import ARCTANGENT, COSINES, PARABOLAS, SINES, TURN

if TYPE_CHECKING:
    from .iqmath_arrays import Ints

I = TypeVar("I", int, "Ints")  # noqa: E741

Q30 = 1 << 30
STEPS_PER_RADIAN = 0x517CC1B7  # 512 / (2 pi) in Q24
RADIANS_PER_STEP = 0x03243F6B  # 2 pi / 512 in Q32
SIXTH = 0x2AAA  # 1/6 in Q16

SINE = [round(value * Q30) for value in SINES]
COSINE = [round(value * Q30) for value in COSINES]
A0, A1, A2 = ([round(a[i] * Q30) for a in ARCTANGENT] for i in range(3))
A0[0] = max(A0[0], 0)  # the angle is cut to Q as an unsigned number


def sine_and_cosine(angle: I, bits: int, sines: Any, cosines: Any) -> tuple[I, I]:
    """Return sine and cosine. sines, cosines: the tables as a list or an array, like `angle`.

    With x the rest of the angle beyond a step of the table, s and c the table's values there:
    s + x (c + x (-s/2 - x c/6)) and c + x (-s + x (-c/2 + x s/6)), all in Q30.
    """
    exact: I = abs(angle) * STEPS_PER_RADIAN  # Q(bits + 24)
    exact = exact >> (bits - 8) if bits >= 8 else exact << (8 - bits)  # Q32
    k: I = (exact >> 32) & (TURN - 1)
    x: I = (exact & 0xFFFFFFFF) * RADIANS_PER_STEP >> 32  # radians, Q32
    s: I = sines[k]
    c: I = cosines[k]
    up: I = s + (x * (c + (x * ((-s >> 1) - (x * c >> 48) * SIXTH) >> 32)) >> 32) >> (30 - bits)
    along: I = c + (x * ((x * ((-c >> 1) + (x * s >> 48) * SIXTH) >> 32) - s) >> 32) >> (30 - bits)
    sign: I = angle >> 63  # -1 or 0: changes the sign below without a branch, for ints and arrays alike
    return (up ^ sign) - sign, along


def arctangent(ratio: I, index: I, bits: int, a0: Any, a1: Any, a2: Any) -> I:
    """Return the angle whose tangent is `ratio`, 0 to 1, by the parabola `index`."""
    start: I = a0[index]
    slope: I = a1[index]
    bend: I = a2[index]
    return start + (ratio * (slope + (ratio * bend >> bits)) >> bits) >> (30 - bits)


@cache
def quarter_turn(bits: int) -> int:
    return round(pi / 2 * (1 << bits))


def atan2_of(y: int, x: int, bits: int) -> int:
    """Return the angle of the point (x, y); 0 for the origin."""
    wide, high = abs(x), abs(y)
    steep: bool = wide < high
    over, under = (wide, high) if steep else (high, wide)
    ratio = (over << bits) // under if under else 0
    index = ratio * PARABOLAS >> bits
    angle: int = arctangent(ratio, index if index < PARABOLAS else PARABOLAS - 1, bits, A0, A1, A2)
    if steep:
        angle = quarter_turn(bits) - angle if x >= 0 else quarter_turn(bits) + angle
    elif x < 0:
        angle = 2 * quarter_turn(bits) - angle
    return angle if y >= 0 else -angle


def root_of(square: BigInt) -> int:
    """Return the root of a whole number, rounded to nearest; 0 for a negative one."""
    if square <= 0:
        return 0
    low = isqrt(square)
    return low + (square > low * low + low)


def length_of(x: BigInt, y: BigInt) -> int:
    """Return the root of x*x + y*y, without overflow."""
    return root_of(x * x + y * y)
