"""Readings of ideal sensors in motion agree with the dissertation's matrices, which are computed without the models."""

from __future__ import annotations

import numpy as np
import pytest
from msgspec.structs import replace

from periph_sim.imu.models.imu import Noise
from periph_sim.imu.models.parameters import (
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)
from periph_sim.imu.models.sensed_motion import SensedMotion
from periph_sim.imu.motion import Motion, kinds, servo, sines
from periph_sim.imu.motion.quantities import Pose
from tests.devices.aerospace import FIELD, at_rest, body_rates
from tests.imu.motion import at_times

NONE = (0.0, 0.0, 0.0)
IDEAL = ImuParameters(
    AccelerometerParameters(bias=NONE, cross_axis=0.0),
    GyroscopeParameters(bias=NONE, cross_axis=0.0, g_sens=0.0),
    MagnetometerParameters(hard_iron=NONE, cross_axis=0.0, earth_field=tuple(FIELD.tolist())),
)
WAVES = tuple(
    sines.AngleWave(of, np.radians(amplitude), frequency)
    for of, amplitude, frequency in (("phi", 40.0, 0.21), ("theta", 30.0, 0.34), ("psi", 80.0, 0.13))
)
MOTION = sines.motion(sines.Settings(angles=WAVES))
TIMES = np.linspace(0.0, 9.0, 50)


def lsb(imu: ImuParameters, motion: Motion, name: str) -> np.ndarray:
    """Return the readings of a chip at each of TIMES."""
    sensed = SensedMotion(imu, motion)
    return np.array([sensed.at(seconds)[name] for seconds in TIMES.tolist()])


def test_rates_gravity_and_field_at_any_instant():
    attitude = at_times.attitudes(MOTION, TIMES)
    rates = np.degrees(body_rates(attitude, at_times.rates(MOTION, TIMES)))
    gravity, field = (np.array(rows) for rows in zip(*(at_rest(*row) for row in attitude), strict=True))
    assert lsb(IDEAL, MOTION, "gyroscope") / 14.375 == pytest.approx(rates, abs=1e-9)
    assert lsb(IDEAL, MOTION, "accelerometer") / 256 == pytest.approx(gravity, abs=1e-9)
    assert lsb(IDEAL, MOTION, "magnetometer") / 660 == pytest.approx(field, abs=1e-9)


def test_rates_are_body_rates_for_any_choice_of_the_emulator():
    for rates in ("as built", "corrected"):
        imu = replace(IDEAL, gyroscope=replace(IDEAL.gyroscope, rates=rates))
        assert np.array_equal(lsb(imu, MOTION, "gyroscope"), lsb(IDEAL, MOTION, "gyroscope"))


def test_a_lever_arm_adds_accelerations_of_the_rotation():
    """For a roll with rate w and an arm d along y, w x (w x d) is -w^2 d along y, and w' x d is w' d along z."""
    imu = replace(IDEAL, accelerometer=replace(IDEAL.accelerometer, lever_arm=(0.0, 2.0, 0.0)))
    roll = sines.motion(sines.Settings(angles=(sines.AngleWave("phi", 0.5, 0.4),)))
    with_arm, without = (lsb(one, roll, "accelerometer") / 256 for one in (imu, IDEAL))
    omega = 2 * np.pi * 0.4
    rate, change = 0.5 * omega * np.cos(omega * TIMES), -0.5 * omega**2 * np.sin(omega * TIMES)
    by_hand = np.stack([0 * rate, -2 * rate**2, 2 * change], axis=1) / 9.81
    assert np.abs(by_hand).max() > 0.2
    assert with_arm - without == pytest.approx(by_hand, abs=2e-3)  # the derivative is a difference over 0.1 ms


def test_readings_saturate_as_the_converter_and_keep_fractions():
    pushed = kinds()["static"].motion(Pose(ax=0.1, az=-9.0))
    x, _, z = SensedMotion(IDEAL, pushed).at(0.0)["accelerometer"]
    assert x == pytest.approx(25.6) and z == -512


def test_noise_is_added_before_the_converter():
    noise = Noise((1.0, 0.0, 0.0), (0.0, 0.25, 0.0), (0.0, 0.0, 0.1))
    still = kinds()["static"].motion(Pose())
    quiet, noisy = SensedMotion(IDEAL, still).at(0.0), SensedMotion(IDEAL, still).at(0.0, noise)
    added = [np.subtract(noisy[name], quiet[name]).tolist() for name in ("gyroscope", "accelerometer", "magnetometer")]
    assert added == [pytest.approx(row, abs=1e-9) for row in ([14.375, 0, 0], [0, 64, 0], [0, 0, 66])]


def test_readings_follow_the_true_position_of_servos_and_not_the_position_read_back():
    coarse = servo.motion(servo.Settings(resolution=np.radians(5.0), read_every=1.0))
    exact = servo.motion(servo.Settings(resolution=0.0, read_every=0.0))
    for name in ("gyroscope", "accelerometer", "magnetometer"):
        assert np.array_equal(lsb(IDEAL, coarse, name), lsb(IDEAL, exact, name))
    assert np.abs(at_times.attitudes(coarse, TIMES) - at_times.attitudes(exact, TIMES)).max() > np.radians(2.0)
