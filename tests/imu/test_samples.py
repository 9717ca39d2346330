"""Samples in units, read over the wires: real chips in a known attitude, a head that configures them, an estimate."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from periph_sim.imu.attitude import errors, estimate
from periph_sim.imu.moving import experiment as direct
from periph_sim.imu.rotations import quaternions
from periph_sim.imu.samples import Readings, SampleLog, Samples
from periph_sim.scene.scene import Scene
from tests.devices.aerospace import FIELD, at_rest, body_rates, to_body
from tests.imu.motion import at_times
from tests.imu.moving.subjects import STILL, TWO_ANGLES, parameters, subject, without_noise
from tests.scene.small import case

MODELS = {"gyroscope": "itg3200", "accelerometer": "adxl345", "magnetometer": "hmc5883l"}


def sampled(length: str, names: Iterable[str] = MODELS, **sources: Callable[[int], object]) -> Samples:
    """Return what a head reads after it has configured the chips as drivers do; `names` are the chips on the bus."""
    chips = {name: {"model": MODELS[name], "values": {"fixed": [0, 0, 0]}} for name in names}
    head = {"order": list(MODELS), "first": "105 ms", "initialise": "100 ms"}
    scene = Scene(case(length, chip=chips, controller=head), sources=sources)
    assert scene.head is not None
    log = SampleLog(scene.head, scene.start, scene.timebase.per_second)
    scene.run()
    return log.samples()


def resting(attitude: tuple[float, float, float]) -> Samples:
    accel, mag = at_rest(*attitude)
    fixed = {"gyroscope": (1.0, -2.0, 3.0), "accelerometer": tuple(accel), "magnetometer": tuple(mag)}
    return sampled("200 ms", **{name: lambda tick, v=values: v for name, values in fixed.items()})


def test_samples_of_rounds_have_units_and_times():
    samples = resting((0.1, 0.2, 0.3))
    accel, mag = at_rest(0.1, 0.2, 0.3)
    assert samples.seconds == pytest.approx([0.105, 0.125, 0.145, 0.165, 0.185], abs=1e-12)
    assert samples.gyro == pytest.approx(np.tile([1, -2, 3], (5, 1)), abs=0.5 / 14.375)
    assert samples.accel == pytest.approx(np.tile(accel, (5, 1)), abs=0.5 / 256)
    assert samples.mag == pytest.approx(np.tile(mag, (5, 1)), abs=0.5 / 660)


@pytest.mark.parametrize("attitude", [(0, 0, 0), (0.5, -0.8, 2.5), (-2.0, 1.2, -3.1), (3.1, 0.1, 1.0)])
def test_an_attitude_is_estimated_through_chips_wires_and_filter(attitude: tuple[float, float, float]):
    """LSB of 4 mg and 1.5 mG cause errors of some tenths of a degree."""
    s = resting(attitude)
    found = errors(estimate(s.seconds, s.gyro * 0, s.accel, s.mag, FIELD), np.tile(quaternions([attitude]), (5, 1)))
    assert found.total.max() < 0.5


def test_an_overflow_of_the_magnetometer_is_nan():
    samples = sampled(
        "200 ms", magnetometer=lambda tick: (4.0, Fraction(1, 2), 0), accelerometer=lambda tick: (0, 0, 0)
    )
    assert np.isnan(samples.mag[:, 0]).all() and samples.mag[:, 1] == pytest.approx(0.5)


def test_a_round_in_which_a_chip_is_silent_is_omitted():
    samples = sampled("200 ms", ["gyroscope"])
    assert samples.seconds.shape == (0,) and samples.mag.shape == (0, 3)


SET = """
[gyroscope]
mounting = [2, -1, 3]
cross_axis = 0.05

[magnetometer]
hard_iron = "0.3, -0.2, 0.1 gauss"
cross_axis = 0.03
"""


def test_rates_gravity_and_field_of_the_body_are_recovered(tmp_path: Path):
    one = without_noise(subject("3", TWO_ANGLES, parameters(tmp_path, SET)))
    read = direct.computed_sensors(one).samples(one.sensors)
    attitude = at_times.attitudes(one.motion, read.seconds)
    rates = np.degrees(body_rates(attitude, at_times.rates(one.motion, read.seconds)))
    assert np.abs(rates).max(axis=0).min() > 10, "every axis rotates"
    assert read.gyro == pytest.approx(rates, abs=0.05)
    to = np.array([to_body(*row) for row in attitude])
    assert read.accel == pytest.approx(-to[:, :, 2], abs=0.003)
    assert read.mag == pytest.approx(to @ np.array(one.sensors.magnetometer.earth_field), abs=0.0012)


def test_an_overflow_of_any_axis_makes_the_field_nan():
    still = np.zeros((2, 3), np.int64)
    codes = {"gyroscope": still, "accelerometer": still, "magnetometer": np.array([[0, -4096, 5], [1, 2, 3]])}
    scales = {"gyroscope": 14.375, "accelerometer": 256.0, "magnetometer": 660.0}
    one = subject("1")
    field = Readings(np.arange(2.0), codes, scales, overflow=-4096).samples(one.sensors).mag
    assert np.isnan(field[0]).all() and np.isfinite(field[1]).all()
    assert np.isfinite(Readings(np.arange(2.0), codes, scales).samples(one.sensors).mag).all()


def test_real_sensors_have_another_noise_than_the_emulator():
    one = subject("6", STILL)
    emulated, real = (
        readings.codes["gyroscope"][10:, 0]
        for readings in (direct.computed_emulator(one), direct.computed_sensors(one))
    )
    assert abs(np.corrcoef(emulated, real)[0, 1]) < 0.2
    again = direct.computed_sensors(one).codes["gyroscope"][10:, 0]
    assert np.array_equal(real, again), "the noise is reproducible"
