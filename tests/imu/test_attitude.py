"""Attitude from samples: static attitudes in all directions, motion, wrong starts, missing samples, refused input."""

from __future__ import annotations

import itertools
import sys

import numpy as np
import pytest

from periph_sim.imu.attitude import VARIANCES, NoAttitude, errors, estimate
from periph_sim.imu.rotations import quaternions
from tests.devices.aerospace import FIELD, at_rest, body_rates, to_body

STEP = 0.02
TURNS = np.radians([-170, -90, -30, 0, 45, 180])
PITCHES = np.radians([-90, -89.9, -60, 0, 30, 90])


def still(attitude: tuple[float, float, float], number: int) -> dict[str, np.ndarray]:
    accel, mag = at_rest(*attitude)
    return {
        "seconds": np.arange(number) * STEP,
        "gyro": np.zeros((number, 3)),
        "accel": np.tile(accel, (number, 1)),
        "mag": np.tile(mag, (number, 1)),
        "field": FIELD,
    }


def moving(number: int) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Return samples of sines about all three axes, with yaw through half a turn, and the true quaternions."""
    t = np.arange(number) * STEP
    high, speed = np.radians([60, 70, 200]), np.array([1.0, 0.7, 0.3])
    angles = high * np.sin(np.outer(t, speed))
    between = t - STEP / 2  # a rate is that in the middle of the step before the sample
    rates = body_rates(high * np.sin(np.outer(between, speed)), high * speed * np.cos(np.outer(between, speed)))
    seen = [to_body(*a) for a in angles]
    accel, mag = (np.array([m @ v for m in seen]) for v in ([0, 0, -1], FIELD))
    samples = {"seconds": t, "gyro": np.degrees(rates), "accel": accel, "mag": mag, "field": FIELD}
    return samples, quaternions(angles)


@pytest.mark.parametrize("attitude", [*itertools.product(TURNS, PITCHES, TURNS)])
def test_static_attitudes_in_every_direction_are_estimated(attitude: tuple[float, float, float]):
    samples = still(attitude, 10)
    found = errors(estimate(**samples), np.tile(quaternions([attitude]), (10, 1)))
    assert found.total.max() < 1e-5
    if abs(attitude[1]) < 1.5:
        assert max(np.abs(e).max() for e in (found.roll, found.pitch, found.yaw)) < 1e-4


@pytest.mark.parametrize(
    ("attitude", "signs"), [((0.3, 0, 0), (1, 0, 0)), ((0, 0.3, 0), (0, 1, 0)), ((0, 0, 0.3), (0, 0, 1))]
)
def test_errors_are_estimate_less_truth(attitude: tuple[float, ...], signs: tuple[int, ...]):
    """Right wing down is positive roll, nose up is positive pitch, a turn to the east is positive yaw."""
    found = errors(quaternions([attitude]), quaternions([(0, 0, 0)]))
    assert [found.roll[0], found.pitch[0], found.yaw[0]] == pytest.approx(np.degrees(0.3) * np.array(signs))


def test_a_yaw_error_across_south_is_small():
    found = errors(quaternions([(0, 0, np.radians(179))]), quaternions([(0, 0, np.radians(-179))]))
    assert found.yaw[0] == pytest.approx(-2) and found.total[0] == pytest.approx(2)


def test_the_estimate_follows_a_motion_and_does_not_without_the_gyroscope():
    samples, truth = moving(1500)
    assert errors(estimate(**samples), truth).total.max() < 0.1
    assert errors(estimate(**samples | {"gyro": samples["gyro"] * 0}), truth).total.max() > 5


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_effect_of_a_wrong_start_decays(axis: int):
    attitude = (0.2, -0.4, 1.0)
    samples = still(attitude, 500)
    wrong = np.array(attitude)
    wrong[axis] += 0.7
    found = errors(estimate(**samples, start=quaternions([wrong])[0]), np.tile(quaternions([attitude]), (500, 1)))
    assert found.total[0] > 20 and found.total[-1] < 0.1


def test_variances_weight_the_sensors():
    """With a gyroscope bias of 3 deg/s, the error is smaller with a larger variance of the gyroscope."""
    samples = still((0, 0, 0), 1500)
    samples["gyro"] = samples["gyro"] + [3, 0, 0]
    truth = quaternions(np.zeros((1500, 3)))
    little, much = (errors(estimate(**samples, variances=(gyro, 0.01, 0.01)), truth).total[-1] for gyro in (1.0, 1e-6))
    assert little < 0.5 < 5 < much


def test_default_variances_are_those_of_the_library():
    filters = pytest.importorskip("ahrs.filters", reason="ahrs is not installed: the extra attitude has it")
    own = filters.EKF(magnetic_ref=FIELD.tolist())
    assert [own.g_noise, own.a_noise, own.m_noise] == [*VARIANCES]


def test_uneven_steps_are_integrated_with_their_lengths():
    samples, truth = moving(1500)
    kept = np.r_[0:500, 500:1500:2]
    rates = samples["gyro"].copy()
    rates[501:] = (rates[501:] + rates[500:-1]) / 2  # a step of twice the length has the mean of both rates
    thin = {name: data if name == "field" else data[kept] for name, data in (samples | {"gyro": rates}).items()}
    assert errors(estimate(**thin), truth[kept]).total.max() < 0.3


@pytest.mark.parametrize("name", ["accel", "mag"])
@pytest.mark.parametrize("gone", [np.nan, 0.0])
def test_samples_without_a_value_are_skipped(name: str, gone: float):
    """An overflow of the magnetometer is NaN, and free fall reads as zero."""
    samples, truth = moving(600)
    samples[name][100:150] = gone
    assert errors(estimate(**samples), truth).total.max() < 0.5


def test_the_first_attitude_depends_on_directions_and_not_on_lengths():
    samples = still((0.3, -0.7, 2.0), 1)
    for accel, mag, field in ((3, 1, 1), (1, 5, 1), (1, 1, 7)):
        scaled = {"accel": samples["accel"] * accel, "mag": samples["mag"] * mag, "field": FIELD * field}
        assert estimate(**samples | scaled) == pytest.approx(estimate(**samples), abs=1e-12)


def test_no_samples_give_no_attitudes():
    assert estimate([], np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3)), FIELD).shape == (0, 4)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"gyro": np.zeros((2, 3))}, r"gyro has shape \(2, 3\); expected \(3, 3\)"),
        ({"accel": np.zeros(3)}, r"accel has shape \(3,\)"),
        ({"seconds": [0, 1, 1]}, "one rising row"),
        ({"seconds": [0, np.nan, 1]}, "one rising row"),
        ({"gyro": [[0, 0, 0], [np.inf, 0, 0], [0, 0, 0]]}, r"gyro\[1\] is \[inf, 0.0, 0.0\]"),
        ({"field": [0, 0, 0]}, "not all of them 0"),
        ({"field": [0, 0]}, "expected north, east, down"),
        ({"field": [0, 0, 1]}, "gravity and field are parallel"),
        ({"mag": np.full((3, 3), np.nan)}, "the first sample has no usable accel and mag"),
    ],
)
def test_unusable_samples_are_refused(change: dict[str, object], sentence: str):
    with pytest.raises(NoAttitude, match=sentence):
        estimate(**(still((0, 0, 0), 3) | change))


def test_a_truth_of_another_length_is_refused():
    with pytest.raises(NoAttitude, match="must both be n quaternions"):
        errors(np.ones((2, 4)), np.ones((3, 4)))


def test_without_the_library_the_error_names_the_package(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "ahrs.filters", None)
    with pytest.raises(NoAttitude, match=r"pip install 'periph-sim\[attitude\]'"):
        estimate(**still((0, 0, 0), 3))


def test_the_package_can_be_imported_without_the_library():
    """The library is imported only when it is needed."""
    import subprocess

    program = "import sys, periph_sim.imu.attitude, periph_sim.imu.samples; print('ahrs' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, text=True).stdout == "False\n"
