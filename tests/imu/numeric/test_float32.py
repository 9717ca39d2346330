"""float32 as in the FPU: one rounding per operation, denormals are 0, NaN compares as infinity, errors of fastRTS."""

from __future__ import annotations

from fractions import Fraction
from struct import pack, unpack

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.imu.numeric.float32 import Float32

F = Float32()
SINGLE = st.floats(width=32, allow_nan=False, allow_infinity=False, min_value=-(2.0**50), max_value=2.0**50)
TINY = 2.0**-126


def single(x: float) -> np.ndarray:
    return np.asarray(x, dtype=np.float32)


def nearest(exact: Fraction) -> float:
    """Return the float32 nearest to an exact value, ties to even, with 0 instead of a denormal."""
    if abs(exact) < Fraction(TINY) * (1 - Fraction(1, 2**25)):
        return 0.0
    low = unpack(">I", pack(">f", abs(float(exact))))[0]
    near = [unpack(">f", pack(">I", bits))[0] for bits in (max(low - 1, 0), low, low + 1)]
    by_distance = sorted(near, key=lambda f: (abs(Fraction(f) - abs(exact)), unpack(">I", pack(">f", f))[0] & 1))
    return by_distance[0] if exact >= 0 else -by_distance[0]


@given(SINGLE, SINGLE)
def test_sums_and_products_are_rounded_once(x: float, y: float) -> None:
    with np.errstate(all="ignore"):
        assert float(F.add(single(x), single(y))) == nearest(Fraction(x) + Fraction(y))
        assert float(F.sub(single(x), single(y))) == nearest(Fraction(x) - Fraction(y))
        if abs(x * y) < 1e38:
            assert float(F.mul(single(x), single(y))) == nearest(Fraction(x) * Fraction(y))


def test_no_fused_product_and_sum() -> None:
    x = single(1 + 2.0**-12)
    assert float(F.sub(F.mul(x, x), single(1 + 2.0**-11))) == 0.0  # a fused operation would give 2**-24


def test_denormals_are_zero() -> None:
    assert float(F.mul(single(TINY), single(0.5))) == 0.0
    assert float(F.sub(single(1.5 * TINY), single(TINY))) == 0.0


def test_nan_is_compared_as_infinity_of_its_sign() -> None:
    nan = single(np.nan)
    low, high = single(-512), single(511)
    assert float(F.clamp(np.copysign(nan, single(1)), low, high)) == 511
    assert float(F.clamp(np.copysign(nan, single(-1)), low, high)) == -512
    assert float(F.select_greater(np.copysign(nan, single(1)), high, single(1), single(2))) == 1


def test_library_functions_are_within_the_stated_errors() -> None:
    random = np.random.default_rng(0)
    x = random.uniform(-2 * np.pi, 2 * np.pi, 100_000).astype(np.float32)
    y = np.roll(x, 1)
    exact_x, exact_y = x.astype(np.float64), y.astype(np.float64)
    sine, cosine = F.sincos(x)
    assert np.abs(sine - np.sin(exact_x)).max() < 5e-7
    assert np.abs(cosine - np.cos(exact_x)).max() < 5e-7
    assert np.abs(F.atan2(y, x) - np.arctan2(exact_y, exact_x)).max() < 5e-7
    assert np.abs(F.atan(x) - np.arctan(exact_x)).max() < 5e-7
    for got, exact in ((F.div(y, x), exact_y / exact_x), (F.sqrt(np.abs(x)), np.sqrt(np.abs(exact_x)))):
        assert (np.abs(got - exact) / np.spacing(np.abs(exact).astype(np.float32))).max() <= 2
    far = random.uniform(-1000, 1000, 100_000).astype(np.float32)
    assert np.abs(F.sincos(far)[0] - np.sin(far.astype(np.float64))).max() < 1e-4


def test_the_angle_of_the_origin_and_the_root_of_a_negative_number_are_nan() -> None:
    with np.errstate(all="ignore"):
        assert np.isnan(F.atan2(single(0), single(0)))
        assert float(F.sqrt(single(0))) == 0
        assert np.isnan(F.sqrt(single(-1)))
        assert float(F.div(single(1), single(0))) == np.inf


@pytest.mark.parametrize(("value", "whole"), [(2.5, (3, 2, 2)), (-2.5, (-2, -3, -2))])
def test_rounding_to_integers(value: float, whole: tuple[int, int, int]) -> None:
    assert tuple(float(F.to_integer(single(value), r)) for r in ("nearest", "floor", "toward zero")) == whole
