"""Q formats: what fits, what wraps, what saturates, and how products are rounded."""

from __future__ import annotations

from fractions import Fraction
from math import floor

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.imu.numeric.q import HIGH, LOW, DoesNotFit, Q, RoundedQ, factor_of

RAW = st.integers(LOW, HIGH)


def as_int32(x: int) -> int:
    """What a 32-bit register keeps."""
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


def test_products_are_cut_or_rounded() -> None:
    third = Q(16).constant(1 / 3)
    cut, rounded = Q(16).mul(third, third), RoundedQ(16).mul(third, third)
    assert (cut, rounded) == (7281, 7282)  # 21845**2 / 65536 = 7281.55
    assert Q(16).mul(-third, third) == -7282  # cut is toward minus infinity


def test_every_overflow_is_counted() -> None:
    a = Q(16)
    a.add(HIGH, 1), a.mul(HIGH, HIGH), a.div(1, 0), a.neg(LOW)
    assert a.overflows == 4
    a.add(1, 1)
    assert a.overflows == 4


@pytest.mark.parametrize(("bits", "value"), [(16, 32768.0), (20, -32768.0), (29, 4.0), (16, 1e30), (16, float("inf"))])
def test_a_constant_that_does_not_fit_is_refused(bits: int, value: float) -> None:
    with pytest.raises(DoesNotFit, match=rf"does not fit Q{bits}, which ends at .* take fewer fraction bits"):
        Q(bits).constant(value)


def test_the_ends_of_a_format_are_constants() -> None:
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
    assert -1 - Fraction(1, 1000) <= off <= Fraction(1, 1000)  # cut, not rounded


def test_a_small_step_keeps_30_bits_though_the_format_has_three_for_it() -> None:
    factor, shift = factor_of(1e-4, 16)
    assert factor / 2 ** (shift + 16) == pytest.approx(1e-4, rel=2**-30)
    assert Q(16).constant(1e-4) / 2**16 == pytest.approx(1e-4, rel=0.07)  # 7 / 65536: 6.8 % off


@pytest.mark.parametrize(
    ("value", "nearest", "down", "to_zero"), [(2.5, 3, 2, 2), (-2.5, -2, -3, -2), (-0.2, 0, -1, 0)]
)
def test_whole_numbers(value: float, nearest: int, down: int, to_zero: int) -> None:
    a = Q(16)
    x = a.constant(value)
    whole = [a.to_integer(x, rounding) for rounding in ("nearest", "floor", "toward zero")]
    assert whole == [nearest, down, to_zero]


@pytest.mark.parametrize("edge", [LOW, HIGH])
def test_the_ends_of_a_format_are_no_overflow(edge: int) -> None:
    a = Q(16, "saturate")
    one = a.constant(1.0)
    assert (a.div(edge, one), a.add(edge, 0), a.sub(edge, 0)) == (edge, edge, edge)
    assert a.overflows == 0
    a.add(edge, 1 if edge > 0 else -1)
    assert a.overflows == 1
