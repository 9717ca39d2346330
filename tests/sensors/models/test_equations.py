"""The equations of chapter 4 and appendix B against matrices written down here, and the figures at rest."""

from __future__ import annotations

from math import cos, degrees, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim.sensors.models.accelerometer import gravity
from periph_sim.sensors.models.angles import angles
from periph_sim.sensors.models.derivative import Derivative
from periph_sim.sensors.models.gyroscope import body_rates
from periph_sim.sensors.models.imu import Imu, Noise, State
from periph_sim.sensors.models.magnetometer import Magnetometer, rotated
from periph_sim.sensors.models.output import Output
from periph_sim.sensors.models.parameters import (
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
    SensorParameters,
)
from periph_sim.sensors.numeric.float64 import Float64
from periph_sim.sensors.numeric.vectors import vectors_of

A = Float64()
ANGLE = st.floats(-pi, pi)
TRIPLE = st.tuples(*[st.floats(-5, 5)] * 3)
ZERO = (0.0, 0.0, 0.0)


def rx(a: float) -> np.ndarray:
    return np.array([[1, 0, 0], [0, cos(a), sin(a)], [0, -sin(a), cos(a)]])


def ry(a: float) -> np.ndarray:
    return np.array([[cos(a), 0, -sin(a)], [0, 1, 0], [sin(a), 0, cos(a)]])


def rz(a: float) -> np.ndarray:
    return np.array([[cos(a), sin(a), 0], [-sin(a), cos(a), 0], [0, 0, 1]])


@given(ANGLE, ANGLE, ANGLE, TRIPLE)
def test_the_field_is_turned_by_rx_ry_rz(roll: float, pitch: float, yaw: float, field: tuple) -> None:
    turned = rotated(vectors_of(A), angles(A, (roll, pitch, yaw)), field)
    assert turned == pytest.approx(rx(roll) @ ry(pitch) @ rz(yaw) @ np.array(field), abs=1e-12)


@given(ANGLE, ANGLE, TRIPLE)
def test_body_rates_are_the_sum_of_appendix_b(roll: float, pitch: float, rates: tuple) -> None:
    phi, theta, psi = rates
    whole = np.array([phi, 0, 0]) + rx(roll) @ [0, theta, 0] + rx(roll) @ ry(pitch) @ [0, 0, psi]
    assert body_rates(A, rates, angles(A, (roll, pitch, 0.0))) == pytest.approx(whole, abs=1e-12)


@given(ANGLE, ANGLE)
def test_gravity_is_the_turned_vertical(roll: float, pitch: float) -> None:
    assert gravity(A, angles(A, (roll, pitch, 0.3))) == pytest.approx(
        rx(roll) @ ry(pitch) @ rz(0.3) @ [0, 0, 1], abs=1e-12
    )


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_one_angle_from_zero_reads_the_same_as_built_and_corrected(axis: int) -> None:
    """Why the error did not show in the dissertation's experiments."""
    rates = tuple(float(i == axis) for i in range(3))
    attitude = tuple(0.4 * (i == axis) for i in range(3))
    assert body_rates(A, rates, angles(A, attitude)) == pytest.approx(rates)


def test_the_derivative_is_the_backward_difference() -> None:
    rates = Derivative(A, 0.02).rates((0.1, -0.2, 0.3), (0.0, 0.0, 0.1))
    assert rates == pytest.approx((5.0, -10.0, 10.0))


def test_yaw_through_180_degrees_as_built_and_unwrapped() -> None:
    before, now = (0.0, 0.0, radians(179)), (0.0, 0.0, radians(-179))
    plain = Derivative(A, 0.02).rates(now, before)[2]
    short = Derivative(A, 0.02, "unwrapped").rates(now, before)[2]
    assert (degrees(plain), degrees(short)) == pytest.approx((-358 / 0.02, 2 / 0.02))
    assert degrees(Derivative(A, 0.02, "unwrapped").rates(before, now)[2]) == pytest.approx(-2 / 0.02)


@given(TRIPLE, TRIPLE, TRIPLE, st.tuples(*[st.floats(-1, 1)] * 3))
def test_lever_arm_of_equation_4_3(acceleration: tuple, body: tuple, before: tuple, arm: tuple) -> None:
    sensor = AccelerometerParameters(lever_arm=arm, scale=1000.0, bits=16, cross_axis=0.0, bias=ZERO)
    model = Imu(A, ImuParameters(accelerometer=sensor))
    codes = model.codes(angles(A, ZERO), acceleration, body, before, model.silence).accelerometer
    w, change, d = np.array(body), (np.array(body) - before) / 0.02, np.array(arm)
    exact = np.array(acceleration) - [0, 0, 1] + (np.cross(w, np.cross(w, d)) + np.cross(change, d)) / 9.81
    assert codes == pytest.approx(np.clip(1000 * exact, -32768, 32767), abs=0.5001)


@given(TRIPLE, st.floats(-90, 90), st.floats(-40, 40))
def test_turning_the_field_without_angles_gives_the_same(field: tuple, azimuth: float, elevation: float) -> None:
    by_angles = MagnetometerParameters(board_azimuth=azimuth, board_elevation=elevation)
    x, y, z = field
    if x * x + y * y < 1e-6:
        return
    wanted = Magnetometer(A, by_angles).on_board(field)
    azimuth_seen, elevation_seen = (
        np.arctan2(y, x) + radians(azimuth),
        np.arctan2(z, np.hypot(x, y)) + radians(elevation),
    )
    rho = np.linalg.norm(field)
    flat = rho * cos(elevation_seen)
    assert wanted == pytest.approx(
        (flat * cos(azimuth_seen), flat * sin(azimuth_seen), rho * sin(elevation_seen)), abs=1e-9
    )
    for norm in ("squares", "mag"):
        for way in ("four-quadrant", "rotation"):
            assert Magnetometer(A, replace(by_angles, spherical=way, norm=norm)).on_board(field) == pytest.approx(
                wanted, abs=1e-9
            )


@pytest.mark.parametrize(
    ("x", "y", "same"), [(1.0, 0.5, True), (1.0, -0.5, True), (-1.0, 0.5, False), (-1.0, -0.5, False)]
)
def test_plain_arctangents_turn_the_left_half_plane_round(x: float, y: float, same: bool) -> None:
    seen = Magnetometer(A, MagnetometerParameters(spherical="plain")).on_board((x, y, 0.2))
    assert seen == pytest.approx((x, y, 0.2) if same else (-x, -y, 0.2))


def test_a_field_along_z_stays_there() -> None:
    for way in ("four-quadrant", "rotation"):
        assert Magnetometer(A, MagnetometerParameters(spherical=way)).on_board((0.0, 0.0, -0.3)) == pytest.approx(
            (0, 0, -0.3)
        )
        assert Magnetometer(A, MagnetometerParameters(spherical=way)).on_board(ZERO) == ZERO


@given(TRIPLE, st.sampled_from([AccelerometerParameters(), GyroscopeParameters(), MagnetometerParameters()]))
def test_output_is_s_with_cross_axis_saturated_and_rounded(felt: tuple, sensor: SensorParameters) -> None:
    s = sensor.scale * (np.eye(3) + sensor.cross_axis * (1 - np.eye(3)))
    wanted = np.clip(s @ felt, *sensor.limits)
    codes = Output(A, sensor).codes(felt)
    assert codes == pytest.approx(wanted, abs=0.5001)
    assert all(code == int(code) for code in codes)
    floors = Output(A, replace(sensor, rounding="floor")).codes(felt)
    assert all(0 <= exact - code < 1.0001 for exact, code in zip(wanted, floors, strict=True))


def test_at_rest_and_level() -> None:
    """Biases of Table 4.1 through S: what Table 5.1's emulated means are, within half a code."""
    model = Imu(A, ImuParameters())
    codes, left = model.step(ZERO, ZERO, model.silence, model.at_rest)
    assert codes.gyroscope == (round(14.375 * (-3.10 + 0.02 * 3.64)), round(14.375 * (3.60 - 0.02 * 3.06)), 1)
    assert codes.accelerometer == (round(256 * (-0.02 + 0.01 * -0.98)), round(256 * (0.02 + 0.01 * -1.02)), -256)
    field = 0.3239 - 0.16, -0.0447 + 0.17, 0.0060 - 0.02
    crossed = [0.998 * axis + 0.002 * sum(field) for axis in field]
    assert codes.magnetometer == tuple(round(660 * axis) for axis in crossed)
    assert left == State(ZERO, ZERO)


def test_noise_mounting_and_g_sensitivity_come_before_s() -> None:
    plain = replace(GyroscopeParameters(), bias=ZERO, cross_axis=0.0, g_sens=0.5)
    model = Imu(A, ImuParameters(gyroscope=replace(plain, mounting=(2, -1, 3))))
    noise = Noise((1.0, 0.0, 0.0), ZERO, ZERO)
    step = (radians(10) * 0.02, radians(20) * 0.02, 0.0)
    codes, _ = model.step(step, (0.0, 0.0, 4.0), noise, model.at_rest)
    assert codes.gyroscope == tuple(round(14.375 * rate) for rate in (20 + 1, -10, 0.5 * 4))
