"""Q formats: range, wrapping, saturation, and rounding of products."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import floor
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.imu.numeric.q import HIGH, LOW, STEPS_PER_RADIAN, DoesNotFit, Q, RoundedQ, factor_of, root_of

RAW = st.integers(LOW, HIGH)


def as_int32(x: int) -> int:
    """Return a number as a 32-bit register keeps it."""
    return int.from_bytes((x & 0xFFFFFFFF).to_bytes(4, "big"), "big", signed=True)


@given(RAW, RAW)
def test_addition_and_products_wrap_as_32_bit_registers(x: int, y: int) -> None:
    a = Q(16)
    assert a.add(x, y) == as_int32(x + y)
    assert a.sub(x, y) == as_int32(x - y)
    assert a.mul(x, y) == as_int32(floor(Fraction(x * y, 1 << 16)))
    assert a.neg(x) == as_int32(-x)


@given(RAW, RAW)
def test_saturating_keeps_the_nearest_number(x: int, y: int) -> None:
    a = Q(16, "saturate")
    assert a.add(x, y) == min(max(x + y, LOW), HIGH)
    assert a.mul(x, y) == min(max(floor(Fraction(x * y, 1 << 16)), LOW), HIGH)


def test_products_are_truncated_or_rounded() -> None:
    third = Q(16).constant(1 / 3)
    cut, rounded = Q(16).mul(third, third), RoundedQ(16).mul(third, third)
    assert (cut, rounded) == (7281, 7282)  # 21845**2 / 65536 = 7281.55
    assert Q(16).mul(-third, third) == -7282  # truncation is toward minus infinity


def test_every_overflow_is_counted() -> None:
    a = Q(16)
    a.add(HIGH, 1), a.mul(HIGH, HIGH), a.div(1, 0), a.neg(LOW)
    assert a.overflows == 4
    a.add(1, 1)
    assert a.overflows == 4


@pytest.mark.parametrize(
    ("bits", "value", "sentence"),
    [
        *(
            (bits, value, f"{value:g} does not fit Q{bits}, which ends at .*; take fewer fraction bits")
            for bits, value in ((16, 32768.0), (20, -32768.0), (29, 4.0), (16, float("inf")), (16, -float("inf")))
        ),
        (16, float("nan"), "nan is no number; Q16 has none for it"),
    ],
)
def test_a_constant_that_does_not_fit_is_refused(bits: int, value: float, sentence: str) -> None:
    with pytest.raises(DoesNotFit, match=f"^{sentence}"):
        Q(bits).constant(value)


def test_the_limits_of_a_format_are_valid_constants() -> None:
    assert Q(16).constant(32767.99998) == HIGH
    assert Q(16).constant(-32768.0) == LOW


@pytest.mark.parametrize("bits", [0, 30, -3])
def test_formats_that_iqmath_lacks_are_refused(bits: int) -> None:
    with pytest.raises(DoesNotFit, match="Q1 to Q29"):
        Q(bits)


@given(st.integers(-32768, 32767), st.integers(4, 20))
def test_counts_of_a_frame_are_scaled_to_one_unit(count: int, bits: int) -> None:
    a = Q(bits)
    off = a.scaled(count, 1e-4) - count * Fraction(1, 10_000) * (1 << bits)
    assert -1 - Fraction(1, 1000) <= off <= Fraction(1, 1000)  # truncated, not rounded


def test_a_small_scale_keeps_30_bits_although_the_format_has_three_for_it() -> None:
    factor, shift = factor_of(1e-4, 16)
    assert factor / 2 ** (shift + 16) == pytest.approx(1e-4, rel=2**-30)
    assert Q(16).constant(1e-4) / 2**16 == pytest.approx(1e-4, rel=0.07)  # 7 / 65536, which is 6.8 % off


@pytest.mark.parametrize(
    ("value", "nearest", "down", "to_zero"), [(2.5, 3, 2, 2), (-2.5, -2, -3, -2), (-0.2, 0, -1, 0)]
)
def test_rounding_to_integers(value: float, nearest: int, down: int, to_zero: int) -> None:
    a = Q(16)
    x = a.constant(value)
    whole = [a.to_integer(x, rounding) for rounding in ("nearest", "floor", "toward zero")]
    assert whole == [nearest, down, to_zero]


@pytest.mark.parametrize("edge", [LOW, HIGH])
def test_the_limits_of_a_format_are_no_overflow(edge: int) -> None:
    a = Q(16, "saturate")
    one = a.constant(1.0)
    assert (a.div(edge, one), a.add(edge, 0), a.sub(edge, 0)) == (edge, edge, edge)
    assert a.overflows == 0
    a.add(edge, 1 if edge > 0 else -1)
    assert a.overflows == 1


FORMATS = (1, 4, 7, 8, 12, 16, 20, 24, 28, 29)


def spread(bits: int, most: float, count: int = 4000) -> np.ndarray:
    """Return raw numbers from -most to most, limited by the format."""
    most = min(most, 2.0 ** (31 - bits) - 1)
    return np.random.default_rng(bits).integers(-int(most * 2**bits), int(most * 2**bits), count)


def each(operation: Callable[..., Any], *columns: np.ndarray) -> np.ndarray:
    """Return the results of an operation for each row of the columns."""
    return np.array([operation(*row) for row in zip(*(column.tolist() for column in columns), strict=True)])


@pytest.mark.parametrize("bits", FORMATS)
def test_sine_and_cosine_are_within_one_unit_or_29_bits(bits: int) -> None:
    """IQNcos.asm has about 29 bits; truncation to the format adds less than one of its units."""
    angles = spread(bits, 20.0)
    sine, cosine = each(Q(bits).sincos, angles).T
    allowed = 2.0**-bits + 2.0**-29 + 20 * 2.0**-25 / 81.5  # the unit, the table, and the constant 512 / 2 pi
    assert np.abs(sine / 2**bits - np.sin(angles / 2**bits)).max() <= allowed
    assert np.abs(cosine / 2**bits - np.cos(angles / 2**bits)).max() <= allowed


@pytest.mark.parametrize("bits", FORMATS)
def test_the_error_of_atan2_is_that_of_the_truncated_quotient_and_its_parabola(bits: int) -> None:
    y, x = spread(bits, 3.0), np.roll(spread(bits, 3.0), 1)
    angle = each(Q(bits).atan2, y, x)
    off = np.abs(angle / 2**bits - np.arctan2(y, x))
    assert off.max() <= 3 * 2.0**-bits + 8e-8


@pytest.mark.parametrize("bits", FORMATS)
def test_roots_magnitudes_and_quotients_are_rounded_to_nearest(bits: int) -> None:
    a, one = Q(bits), 2.0**bits
    x, y = spread(bits, 2.0), np.roll(spread(bits, 2.0), 1)
    assert np.abs(each(a.sqrt, np.abs(x)) / one - np.sqrt(np.abs(x) / one)).max() <= 0.501 / one
    assert np.abs(each(a.mag, x, y) / one - np.hypot(x, y) / one).max() <= 0.501 / one
    large = np.abs(y) > one  # so that the quotient fits
    assert large.any() or bits > 28
    assert (np.abs(each(a.div, x, y) / one - x / np.where(large, y, 1))[large] <= 0.501 / one).all()


@pytest.mark.parametrize(
    ("y", "x", "angle"),
    [
        (0, 0, 0.0),
        (0, 1, 0.0),
        (1, 0, np.pi / 2),
        (0, -1, np.pi),
        (-1, 0, -np.pi / 2),
        (1, 1, np.pi / 4),
        (-1, -1, -2.35619),
    ],
)
def test_atan2_at_the_axes_and_diagonals(y: int, x: int, angle: float) -> None:
    a = Q(16)
    assert a.value(a.atan2(y << 16, x << 16)) == pytest.approx(angle, abs=4 / 2**16)


def test_division_by_0_gives_the_largest_number_as_in_iqndiv() -> None:
    a = Q(16)
    assert [a.div(x, 0) for x in (5, 0, -5)] == [HIGH] * 3


def test_root_of_a_negative_number_is_0_and_magnitude_saturates() -> None:
    a = Q(16)
    assert a.sqrt(-1) == 0
    assert a.mag(HIGH, HIGH) == HIGH == a.mag(LOW, LOW)


@given(st.integers(2, 1 << 31), st.integers(-1, 1))
def test_large_roots_beyond_the_precision_of_float64_are_rounded_to_nearest(root: int, beside: int) -> None:
    """The root n - 1/2 squared is n * n - n + 1/4: one integer below is rounded down, one above is rounded up."""
    square = root * root - root + beside
    assert root_of(square) == (root - 1 if beside < 1 else root)


@pytest.mark.parametrize("bits", FORMATS)
@pytest.mark.parametrize("angle", [LOW, LOW + 1, HIGH, HIGH - 1, 1, -1])
def test_sine_of_a_number_of_any_width(bits: int, angle: int) -> None:
    """In small formats the angle in steps of the table needs more than 64 bits; the upper ones are whole turns."""
    steps = abs(angle) * STEPS_PER_RADIAN
    q32 = steps >> bits - 8 if bits >= 8 else steps << 8 - bits
    turn = q32 % (512 << 32) / (512 << 32)
    sine, cosine = Q(bits).sincos(angle)
    assert abs(sine / 2**bits - np.sin(2 * np.pi * turn) * (1 if angle > 0 else -1)) <= 2.0**-bits + 2.0**-28
    assert abs(cosine / 2**bits - np.cos(2 * np.pi * turn)) <= 2.0**-bits + 2.0**-28
