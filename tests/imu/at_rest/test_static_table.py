"""Why the published means are what they are: each reading of the model against Table 5.1."""

from __future__ import annotations

import re

import pytest

from periph_sim.imu.at_rest import published
from periph_sim.imu.at_rest.readings import Reading, readings, with_floor
from periph_sim.imu.at_rest.rest import at_rest, expected_at_rest
from periph_sim.imu.at_rest.static_table import static_table
from periph_sim.imu.at_rest.static_text import text
from periph_sim.imu.models.parameters import (
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)
from periph_sim.imu.parameter_sets import named

PUBLISHED = named("table_5_1")


def by_name() -> dict[str, Reading]:
    return dict(zip(("bias", "cross", "decimals", "two floors", "floors"), readings(), strict=True))


def test_bias_alone_explains_no_mean_of_accelerometer_or_gyroscope():
    alone = by_name()["bias"]
    assert alone.rms("accelerometer") > 30 and alone.rms("gyroscope") > 80


def test_cross_axis_and_bias_to_four_decimals_explain_the_gyroscope():
    told = by_name()["decimals"]
    assert told.rms("gyroscope") < 1
    by_hand = -3.1041 + 0.02 * (3.5997 + 0.0438)  # S of Table 4.1 on the real means of Table 5.1
    assert by_hand == pytest.approx(published.EMULATOR["gyroscope"].mean[0], abs=1e-4)


def test_codes_rounded_down_explain_most_of_accelerometer_and_magnetometer_but_not_the_gyroscope():
    told = by_name()
    for sensor in ("accelerometer", "magnetometer"):
        assert told["two floors"].rms(sensor) < 3 < told["decimals"].rms(sensor) / 2
    assert told["two floors"].rms("gyroscope") < 1 and told["floors"].rms("gyroscope") > 50


def test_the_shipped_set_is_the_last_reading_but_one():
    assert with_floor() == PUBLISHED


def test_gyroscope_variances_are_shown_with_what_rounding_adds():
    assert "gyroscope variances: published 0.00234, 0.00624, 0.00204 (by 3 sigma)" in shown()
    assert "\n  expected with whole LSB    0.00291, 0.00641, 0.00241: +24 %, +3 %, +18 %\n" in shown()
    assert "\n  expected before rounding   0.00250, 0.00600, 0.00200: +7 %, -4 %, -2 %\n" in shown()


def shown(imu: ImuParameters = PUBLISHED) -> str:
    return text(imu, static_table(imu, at_rest(imu, 1000, 1)), readings() if imu == PUBLISHED else [], 1000, 1)


def test_without_noise_or_at_the_end_of_its_range_an_axis_has_no_standard_errors():
    silent = GyroscopeParameters(noise_density=(0.0, 0.0, 0.0))
    saturated = AccelerometerParameters(bias=(16.0, 16.0, 16.0))
    told = shown(ImuParameters(gyroscope=silent, accelerometer=saturated))
    assert len(re.findall(r"^ (?:accelerometer|gyroscope) .* - +[-+]\d", told, re.MULTILINE)) == 18
    assert "  expected before rounding   0.00000, 0.00000, 0.00000: -100 %, -100 %, -100 %" in told
    assert re.search(r"^ accelerometer x, g .* 1.9961 +1.9961 ", told, re.MULTILINE)  # 511 / 256


def test_a_field_of_which_the_plain_arctangent_makes_nan_is_expected_to_show_zeros():
    cancelled = MagnetometerParameters(earth_field=(0.16, -0.17, 0.02), spherical="plain")  # all that is left is 0/0
    imu = ImuParameters(magnetometer=cancelled)
    assert not at_rest(imu, 10, 1)["magnetometer"].any()
    assert all(axis.mean == axis.variance == 0 for axis in expected_at_rest(imu)["magnetometer"])
    assert re.search(r"^ magnetometer x, gauss .* 0.0000 +0.0000 +- ", shown(imu), re.MULTILINE)


def test_the_text_shows_every_axis_three_times_and_how_the_set_follows_from_table_4_1():
    for axis in "xyz":
        assert len(re.findall(rf"^ gyroscope {axis}, \(?deg/s", shown(), re.MULTILINE)) == 3
    assert re.search(
        r"^ and floor for two: table_5_1 +accelerometer .*\n +gyroscope +-0.1 +-0.6 +-0.4 +0.4$", shown(), re.MULTILINE
    )
    assert max(map(len, shown().splitlines())) <= 80


def test_how_the_set_follows_from_table_4_1_is_told_of_that_set_only():
    assert "the model with" not in shown(ImuParameters())
