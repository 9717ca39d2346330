"""Parameters are recovered from simulated codes by identification, and give the same set again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from periph_sim.imu.at_rest.identified import parameters_of_axes
from periph_sim.imu.at_rest.rest import SENSORS, UNITS, at_rest, expected_at_rest
from periph_sim.imu.identification.identify import Identified, identify
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.models.quantity import BadParameter
from periph_sim.imu.noise import AXES


def identified(imu: ImuParameters, seed: int, samples: int = 10_000) -> dict[str, Identified]:
    got = at_rest(imu, samples, seed)
    return {
        f"{sensor}_{axis}": identify(f"{sensor}_{axis}", got[sensor][:, column], imu.period, unit=UNITS[sensor])
        for sensor in SENSORS
        for column, axis in enumerate(AXES)
    }


def test_the_identified_set_gives_the_same_means_and_variances():
    axes = identified(ImuParameters(), 1)
    expected = expected_at_rest(parameters_of_axes(axes, hard_iron=False))
    for name, axis in axes.items():
        sensor, letter = name.split("_")
        found = axis.series.samples
        again = expected[sensor][AXES.index(letter)]
        assert again.mean == pytest.approx(found.mean(), abs=5e-5)
        assert again.variance == pytest.approx(found.var(), rel=0.02)


def test_hard_iron_is_identified_with_a_recording_without_it():
    imu = ImuParameters()
    plain = structs.replace(imu, magnetometer=structs.replace(imu.magnetometer, hard_iron=(0.0, 0.0, 0.0)))
    with_iron, without = (at_rest(one, 5000, seed)["magnetometer"] for one, seed in ((imu, 1), (plain, 2)))
    axes = {
        f"magnetometer_{axis}": identify(
            f"magnetometer_{axis}", with_iron[:, k], imu.period, unit="gauss", undisturbed=without[:, k]
        )
        for k, axis in enumerate(AXES)
    }
    found = parameters_of_axes(axes, hard_iron=True).magnetometer
    assert found.hard_iron == pytest.approx(imu.magnetometer.hard_iron, abs=5e-4)
    assert found.earth_field == pytest.approx(imu.magnetometer.earth_field, abs=5e-4)
    assert parameters_of_axes(axes, hard_iron=True).gyroscope == imu.gyroscope


def test_slow_terms_are_set_for_the_axes_that_have_them():
    noise = np.random.default_rng(1).normal(size=(4000, 3))
    walk = 0.05 * np.cumsum(np.random.default_rng(2).normal(size=4000))
    values = {"x": noise[:, 0], "y": noise[:, 1] + walk, "z": noise[:, 2]}
    axes = {f"gyroscope_{a}": identify(a, v, 0.02, unit="deg/s", slow=True) for a, v in values.items()}
    found = parameters_of_axes(axes, hard_iron=False).gyroscope
    assert found.random_walk[0] == found.random_walk[2] == 0
    assert found.random_walk[1] == pytest.approx(0.05 / 0.02**0.5, rel=0.5)


def test_unknown_columns_missing_axes_and_other_units_are_refused():
    axes = identified(ImuParameters(), 1, 1000)
    with pytest.raises(
        BadParameter, match=r"^height: it is not a column of a sensor model; expected accelerometer_x, acc"
    ):
        parameters_of_axes(axes | {"height": axes["gyroscope_x"]}, False)
    without = {name: axis for name, axis in axes.items() if name != "gyroscope_y"}
    with pytest.raises(
        BadParameter, match=r"^gyroscope_y: it is missing; a set needs all three axes of the gyroscope$"
    ):
        parameters_of_axes(without, False)
    other = replace(axes["gyroscope_z"], unit="rad/s")
    with pytest.raises(BadParameter, match=r"^gyroscope_z: its unit is 'rad/s'; expected 'deg/s'$"):
        parameters_of_axes(axes | {"gyroscope_z": other}, False)
