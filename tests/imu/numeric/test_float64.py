"""float64 of single numbers agrees with numpy, including infinities and NaN of IEEE 754."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from periph_sim.imu.numeric.float64 import Float64

ONE = Float64()
NUMPYS = {"add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide, "mag": np.hypot}
NUMPYS |= {"neg": np.negative, "sqrt": np.sqrt, "atan": np.arctan}
ODD = [0.0, -0.0, 1.0, -2.5, 0.4999999999999999, 1e300, -1e300, np.inf, -np.inf, np.nan]


def same(x: float, y: float, off: float = 0.0) -> bool:
    return bool(x == y or abs(x - y) <= max(4e-16 * abs(x), off) or (np.isnan(x) and np.isnan(y)))


@pytest.mark.parametrize("name", NUMPYS)
def test_operations_on_one_and_two_numbers(name: str) -> None:
    for numbers in product(ODD, repeat=NUMPYS[name].nin):
        with np.errstate(all="ignore"):
            assert same(getattr(ONE, name)(*numbers), NUMPYS[name](*numbers)), numbers


def test_angles_of_points_in_every_direction_and_at_every_distance() -> None:
    for y, x in product([*ODD, 3e-8, -7.1, 12.0], repeat=2):
        assert same(ONE.atan2(y, x), np.arctan2(y, x)), (y, x)


def test_sine_and_cosine_of_any_angle() -> None:
    x = np.concatenate([np.linspace(-20, 20, 2001), np.arange(-8, 9) * np.pi / 2, [1e-300, 1e8, 1e15]])
    for angle in x.tolist():
        s, c = ONE.sincos(angle)
        assert same(s, np.sin(angle), off=3.4e-16) and same(c, np.cos(angle), off=3.4e-16), angle


def test_sine_and_cosine_of_infinities_and_nan_are_nan() -> None:
    assert all(np.isnan(part) for x in (np.inf, -np.inf, np.nan) for part in ONE.sincos(x))


@pytest.mark.parametrize(
    ("rounding", "whole"), [("nearest", (3, -2, 0)), ("floor", (2, -3, 0)), ("toward zero", (2, -2, 0))]
)
def test_rounding_to_integers(rounding: str, whole: tuple[int, ...]) -> None:
    assert tuple(ONE.to_integer(x, rounding) for x in (2.5, -2.5, 0.4999)) == whole
    assert [ONE.to_integer(x, rounding) for x in (np.inf, -np.inf, np.nan)] == [np.inf, -np.inf, 0]
