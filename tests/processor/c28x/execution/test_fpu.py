"""The FPU against numpy's float32 and against exact fractions."""

from __future__ import annotations

import random
import struct
from fractions import Fraction

import numpy as np
import pytest

from periph_sim.processor.c28x.execution import float32
from tests.processor.c28x.execution.flat import loaded

DRAW = random.Random(1)
EDGES = [0x0000_0000, 0x8000_0000, 0x3F80_0000, 0xBF80_0000, 0x0080_0000, 0x7F7F_FFFF, 0x3F80_0001, 0x4B80_0000]
BITS = [*EDGES, *(DRAW.getrandbits(1) << 31 | DRAW.randrange(100, 160) << 23 | DRAW.getrandbits(23) for _ in range(40))]


def number(bits: int) -> np.float32:
    return np.float32(struct.unpack("<f", struct.pack("<I", bits))[0])


def bits_of(value: object) -> int:
    return int(struct.unpack("<I", struct.pack("<f", value))[0])


def flushed(bits: int) -> int:
    """Return 0 for a denormal result, as the FPU does."""
    return bits if bits >> 23 & 0xFF else 0


@pytest.mark.parametrize(("source", "operation"), [
    ("ADDF32 R0H,R1H,R2H", np.add), ("SUBF32 R0H,R1H,R2H", np.subtract), ("MPYF32 R0H,R1H,R2H", np.multiply),
])  # fmt: skip
def test_rounding_to_nearest_even_as_in_numpy(source: str, operation: np.ufunc):
    cpu = loaded(source)
    cpu.stf = 1 << 9
    for a in BITS:
        for b in BITS:
            cpu.put_floats({1: a, 2: b})
            cpu.pc = 0x8000
            cpu.step()
            with np.errstate(all="ignore"):
                expected = bits_of(operation(number(a), number(b)))
            seen = cpu.r[0]
            assert seen & 0x7FFF_FFFF == flushed(expected) & 0x7FFF_FFFF or abs(number(expected)) < 1.2e-38, (
                f"{a:#x} {b:#x}"
            )
            assert seen & 0x7FFF_FFFF == 0 or seen >> 31 == expected >> 31


def exact(bits: int) -> Fraction:
    return Fraction(float32.mantissa_of(bits)) * Fraction(2) ** float32.exponent_of(bits)


def test_towards_zero_is_the_largest_float_that_is_not_beyond():
    for a in BITS:
        for b in BITS:
            for result, true in (
                (float32.sum_of(a, b, False), exact(a) + exact(b)),
                (float32.product_of(a, b, False), exact(a) * exact(b)),
            ):
                if result & (float32.OVERFLOW | float32.UNDERFLOW):
                    continue
                seen, above = exact(result), exact(result + 1 if result & 0x7FFF_FFFF else 0x0080_0000)
                assert abs(seen) <= abs(true)
                assert abs(true) < abs(above) or true == seen


def test_conversions():
    for value in (0.0, 0.5, 1.5, 2.5, -0.5, -1.5, -2.5, 3.7, -3.7, 32767.0, 40000.0, -40000.0, 3e9, -3e9, 7e9):
        bits = bits_of(value)
        as_integer = int(value)
        assert float32.to_integer(bits, -(1 << 31), (1 << 31) - 1) == max(-(1 << 31), min((1 << 31) - 1, as_integer))
        assert float32.to_integer(bits, -0x8000, 0x7FFF, True) == max(-0x8000, min(0x7FFF, round(value)))
        assert float32.to_integer(bits, 0, 0xFFFF) == max(0, min(0xFFFF, as_integer))
        assert number(float32.fraction(bits)) == np.float32(np.float32(value) - np.trunc(np.float32(value)))
    for integer in (0, 1, -1, 0x7FFF_FFFF, -0x8000_0000, 16777217, 0xFFFF_FFFF):
        assert float32.from_integer(integer, True) == bits_of(np.float32(integer))


def test_estimates_are_good_to_8_bits():
    for value in (1.0, 3.0, 0.1, 1e10, 7e-12, 255.9):
        inverse = number(float32.estimate_of_inverse(bits_of(value)))
        root = number(float32.estimate_of_inverse_root(bits_of(value)))
        assert abs(inverse * value - 1) < 2**-8
        assert abs(root * value**0.5 - 1) < 2**-8


def test_repeated_multiply_and_accumulate_has_two_sums():
    cpu = loaded("RPT #3\nMACF32 R7H,R3H,*XAR4++,*XAR7++")
    cpu.put_xars({4: 0x9000, 7: 0xA000})
    for at in range(4):
        cpu.store32(0x9000 + 2 * at, bits_of(float(at + 1)))
        cpu.store32(0xA000 + 2 * at, bits_of(10.0))
    for _ in range(5):
        cpu.step()
    assert [number(cpu.r[n]) for n in (3, 2, 7, 6)] == [10.0, 30.0, 20.0, 40.0]
