"""float64 of one number and over arrays agree, also where IEEE 754 has infinities and NaN."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest

from periph_sim.imu.numeric.float64 import Float64
from periph_sim.imu.numeric.float64_arrays import Float64Arrays

ONE, MANY = Float64(), Float64Arrays()
ODD = [0.0, -0.0, 1.0, -2.5, 0.4999999999999999, 1e300, -1e300, np.inf, -np.inf, np.nan]


def same(x: float, y: float, off: float = 0.0) -> bool:
    return bool(x == y or abs(x - y) <= max(4e-16 * abs(x), off) or (np.isnan(x) and np.isnan(y)))


@pytest.mark.parametrize("name", ["add", "sub", "mul", "div", "mag"])
def test_two_numbers(name: str) -> None:
    for x in ODD:
        for y in ODD:
            with np.errstate(all="ignore"):
                many = getattr(MANY, name)(np.array([x]), np.array([y]))[0]
            assert same(getattr(ONE, name)(x, y), many), (x, y)


def test_angles_of_points_in_every_direction_and_at_every_distance() -> None:
    """The pairs as one array too: where x/y is no number, the others are not touched."""
    x, y = (np.array(axis) for axis in zip(*product([*ODD, 3e-8, -7.1, 12.0], repeat=2), strict=True))
    with np.errstate(all="ignore"):
        together = MANY.atan2(y, x)
        alone = [MANY.atan2(y[k : k + 1], x[k : k + 1])[0] for k in range(len(x))]
    assert np.array_equal(together, alone, equal_nan=True)
    for k, angle in enumerate(together):
        assert same(ONE.atan2(float(y[k]), float(x[k])), angle, off=3.4e-16), (y[k], x[k])


def test_sine_and_cosine_of_any_angle() -> None:
    x = np.concatenate([np.linspace(-20, 20, 20_001), np.arange(-8, 9) * np.pi / 2, [1e-300, 1e8, 1e15]])
    s, c = MANY.sincos(x)
    for k, angle in enumerate(x.tolist()):
        assert same(math.sin(angle), s[k], off=3.4e-16) and same(math.cos(angle), c[k], off=3.4e-16), angle
    with np.errstate(all="ignore"):
        assert np.isnan(MANY.sincos(np.array([np.inf, -np.inf, np.nan]))).all()


@pytest.mark.parametrize("name", ["neg", "sqrt", "atan"])
def test_one_number(name: str) -> None:
    for x in ODD:
        with np.errstate(all="ignore"):
            assert same(getattr(ONE, name)(x), getattr(MANY, name)(np.array([x]))[0]), x


def test_sine_and_cosine_of_what_is_no_angle() -> None:
    assert all(np.isnan(part) for x in (np.inf, -np.inf, np.nan) for part in ONE.sincos(x))


@pytest.mark.parametrize("rounding", ["nearest", "floor", "toward zero"])
def test_whole_numbers(rounding: str) -> None:
    for x in (2.5, -2.5, 0.4999, -0.0, np.inf, -np.inf, np.nan):
        assert same(ONE.to_integer(x, rounding), MANY.to_integer(np.array([x]), rounding)[0]), x
    assert ONE.to_integer(np.nan, rounding) == 0
