"""Arithmetic of the FPU: bits of float32 go in; bits of the rounded result come out, with underflow and overflow.

Exact integers in between, rounded once, to the nearest even or towards zero. Denormal operands and results are 0, NaN
counts as infinity; overflow gives infinity. Source: SPRUEO2A section 2.3; what it leaves open is chosen so.
"""

from __future__ import annotations

from typing import NamedTuple

SIGN, EXPONENT, FRACTION = 1 << 31, 0xFF, 0x7F_FFFF
HIDDEN = 1 << 23
INFINITY = EXPONENT << 23
BIAS = 150  # of an integer mantissa of 24 bits
LARGEST = EXPONENT - BIAS - 1  # exponent of such a mantissa
MANTISSA_BITS = 24


class Rounded(NamedTuple):
    bits: int
    underflow: bool = False
    overflow: bool = False


def is_zero(bits: int) -> bool:
    return not bits >> 23 & EXPONENT


def is_infinite(bits: int) -> bool:
    return bits >> 23 & EXPONENT == EXPONENT


def parts(bits: int) -> tuple[int, int]:
    """(signed mantissa, exponent) of a finite number."""
    if is_zero(bits):
        return 0, 0
    mantissa = bits & FRACTION | HIDDEN
    return -mantissa if bits & SIGN else mantissa, (bits >> 23 & EXPONENT) - BIAS


def rounded(mantissa: int, exponent: int, to_nearest: bool, sign_of_zero: int = 0) -> Rounded:
    """mantissa * 2 ** exponent as a float32."""
    if mantissa == 0:
        return Rounded(sign_of_zero)
    sign, size = (SIGN, -mantissa) if mantissa < 0 else (0, mantissa)
    shift = size.bit_length() - MANTISSA_BITS
    if shift > 0:
        rest, half = size & (1 << shift) - 1, 1 << shift - 1
        size >>= shift
        size += to_nearest and (rest > half or (rest == half and size & 1))
    else:
        size <<= -shift
    exponent += shift
    if size >> MANTISSA_BITS:
        size, exponent = size >> 1, exponent + 1
    if exponent > LARGEST:
        return Rounded(sign | INFINITY, overflow=True)
    if exponent + BIAS < 1:
        return Rounded(sign_of_zero, underflow=True)
    return Rounded(sign | exponent + BIAS << 23 | size & FRACTION)


def add(a: int, b: int, to_nearest: bool) -> Rounded:
    if is_infinite(a) or is_infinite(b):
        return Rounded((a if is_infinite(a) else b) & SIGN | INFINITY)
    (m, e), (n, d) = parts(a), parts(b)
    least = min(e if m else d, d if n else e)
    total = (m << e - least if m else 0) + (n << d - least if n else 0)
    return rounded(total, least, to_nearest, a & b & SIGN if m == n == 0 else 0)


def subtract(a: int, b: int, to_nearest: bool) -> Rounded:
    return add(a, b ^ SIGN, to_nearest)


def multiply(a: int, b: int, to_nearest: bool) -> Rounded:
    sign = (a ^ b) & SIGN
    if is_infinite(a) or is_infinite(b):
        return Rounded(sign | INFINITY)
    (m, e), (n, d) = parts(a), parts(b)
    return rounded(m * n, e + d, to_nearest, sign)


def from_integer(value: int, to_nearest: bool) -> int:
    return rounded(value, 0, to_nearest).bits


def to_integer(bits: int, least: int, most: int, nearest: bool = False) -> int:
    """Towards zero or to the nearest even, kept within bounds."""
    if is_infinite(bits):
        return least if bits & SIGN else most
    mantissa, exponent = parts(bits)
    size = abs(mantissa)
    if exponent >= 0:
        size <<= exponent
    else:
        rest, half = size & (1 << -exponent) - 1, 1 << -exponent - 1
        size >>= -exponent
        size += nearest and (rest > half or (rest == half and size & 1))
    return max(least, min(most, -size if mantissa < 0 else size))


def fraction(bits: int) -> int:
    """What is behind the binary point, with the number's sign."""
    if is_infinite(bits):
        return 0
    mantissa, exponent = parts(bits)
    if exponent >= 0:
        return 0
    size = abs(mantissa) & (1 << -exponent) - 1
    return rounded(-size if mantissa < 0 else size, exponent, True).bits


def order(bits: int) -> int:
    """A number that compares as the float does: zeros and denormals alike, NaN as infinity."""
    if is_zero(bits):
        return 0
    size = min(bits & ~SIGN, INFINITY)
    return -size if bits & SIGN else size


def estimate_of_inverse(bits: int) -> Rounded:
    """1 / x to 8 bits; the bits of TI's table are not published."""
    sign = bits & SIGN
    if is_zero(bits):
        return Rounded(sign | INFINITY, overflow=True)
    if is_infinite(bits):
        return Rounded(sign, underflow=True)
    mantissa, exponent = parts(bits)
    quotient = (1 << 32) // abs(mantissa)  # 2 ** 8 to 2 ** 9
    return rounded(-quotient if sign else quotient, -32 - exponent, True, sign)


def estimate_of_inverse_root(bits: int) -> Rounded:
    """1 / sqrt(x) to 8 bits; of a negative number 0."""
    from math import isqrt

    if is_zero(bits):
        return Rounded(bits & SIGN | INFINITY, overflow=True)
    if bits & SIGN or is_infinite(bits):
        return Rounded(0, underflow=is_infinite(bits) and not bits & SIGN)
    mantissa, exponent = parts(bits)
    if exponent & 1:
        mantissa, exponent = mantissa << 1, exponent - 1
    return rounded((1 << 21) // isqrt(mantissa), -21 - exponent // 2, True)
