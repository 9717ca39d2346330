"""The earth field of the models agrees with section 5.2 about the turn in Figure 5.1."""

from __future__ import annotations

import pytest

from periph_sim.imu.at_rest.earth_field import YAWS, fit, off_north, text, turn
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.parameter_sets import named

MEAN = (0.3239, -0.0447, 0.0060)  # Table 5.1, "Mag IMU"
HARD_IRON = (-0.16, 0.17, -0.02)  # Table 4.1


def test_the_models_have_the_field_of_the_fit():
    assert ImuParameters().magnetometer.earth_field == fit().field == MEAN


def test_both_statements_of_section_5_2_imply_that_the_mean_is_without_hard_iron():
    found = fit(MEAN, HARD_IRON)
    assert found.along_y == pytest.approx(-0.263, abs=0.001) and found.along_z == pytest.approx(-0.3)
    assert not found.disturbed and off_north(found.field) == pytest.approx(-7.86, abs=0.01)
    assert off_north(found.fields[1]) == pytest.approx(-23.93, abs=0.01)


def test_a_mean_that_includes_the_hard_iron_is_recognized():
    north = (0.3, 0.001, 0.0005)
    disturbed = tuple(h + v for h, v in zip(north, HARD_IRON, strict=True))
    found = fit(disturbed, HARD_IRON)
    assert found.disturbed and found.field == pytest.approx(north)


def test_at_0_and_180_degrees_y_is_near_the_bias_and_x_at_its_extremes():
    shown = dict(zip(YAWS, turn(ImuParameters()), strict=True))
    for yaw in (0, 180):
        assert shown[yaw][1] == pytest.approx(0.17, abs=0.05)
    assert (shown[0][1] + shown[180][1]) / 2 == pytest.approx(0.17, abs=0.001)
    assert shown[180][0] < shown[90][0] < shown[270][0] < shown[0][0]
    everywhere = turn(ImuParameters(), tuple(range(360)))
    assert shown[0][0] == pytest.approx(everywhere[:, 0].max(), abs=0.004)
    assert shown[180][0] == pytest.approx(everywhere[:, 0].min(), abs=0.004)


def test_the_field_is_nearly_horizontal():
    assert abs(turn(ImuParameters())[:, 2] + 0.02).max() < 0.008


def test_the_turn_of_a_set_without_hard_iron_is_about_zero():
    shown = text(named("table_5_1"), fit())
    assert "with hard iron 0.0000, 0.0000, 0.0000 gauss" in shown
    assert "\n 180  -0.3238   0.0441 " in shown
