"""All nine codes of a motion against a second derivation: rotations by scipy, the rest by matrices, noise included."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from periph_sim.sensors.models.arrays import codes_of
from periph_sim.sensors.models.imu import Noise
from periph_sim.sensors.models.parameters import (
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)

COUNT, PERIOD = 2000, 0.02
T = np.arange(COUNT) * PERIOD
PHI, THETA, PSI = 1.2 * np.sin(1.1 * T + 0.3), 0.9 * np.sin(0.7 * T + 1), 2.5 * np.sin(0.31 * T)
PUSHED = np.column_stack([0.3 * np.sin(2 * T), 0.2 * np.cos(3 * T), 0.5 * np.sin(0.5 * T)])
GYRO, ACCEL, MAG = (np.random.default_rng(7).normal(scale=s, size=(COUNT, 3)) for s in (0.2, 0.03, 0.005))
ARM = np.array([0.3, -0.2, 0.12])
AZIMUTH, ELEVATION = np.radians([12.0, -7.0])
TO_EARTH = Rotation.from_euler("ZYX", np.column_stack([PSI, THETA, PHI]))  # yaw, pitch, roll; z down


def codes(scale: float, cross: float, bits: int, felt: np.ndarray) -> np.ndarray:
    exact = felt @ (scale * (cross + (1 - cross) * np.eye(3))).T
    return np.clip(np.floor(exact + 0.5), -(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def body_rates() -> np.ndarray:
    """rad/s: each angle's rate about its own axis, turned into the body."""
    phi, theta, psi = (np.diff(angle, prepend=angle[0]) / PERIOD for angle in (PHI, THETA, PSI))
    roll = Rotation.from_euler("X", PHI[:, None]).inv()
    x, y, z = np.eye(3)
    return phi[:, None] * x + theta[:, None] * roll.apply(y) + psi[:, None] * TO_EARTH.inv().apply(z)


def test_every_code_of_a_motion() -> None:
    imu = ImuParameters(
        accelerometer=AccelerometerParameters(lever_arm=(0.3, -0.2, 0.12)),
        gyroscope=GyroscopeParameters(rates="corrected", mounting=(2, -1, 3), g_sens=0.3),
        magnetometer=MagnetometerParameters(board_azimuth=12.0, board_elevation=-7.0),
    )
    noise = Noise(*(tuple(chip.T) for chip in (GYRO, ACCEL, MAG)))
    came = codes_of(imu, (PHI, THETA, PSI), tuple(PUSHED.T), noise)

    omega = body_rates()
    mounted = np.column_stack([omega[:, 1], -omega[:, 0], omega[:, 2]])
    felt = np.degrees(mounted) + [-3.1, 3.6, 0.04] + GYRO + 0.3 * PUSHED
    assert np.array_equal(np.column_stack(came.gyroscope), codes(14.375, 0.02, 16, felt))

    change = np.diff(omega, axis=0, prepend=np.zeros((1, 3))) / PERIOD
    lever = np.cross(omega, np.cross(omega, ARM)) + np.cross(change, ARM)
    felt = PUSHED - TO_EARTH.inv().apply([0, 0, 1]) + lever / 9.81 + [-0.02, 0.02, 0] + ACCEL
    assert np.array_equal(np.column_stack(came.accelerometer), codes(256, 0.01, 10, felt))

    turned = TO_EARTH.inv().apply([0.3239, -0.0447, 0.006])
    x, y, z = turned[:, 0] - 0.16, turned[:, 1] + 0.17, turned[:, 2] - 0.02
    rho, azimuth = np.sqrt(x**2 + y**2 + z**2), np.arctan2(y, x) + AZIMUTH
    elevation = np.arcsin(z / rho) + ELEVATION
    level = rho * np.cos(elevation)
    felt = np.column_stack([level * np.cos(azimuth), level * np.sin(azimuth), rho * np.sin(elevation)]) + MAG
    assert np.array_equal(np.column_stack(came.magnetometer), codes(660, 0.002, 12, felt))


def test_corrected_rates_are_those_of_the_turned_body_and_as_built_are_not() -> None:
    """Within what a backward difference of 20 ms is off; the rotation from sample to sample says what is true."""
    true = np.degrees((TO_EARTH[:-1].inv() * TO_EARTH[1:]).as_rotvec()) / PERIOD
    still = (np.zeros(COUNT),) * 3
    off = {}
    for rates in ("corrected", "as built"):
        gyroscope = GyroscopeParameters(rates=rates, bias=(0.0, 0.0, 0.0), cross_axis=0.0)
        came = (
            np.column_stack(codes_of(ImuParameters(gyroscope=gyroscope), (PHI, THETA, PSI), still).gyroscope)[1:]
            / 14.375
        )
        off[rates] = np.abs(came - true).max()
    assert off["corrected"] < 0.8 and off["as built"] > 30
