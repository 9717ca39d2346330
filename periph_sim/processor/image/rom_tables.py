"""The math tables of the boot ROM at 0x3FE000 to 0x3FF27B, which TI's IQmath and fast floating-point libraries read.

    0x3FE000  sine and cosine        0x3FE9E8  rounding and limits of products
    0x3FE502  division               0x3FEB50  exponential
    0x3FE712  square root            0x3FEBDC  sine and cosine, floating point
    0x3FE824  arctangent             0x3FF0DE  arctangent and exponential, floating point

TI documents what the tables contain, but not their words, so the words are computed. All 4732 words are equal to those
in TI's published sources: the F2802x boot ROM (IQmath) and the library FPUfastRTS 1.00. Source: SPRU963A
section 1.1; F28335.cmd (addresses).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import cache
from struct import pack, unpack

PERIOD = 512  # samples in a period of sine; the table is a quarter longer, so that it contains a period of cosine, too
MANTISSAS = range(128)  # indices of the intervals, each 1/256 wide, of operands from 1/2 to 1 (division, square root)
INTERVALS = 65  # number of intervals of the arctangent, each 1/64 wide
FORMATS = range(1, 31)  # Q1 to Q30
WORD = 0xFFFF_FFFF
LOWEST = -(1 << 31)


@cache
def words() -> tuple[int, ...]:
    """Return the 16-bit words of all tables in the order of their addresses."""
    fixed = b"".join(pack("<I", number & WORD) for number in _fixed_point())
    decimals = (round(number, 12) for number in _floating_point())  # TI wrote the tables with 12 decimals
    data = fixed + b"".join(pack("<f", number) for number in decimals)
    return unpack(f"<{len(data) // 2}H", data)


def _fixed_point() -> Iterator[int]:
    yield from _scaled(_sines(math.pi), 30)
    yield from (0x4000_0000, 1, 0, WORD - 1, 0, 0, WORD)  # 2.0 in Q29, then constants that round and limit the quotient
    quotients = [256 / (128.5 + n) for n in MANTISSAS]
    yield from _scaled((0, *quotients, *(-one for one in reversed(quotients))), 29)
    yield from _scaled((1.5,), 30)
    yield from (0x8000, 0, 0xFFFF_0000, 0x7FFF)  # constants that round and limit the square root
    yield from _scaled((1, 0.5, math.sqrt(0.5), 0), 30)
    yield from _scaled((math.sqrt(256 / (128.5 + n)) for n in MANTISSAS), 30)
    yield from _scaled((2,), 29)
    for q in FORMATS:
        yield from _scaled((math.pi / 2,), q)
    yield from _scaled(_arctangents(), 30)
    for q in reversed(FORMATS):
        half = 1 << q - 1
        yield from (half, 0, WORD, half - 1, 0, -half)  # constants that round and limit a product
    for q in FORMATS:
        low = max(-q * math.log(2), LOWEST / (1 << q))
        yield from _scaled((math.log((2**31 - 1) / (1 << q)), low), q)
    yield from _scaled(_reciprocals(), 31)


def _floating_point() -> Iterator[float]:
    # TI used a value of pi that is a little too large, so the sample at pi is rounded to -0.0.
    yield from _sines(3.1415926535898)
    yield from (2, 1.570796327)
    yield from _arctangents()
    yield from _reciprocals()


def _sines(pi: float) -> Iterator[float]:
    return (math.sin(2 * pi * n / PERIOD) for n in range(PERIOD + PERIOD // 4 + 1))


def _arctangents() -> Iterator[float]:
    """Yield a0, a1, a2 for each interval. At its start, middle and end, a0 + a1*x + a2*x**2 is equal to arctan(x)."""
    for n in range(INTERVALS):
        x0, x1, x2 = ((2 * n + half) / 128 for half in range(3))
        y0, y1, y2 = math.atan(x0), math.atan(x1), math.atan(x2)
        slope = (y1 - y0) / (x1 - x0)
        a2 = ((y2 - y1) / (x2 - x1) - slope) / (x2 - x0)
        yield from (y0 - slope * x0 + a2 * x0 * x1, slope - a2 * (x0 + x1), a2)


def _reciprocals() -> Iterator[float]:
    """Yield the factors 1/n of the power series of exp, from 1/11 to 1/2."""
    return (1 / n for n in range(11, 1, -1))


def _scaled(numbers: Iterable[float], q: int) -> Iterator[int]:
    """Yield numbers in the format Qq (q bits after the binary point), rounded to nearest."""
    return (round(number * (1 << q)) for number in numbers)
