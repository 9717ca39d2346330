"""The shipped set `table_5_1` against the emulator's rows of Table 5.1, as printed in the dissertation.

Figures are typed in here once more: `experiments/published.py` is what the command prints. Means within 0.0010 of the
printed ones, 3 sigma within 3 %; the gyroscope's x and z are the exception and tested as such.
"""

from __future__ import annotations

from math import sqrt

import pytest

from periph_sim.imu.at_rest import published
from periph_sim.imu.at_rest.rest import SENSORS, at_rest, expected_at_rest
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.parameter_sets import named

# Dissertation, Table 5.1, rows "Accel HIL", "Gyro HIL", "Mag HIL": mean x, y, z; 3 sigma x, y, z; variance x, y, z.
TABLE_5_1 = {
    "accelerometer": ((-0.0301, 0.0076, -1.0035), (0.0857, 0.0845, 0.0839), (0.0008, 0.0008, 0.0008)),
    "gyroscope": ((-3.0313, 3.5380, 0.0535), (0.1452, 0.2370, 0.1356), (0.0023, 0.0062, 0.0020)),
    "magnetometer": ((0.3231, -0.0447, 0.0056), (0.0164, 0.0187, 0.0097), (0.0000, 0.0000, 0.0000)),
}
AXES = [(sensor, axis) for sensor in SENSORS for axis in range(3)]
GYROSCOPE_HIGH = {("gyroscope", 0): (1.23, 1.27), ("gyroscope", 2): (1.17, 1.21)}  # variance over the published one
SET = named("table_5_1")
EXPECTED = expected_at_rest(SET)


def test_the_figures_that_the_command_prints_are_the_published_ones():
    assert {sensor: tuple(row) for sensor, row in published.EMULATOR.items()} == TABLE_5_1


@pytest.mark.parametrize(("sensor", "axis"), AXES)
def test_every_mean_is_the_published_one(sensor: str, axis: int):
    assert EXPECTED[sensor][axis].mean == pytest.approx(TABLE_5_1[sensor][0][axis], abs=0.0009)


@pytest.mark.parametrize(("sensor", "axis"), [place for place in AXES if place not in GYROSCOPE_HIGH])
def test_every_three_sigma_but_two_of_the_gyroscope_is_the_published_one(sensor: str, axis: int):
    expected = EXPECTED[sensor][axis]
    assert 3 * sqrt(expected.variance) == pytest.approx(TABLE_5_1[sensor][1][axis], rel=0.03)
    assert expected.variance == pytest.approx(TABLE_5_1[sensor][2][axis], abs=0.00021)


@pytest.mark.parametrize("place", GYROSCOPE_HIGH)
def test_gyroscope_variances_on_x_and_z_are_a_quarter_and_a_fifth_too_high(place: tuple[str, int]):
    sensor, axis = place
    low, high = GYROSCOPE_HIGH[place]
    assert low < EXPECTED[sensor][axis].variance / (TABLE_5_1[sensor][1][axis] / 3) ** 2 < high


def test_eight_of_nine_means_are_within_3_2_standard_errors_of_ten_thousand_samples():
    offs = {
        (sensor, axis): (TABLE_5_1[sensor][0][axis] - EXPECTED[sensor][axis].mean)
        / sqrt(EXPECTED[sensor][axis].mean_error(10_000) ** 2 + 1e-8 / 12)
        for sensor, axis in AXES
    }
    assert [place for place, off in offs.items() if abs(off) > 3.2] == [("magnetometer", 2)]


def test_table_4_1_alone_does_not_reproduce_it():
    expected = expected_at_rest(ImuParameters())
    assert abs(expected["gyroscope"][2].mean - 0.0535) > 0.003
    assert abs(expected["magnetometer"][0].mean - 0.3231) > 0.1  # the samples were taken away from iron


def test_samples_of_the_set_have_these_means():
    samples = at_rest(SET, 10_000, 1)
    for sensor, axis in AXES:
        error = EXPECTED[sensor][axis].mean_error(10_000)
        assert samples[sensor][:, axis].mean() == pytest.approx(EXPECTED[sensor][axis].mean, abs=4 * error)
