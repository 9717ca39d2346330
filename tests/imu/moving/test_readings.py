"""From codes back to what the body feels: cross-axis sensitivity, biases, hard iron and mounting taken off."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from periph_sim.imu.moving import direct_computation as direct
from periph_sim.imu.samples import Readings
from tests.devices.aerospace import body_rates, to_body
from tests.imu.moving.subjects import STILL, TWO_ANGLES, subject, without_noise

SET = """
[gyroscope]
mounting = [2, -1, 3]
cross_axis = 0.05

[magnetometer]
hard_iron = "0.3, -0.2, 0.1 gauss"
cross_axis = 0.03
"""


def test_the_body_s_own_rates_gravity_and_field_come_back(tmp_path: Path):
    (tmp_path / "set.toml").write_text(SET)
    one = without_noise(subject("3", TWO_ANGLES, f"unit.dsp.settings.parameters={tmp_path / 'set.toml'}"))
    read = direct.sensors(one).samples(one.sensors)
    attitude = one.motion.attitude(read.seconds)
    rates = np.degrees(body_rates(attitude, one.motion.rates(read.seconds)))
    assert np.abs(rates).max(axis=0).min() > 10, "every axis turns"
    assert read.gyro == pytest.approx(rates, abs=0.05)
    to = np.array([to_body(*row) for row in attitude])
    assert read.accel == pytest.approx(-to[:, :, 2], abs=0.003)
    assert read.mag == pytest.approx(to @ np.array(one.sensors.magnetometer.earth_field), abs=0.0012)


def test_an_overflow_of_any_axis_is_no_field():
    still = np.zeros((2, 3), np.int64)
    codes = {"gyroscope": still, "accelerometer": still, "magnetometer": np.array([[0, -4096, 5], [1, 2, 3]])}
    scales = {"gyroscope": 14.375, "accelerometer": 256.0, "magnetometer": 660.0}
    one = subject("1")
    field = Readings(np.arange(2.0), codes, scales, overflow=-4096).samples(one.sensors).mag
    assert np.isnan(field[0]).all() and np.isfinite(field[1]).all()
    assert np.isfinite(Readings(np.arange(2.0), codes, scales).samples(one.sensors).mag).all()


def test_real_sensors_have_another_noise_than_the_emulator():
    one = subject("6", STILL)
    emulated, real = (readings.codes["gyroscope"][10:, 0] for readings in (direct.emulator(one), direct.sensors(one)))
    assert abs(np.corrcoef(emulated, real)[0, 1]) < 0.2
    again = direct.sensors(one).codes["gyroscope"][10:, 0]
    assert np.array_equal(real, again), "but each time the same"
