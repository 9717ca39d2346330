"""A NaN or an infinity in what the models are given is refused, by axis and sample, in every arithmetic."""

from __future__ import annotations

from math import inf, nan

import numpy as np
import pytest

from periph_sim.imu.models.arrays import codes_of
from periph_sim.imu.models.imu import INPUTS, Imu, Noise, NotFinite
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.numeric import arithmetic_names as named
from periph_sim.imu.numeric.q import DoesNotFit

LONG = 40
FLOATS = ("float64", "float32")
WRONG = (nan, inf, -inf)


def inputs(axis: int, value: float, at: int) -> tuple:
    """Attitude, acceleration and noise of zeros, one of them wrong."""
    rows = np.zeros((15, LONG))
    rows[axis, at] = value
    noise = Noise(*(tuple(rows[first : first + 3]) for first in (6, 9, 12)))
    return tuple(rows[0:3]), tuple(rows[3:6]), noise


@pytest.mark.parametrize("name", FLOATS)
@pytest.mark.parametrize("value", WRONG)
@pytest.mark.parametrize("axis", range(15))
def test_arrays_name_axis_and_sample(name: str, value: float, axis: int) -> None:
    attitude, acceleration, noise = inputs(axis, value, 17)
    with pytest.raises(NotFinite) as caught:
        codes_of(ImuParameters(), attitude, acceleration, noise, arithmetic=named.arrays(name))
    assert str(caught.value) == f"{INPUTS[axis]}: {value} at sample 17; expected a finite number"
    assert (caught.value.axis, caught.value.index) == (INPUTS[axis], 17)


@pytest.mark.parametrize("name", FLOATS)
@pytest.mark.parametrize("value", WRONG)
@pytest.mark.parametrize("axis", range(15))
def test_a_single_sample_names_the_axis(name: str, value: float, axis: int) -> None:
    a = named.scalar(name)
    model = Imu(a, ImuParameters())
    values = [a.constant(0.0)] * 15
    values[axis] = a.constant(value)
    attitude, acceleration, *chips = (tuple(values[first : first + 3]) for first in range(0, 15, 3))
    with pytest.raises(NotFinite) as caught:
        model.step(attitude, acceleration, Noise(*chips), model.at_rest)
    assert str(caught.value) == f"{INPUTS[axis]}: {value}; expected a finite number"
    assert caught.value.index is None


def test_the_first_sample_that_is_wrong_is_named() -> None:
    attitude, acceleration, noise = inputs(1, nan, 30)
    attitude[1][5] = inf
    with pytest.raises(NotFinite, match=r"^attitude, pitch: inf at sample 5; "):
        codes_of(ImuParameters(), attitude, acceleration, noise)
    with pytest.raises(NotFinite, match=r"^attitude, pitch: inf at sample 5; "):
        codes_of(ImuParameters(), attitude, acceleration)


@pytest.mark.parametrize("value", WRONG)
def test_q_formats_have_no_number_for_it_either(value: float) -> None:
    with pytest.raises(DoesNotFit):
        named.scalar("q16").constant(value)


@pytest.mark.parametrize("name", ["float64", "float32", "q16", "q16 saturating", "q12"])
def test_finite_numbers_of_every_kind_pass(name: str) -> None:
    a = named.scalar(name)
    model = Imu(a, ImuParameters())
    three = (a.constant(0.1), a.constant(-0.2), a.constant(0.3))
    codes, _ = model.step(three, three, model.silence, model.at_rest)
    assert all(abs(int(code)) <= 32768 for chip in codes for code in chip)
