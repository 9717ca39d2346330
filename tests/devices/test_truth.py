"""True values: straight lines between host frames, ideal sensors on a motion, and distances modulo a 16-bit word."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.devices.truth import LineBetweenFrames, distance
from periph_sim.imu.at_rest.rest import expected_at_rest
from periph_sim.imu.firmware_model import MotionTruth
from periph_sim.imu.host_frames import ramp, shown
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.motion import kinds, sines
from periph_sim.imu.motion.quantities import Pose

PERIOD = Fraction(1, 50)
LINE = LineBetweenFrames(ramp, PERIOD, shown)


@given(st.integers(0, 100_000))
def test_at_a_frame_the_truth_is_the_frame(number: int):
    truth = LINE.at(number * PERIOD)
    assert truth == {name: list(axes) for name, axes in shown(ramp(number)).items()}
    assert list(truth["gyroscope"]) + list(truth["accelerometer"]) == list(ramp(number))


@given(st.integers(0, 100_000), st.fractions(0, 1))
def test_between_two_frames_each_value_changes_linearly(number: int, part: Fraction):
    began, later = LINE.at(number * PERIOD), LINE.at((number + part) * PERIOD)
    for chip, steps in {"gyroscope": (1, 3, 5), "accelerometer": (7, 11, 13)}.items():
        for before, now, step in zip(began[chip], later[chip], steps, strict=True):
            assert distance(now, before) == step * part


def test_before_the_first_frame_the_truth_is_the_first_frame():
    assert LINE.at(Fraction(-3)) == LINE.at(Fraction(0))


@pytest.mark.parametrize(
    ("a", "b", "apart"),
    [
        (5, 3, 2),
        (3, 5, -2),
        (-32768, 32767, 1),
        (32767, -32768, -1),
        (0.25, 0, 0.25),
        (32767.5, -32768, -0.5),
        (0x7FFF, 0, 0x7FFF),
    ],
)
def test_distances_wrap_to_the_shorter_way(a: float, b: float, apart: float):
    assert distance(a, b) == apart


def test_the_truth_of_sensor_models_is_the_reading_of_ideal_sensors_at_that_time():
    """At rest, level and facing north, the truth is the expected mean of the model of Table 5.1, in LSB."""
    truth = MotionTruth(ImuParameters(), kinds()["static"].motion(Pose()), Fraction(2, 1000)).at(Fraction(5))
    expected = {name: [one.mean for one in axes] for name, axes in expected_at_rest(ImuParameters()).items()}
    assert truth["gyroscope"] == pytest.approx(np.array(expected["gyroscope"]) * 14.375, abs=0.1)
    assert truth["accelerometer"] == pytest.approx(np.array(expected["accelerometer"]) * 256, abs=0.1)
    assert truth["magnetometer"] == pytest.approx(np.array(expected["magnetometer"]) * 660, abs=0.1)


def test_the_seconds_of_the_motion_count_from_the_first_frame():
    moving = sines.motion(sines.Settings(angles=(sines.AngleWave("theta", 0.5, 0.5),)))
    early, late = (
        MotionTruth(ImuParameters(), moving, Fraction(1, 10)),
        MotionTruth(ImuParameters(), moving, Fraction(0)),
    )
    assert early.at(Fraction(0)) == late.at(Fraction(1, 10)) != late.at(Fraction(0))
