"""The sensors at rest: samples agree with the exact expectation of the models over several seeds and all axes."""

from __future__ import annotations

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim.imu.at_rest.rest import SENSORS, at_rest, expected_at_rest, lsb_at_rest
from periph_sim.imu.at_rest.static_table import static_table
from periph_sim.imu.models.imu import Imu
from periph_sim.imu.models.parameters import GyroscopeParameters, ImuParameters
from periph_sim.imu.noise import ImuNoise
from periph_sim.imu.numeric.float64 import Float64

SAMPLES = 10_000


def test_deviations_of_all_means_and_variances_have_the_expected_distribution():
    rows = [row for seed in range(20) for row in static_table(ImuParameters(), at_rest(ImuParameters(), SAMPLES, seed))]
    assert len(rows) == 180
    for row in rows:
        assert row.three_sigma.ours_off == pytest.approx(row.variance.ours_off, abs=0.1)
    for figure in ("mean", "variance"):
        squares = sum(getattr(row, figure).ours_off ** 2 for row in rows)
        assert scipy.stats.chi2.ppf(0.5e-3, len(rows)) < squares < scipy.stats.chi2.isf(0.5e-3, len(rows))
        offs = [getattr(row, figure).ours_off for row in rows]
        assert scipy.stats.kstest(offs, "norm").pvalue > 1e-3


def test_the_table_has_the_axes_of_the_published_one_in_their_order():
    rows = static_table(ImuParameters(), at_rest(ImuParameters(), 100, 1))
    assert [(row.sensor, row.axis) for row in rows] == [(sensor, axis) for sensor in SENSORS for axis in "xyz"]
    assert rows[4].mean.real == 3.5997 and rows[4].mean.emulator == 3.5380 and rows[5].three_sigma.emulator == 0.1356


@settings(deadline=None, max_examples=25)
@given(
    rounding=st.sampled_from(["nearest", "floor", "toward zero"]),
    bias=st.floats(-2100, 2100),
    sigma=st.sampled_from([0.0, 0.02, 0.2, 3.0]),
)
def test_expected_moments_agree_with_many_samples_for_any_rounding_and_saturation(rounding, bias, sigma):
    gyroscope = GyroscopeParameters(
        bias=(bias if abs(bias) <= 2000 else 1999.9, 0.0, 0.0),
        cross_axis=0.0,
        rounding=rounding,
        bits=14,
        noise_density=(sigma**2 * 0.02, 0.0, 0.0),
    )
    imu = replace(ImuParameters(), gyroscope=gyroscope)
    expected = expected_at_rest(imu)["gyroscope"][0]
    values = at_rest(imu, SAMPLES, 1)["gyroscope"][:, 0]
    assert abs(values.mean() - expected.mean) <= 5 * expected.mean_error(SAMPLES) + 1e-9
    assert (
        abs(values.var() - expected.variance) <= 5 * expected.variance_error(SAMPLES) + 1e-4 * expected.variance + 1e-9
    )


def test_rounding_down_lowers_every_mean_by_half_an_lsb():
    down = replace(ImuParameters(), gyroscope=replace(ImuParameters().gyroscope, rounding="floor"))
    nearest, lower = (expected_at_rest(imu)["gyroscope"] for imu in (ImuParameters(), down))
    shifts = [a.mean - b.mean for a, b in zip(nearest, lower, strict=True)]
    assert shifts == pytest.approx([0.5 / 14.375] * 3, rel=1e-3)


def test_rounding_adds_a_twelfth_of_an_lsb_squared():
    gyroscope = expected_at_rest(ImuParameters())["gyroscope"]
    matrix = np.array(ImuParameters().gyroscope.matrix) / 14.375
    unrounded = matrix**2 @ np.array(ImuParameters().gyroscope.noise_density) / 0.02
    assert [axis.variance for axis in gyroscope] == pytest.approx(unrounded + 1 / 14.375**2 / 12, rel=1e-3)


def sensed_at_rest(imu: ImuParameters, name: str) -> np.ndarray:
    """Return the values before the matrix S is applied, in the sensor's unit."""
    return np.linalg.solve(getattr(imu, name).matrix, lsb_at_rest(imu)[name])


def test_at_rest_the_magnetometer_senses_field_and_hard_iron_and_gravity_points_up():
    assert sensed_at_rest(ImuParameters(), "magnetometer") == pytest.approx((0.1639, 0.1253, -0.0140))
    assert sensed_at_rest(ImuParameters(), "accelerometer") == pytest.approx((-0.02, 0.02, -1.0))
    inclined = replace(ImuParameters(), magnetometer=replace(ImuParameters().magnetometer, board_azimuth=90.0))
    assert sensed_at_rest(inclined, "magnetometer") == pytest.approx((-0.1253, 0.1639, -0.0140))


@pytest.mark.parametrize("rounding", ["nearest", "floor", "toward zero"])
def test_samples_equal_those_of_the_models_with_the_same_noise(rounding: str):
    sensors = {name: replace(getattr(ImuParameters(), name), rounding=rounding) for name in SENSORS}
    imu = replace(ImuParameters(), **sensors)
    model, noise, found = Imu(Float64(), imu), ImuNoise(imu, 7), at_rest(imu, 50, 7)
    for n in range(50):
        codes, _ = model.step((0.0,) * 3, (0.0,) * 3, noise.at(n), model.at_rest)
        assert all(
            (found[name][n] * sensors[name].scale).round(9).tolist() == [*getattr(codes, name)] for name in SENSORS
        )
