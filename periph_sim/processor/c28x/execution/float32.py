"""Arithmetic of the FPU on float32 bits, with rounding, underflow and overflow.

The exact result, an integer times a power of 2, is rounded once, to nearest even or towards zero. Denormal operands and
results are 0, NaN is treated as infinity, and an overflow gives infinity. Bits 31:0 of a result are the float32. Above
them is the bit UNDERFLOW or OVERFLOW, if that has occurred.

Source: SPRUEO2A section 2.3. Details that the manual does not specify are chosen here.
"""

# core: compiled

from __future__ import annotations

from math import isqrt

SIGN, EXPONENT, FRACTION = 1 << 31, 0xFF, 0x7F_FFFF
HIDDEN = 1 << 23
INFINITY = EXPONENT << 23
BIAS = 150  # a float32 is an integer mantissa of 24 bits times 2 ** (exponent field - BIAS)
LARGEST = EXPONENT - BIAS - 1  # largest exponent of 2 by which the integer mantissa of a finite float32 is multiplied
MANTISSA_BITS = 24
APART = 32  # if the exponents of two summands differ by more, the smaller summand only affects the rounding

BITS = (1 << 32) - 1
UNDERFLOW, OVERFLOW = 1 << 32, 1 << 33
TOP, TOP_BIT = 1 << 62, 62  # `TOP >> TOP_BIT - n` replaces `1 << n`, which has only 32 bits when compiled


def is_zero(bits: int) -> bool:  # core: noexcept
    return not bits >> 23 & EXPONENT


def is_infinite(bits: int) -> bool:  # core: noexcept
    return bits >> 23 & EXPONENT == EXPONENT


def mantissa_of(bits: int) -> int:  # core: noexcept
    """Return the signed 24-bit mantissa of a finite number; 0 for zeros and denormals."""
    if not bits >> 23 & EXPONENT:
        return 0
    mantissa = bits & FRACTION | HIDDEN
    return -mantissa if bits & SIGN else mantissa


def exponent_of(bits: int) -> int:  # core: noexcept
    """Return the exponent e for which the number is `mantissa_of(bits)` * 2 ** e."""
    return (bits >> 23 & EXPONENT) - BIAS


def width(value: int) -> int:  # core: noexcept
    """Return the bit length of a positive number of at most 63 bits."""
    bits = 1
    if value >> 32:
        value, bits = value >> 32, 33
    if value >> 16:
        value, bits = value >> 16, bits + 16
    if value >> 8:
        value, bits = value >> 8, bits + 8
    if value >> 4:
        value, bits = value >> 4, bits + 4
    if value >> 2:
        value, bits = value >> 2, bits + 2
    return bits + (value >> 1)


def shifted(size: int, shift: int, to_nearest: bool) -> int:  # core: noexcept
    """Return a positive number shifted right by 1 to 62, rounded to nearest even or, otherwise, towards zero."""
    half = TOP >> TOP_BIT + 1 - shift
    rest = size & 2 * half - 1
    size >>= shift
    return size + 1 if to_nearest and (rest > half or (rest == half and size & 1)) else size


def rounded(mantissa: int, exponent: int, to_nearest: bool, sign_of_zero: int = 0) -> int:
    """Return mantissa * 2 ** exponent as a float32, with UNDERFLOW or OVERFLOW if that occurs.

    mantissa: a signed number of up to 62 bits.
    to_nearest: True to round to nearest even, False to round towards zero.
    sign_of_zero: the bits to return for a result of 0 or an underflow: 0 or SIGN.
    """
    if mantissa == 0:
        return sign_of_zero
    sign = SIGN if mantissa < 0 else 0
    size = -mantissa if mantissa < 0 else mantissa
    shift = width(size) - MANTISSA_BITS
    size = shifted(size, shift, to_nearest) if shift > 0 else size << -shift
    exponent += shift
    if size >> MANTISSA_BITS:
        size, exponent = size >> 1, exponent + 1
    if exponent > LARGEST:
        return sign | INFINITY | OVERFLOW
    if exponent + BIAS < 1:
        return sign_of_zero | UNDERFLOW
    return sign | exponent + BIAS << 23 | size & FRACTION


def sum_of(a: int, b: int, to_nearest: bool) -> int:
    if is_infinite(a) or is_infinite(b):
        return (a if is_infinite(a) else b) & SIGN | INFINITY
    if exponent_of(a) < exponent_of(b):
        a, b = b, a
    larger, smaller, apart = mantissa_of(a), mantissa_of(b), exponent_of(a) - exponent_of(b)
    if larger == 0:
        return a & b & SIGN
    if smaller == 0:
        return rounded(larger, exponent_of(a), to_nearest)
    if apart > APART:
        smaller = -1 if smaller < 0 else 1
        apart = APART
    return rounded(larger * (TOP >> TOP_BIT - apart) + smaller, exponent_of(a) - apart, to_nearest)


def difference_of(a: int, b: int, to_nearest: bool) -> int:
    return sum_of(a, b ^ SIGN, to_nearest)


def product_of(a: int, b: int, to_nearest: bool) -> int:
    sign = (a ^ b) & SIGN
    if is_infinite(a) or is_infinite(b):
        return sign | INFINITY
    return rounded(mantissa_of(a) * mantissa_of(b), exponent_of(a) + exponent_of(b), to_nearest, sign)


def from_integer(value: int, to_nearest: bool) -> int:
    return rounded(value, 0, to_nearest)


def to_integer(bits: int, least: int, most: int, nearest: bool = False) -> int:
    """Return a float32 as an integer, limited to `least` and `most`, which have up to 32 bits.

    nearest: True to round to nearest even, False to round towards zero.
    """
    exponent = exponent_of(bits)
    if exponent > 8:  # the absolute value is 2 ** 32 or more, or infinity
        return least if bits & SIGN else most
    mantissa = mantissa_of(bits)
    size = -mantissa if mantissa < 0 else mantissa
    if exponent >= 0:
        size <<= exponent
    elif exponent < -MANTISSA_BITS:  # the absolute value is less than 1/2
        size = 0
    else:
        size = shifted(size, -exponent, nearest)
    if mantissa < 0:
        size = -size
    return least if size < least else most if size > most else size


def fraction(bits: int) -> int:
    """Return the fractional part of a number, with the sign of the number; +0 if there is none."""
    if is_infinite(bits):
        return 0
    mantissa, exponent = mantissa_of(bits), exponent_of(bits)
    if exponent >= 0:
        return 0
    size = -mantissa if mantissa < 0 else mantissa
    if exponent > -MANTISSA_BITS:
        size &= (1 << -exponent) - 1
    return rounded(-size if mantissa < 0 else size, exponent, True)


def order(bits: int) -> int:  # core: noexcept
    """Return an integer for the comparison of floats. Zeros and denormals are equal, and NaN equals infinity."""
    if is_zero(bits):
        return 0
    size = bits & 0x7FFF_FFFF
    if size > INFINITY:
        size = INFINITY
    return -size if bits & SIGN else size


def estimate_of_inverse(bits: int) -> int:
    """Return 1 / x with a precision of 8 bits. The chip uses an unpublished table of TI, so its results may differ."""
    sign = bits & SIGN
    if is_zero(bits):
        return sign | INFINITY | OVERFLOW
    if is_infinite(bits):
        return sign | UNDERFLOW
    quotient = UNDERFLOW // (bits & FRACTION | HIDDEN)  # 2 ** 32 divided by a 24-bit mantissa: 2 ** 8 to 2 ** 9
    return rounded(-quotient if sign else quotient, -32 - exponent_of(bits), True, sign)


def estimate_of_inverse_root(bits: int) -> int:
    """Return 1 / sqrt(x) with a precision of 8 bits; 0 for a negative number."""
    if is_zero(bits):
        return bits & SIGN | INFINITY | OVERFLOW
    if bits & SIGN:
        return 0
    if is_infinite(bits):
        return UNDERFLOW
    mantissa, exponent = bits & FRACTION | HIDDEN, exponent_of(bits)
    if exponent & 1:
        mantissa, exponent = mantissa << 1, exponent - 1
    return rounded((1 << 21) // isqrt(mantissa), -21 - exponent // 2, True)
