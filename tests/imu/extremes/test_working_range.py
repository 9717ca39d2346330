"""Limits of the error of each arithmetic in the working range of the sensors; found by search, asserted here."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.imu.extremes.frames import SENSORS, codes_of
from periph_sim.imu.extremes.working_range import LIMITS, Worst, drawn, worst
from periph_sim.imu.models.parameters import (
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)

# LSB before rounding: gyroscope, accelerometer, magnetometer. The largest of four searches of 20 000 samples plus 10 %.
STATED = {
    "float32": (0.017, 0.00025, 0.0004),
    "q16": (0.73, 0.016, 2.9),
    "q16 saturating": (0.73, 0.016, 2.1),
    "q12": (11.5, 0.25, 13.0),
}
IQMAG = ImuParameters(magnetometer=MagnetometerParameters(norm="mag"))
ROTATION = ImuParameters(magnetometer=MagnetometerParameters(spherical="rotation"))
MOVING = ImuParameters(
    gyroscope=GyroscopeParameters(rates="corrected"),
    accelerometer=AccelerometerParameters(lever_arm=(0.1, 0.05, -0.02)),
)


@pytest.mark.parametrize("name", STATED)
def test_a_search_finds_no_error_above_the_limit(name: str) -> None:
    found = worst(name, ImuParameters(), samples=1500, seed=11)
    for sensor, most in zip(SENSORS, STATED[name], strict=True):
        assert most / 3 < found.error[sensor] <= most, (
            sensor
        )  # so that the stated limit is not much larger than the errors found


@pytest.mark.parametrize("name", STATED)
@given(st.integers(0, 2**32 - 1))
def test_no_random_sample_exceeds_the_limit(name: str, seed: int) -> None:
    counts = drawn(64, seed)
    reference, own = (codes_of(one, ImuParameters(), counts) for one in ("float64", name))
    most = np.repeat(STATED[name], 3)[:, None]
    assert (np.abs(own.exact - reference.exact) <= most).all()
    assert (np.abs(own.codes - reference.codes) <= np.floor(most) + 1).all()
    assert not own.overflown.any()


@pytest.mark.parametrize(("imu", "most"), [(IQMAG, 0.12), (ROTATION, 0.09)])
def test_without_squares_of_the_field_q16_has_small_errors(imu: ImuParameters, most: float) -> None:
    assert worst("q16", imu, samples=800).error["magnetometer"] < most < STATED["q16"][2] / 20


def test_corrected_rates_and_a_lever_arm_of_10_cm_to_500_degrees_a_second() -> None:
    found = worst("q16", MOVING, samples=800, rate=500.0)
    assert found.error["gyroscope"] < 1.4 and found.error["accelerometer"] < 1.0
    assert worst("float32", MOVING, samples=800, rate=500.0).largest < 0.02


def test_a_search_is_reproducible_and_returns_inputs_in_the_working_range() -> None:
    first, again = (worst("q16", ImuParameters(), samples=500, seed=3) for _ in range(2))
    assert first.error == again.error
    at = first.at["magnetometer"][:, None]
    off = np.abs(codes_of("q16", ImuParameters(), at).exact - codes_of("float64", ImuParameters(), at).exact)
    assert off[6:9].max() == first.error["magnetometer"]
    for at in first.at.values():
        assert (np.abs(at[0:9].reshape(3, 3)) <= LIMITS).all()
        assert (np.abs(np.diff(at[0:9].reshape(3, 3), axis=0)) <= np.radians(2000) * 0.02 / 1e-4).all()
        assert (np.abs(at[9:12]) <= 2000).all()


def test_codes_allowed_for_an_error() -> None:
    found = Worst({"gyroscope": 0.7, "accelerometer": 0.01, "magnetometer": 2.6}, {})
    assert found.allowed().tolist() == [1, 1, 1, 1, 1, 1, 3, 3, 3] and found.largest == 2.6
