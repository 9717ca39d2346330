"""Quaternions and aerospace angles agree with rotation matrices written by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.imu.rotations import angle_between, angles, matrices, quaternions, wrapped
from tests.devices.aerospace import to_body

roll_or_yaw = st.floats(-np.pi, np.pi)
pitch = st.floats(-np.pi / 2, np.pi / 2)
attitudes = st.tuples(roll_or_yaw, pitch, roll_or_yaw)


@given(attitudes)
def test_a_quaternion_rotates_as_the_three_matrices(attitude: tuple[float, float, float]):
    (q,) = quaternions([attitude])
    assert np.linalg.norm(q) == pytest.approx(1)
    assert np.allclose(matrices([q])[0].T, to_body(*attitude), atol=1e-12)


@given(attitudes)
def test_angles_of_a_quaternion_give_the_same_rotation(attitude: tuple[float, float, float]):
    (back,) = angles(quaternions([attitude]))
    assert np.allclose(to_body(*back), to_body(*attitude), atol=1e-8)
    if abs(attitude[1]) < 1.5:
        assert np.abs(wrapped(back - np.array(attitude))).max() < 1e-6


@pytest.mark.parametrize("up", [1, -1])
def test_with_the_nose_straight_up_or_down_roll_is_0(up: int):
    (found,) = angles(quaternions([(0.4, up * np.pi / 2, 0.1)]))
    assert found == pytest.approx((0, up * np.pi / 2, 0.1 - up * 0.4), abs=1e-7)


@given(attitudes, st.floats(0, np.pi))
def test_angle_between_is_the_angle_of_the_rotation(attitude: tuple[float, float, float], turn: float):
    (q,) = quaternions([attitude])
    w, x, y, z = q
    c, s = np.cos(turn / 2), np.sin(turn / 2)
    turned = np.array([c * w - s * z, c * x + s * y, c * y - s * x, c * z + s * w])  # about the body's z
    assert angle_between([q], [turned])[0] == pytest.approx(turn, abs=1e-7)
    assert angle_between([q], [-turned])[0] == pytest.approx(turn, abs=1e-7), "q and -q are one attitude"


def test_small_angles_keep_their_digits():
    assert angle_between(quaternions([(0, 0, 0)]), quaternions([(1e-9, 0, 0)]))[0] == pytest.approx(1e-9, rel=1e-6)


def test_angles_are_wrapped_to_plus_or_minus_half_a_turn():
    assert wrapped([3 * np.pi / 2, -3 * np.pi / 2, 0.1]) == pytest.approx([-np.pi / 2, np.pi / 2, 0.1])
