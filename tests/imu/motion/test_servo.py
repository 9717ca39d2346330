"""The servo sequence of the moving experiment: its positions, and the resolution with which they are read."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.imu.motion import BadMotion
from periph_sim.imu.motion.servo import Servo, Settings, motion, path
from tests.imu.motion import at_times


def corners(servo: Settings) -> list[tuple[float, str, float]]:
    """Return the expected time, angle and degrees at each end of a movement."""
    at, found = 0.0, []
    for angle, swing in (("theta", servo.pitch), ("psi", servo.yaw), ("phi", servo.roll)):
        place = 0.0
        for to, rate in [(swing, servo.fast), (-swing, servo.slow)] * servo.swings + [(0.0, servo.fast)]:
            at += abs(to - place) / rate
            found.append((at, angle, float(np.degrees(to))))
            at += servo.hold
            place = to
    return found


def test_the_path_has_the_turns_of_section_5_3():
    """52.2 rpm is 313.2 degrees per second, and 2.9 rpm is 17.4."""
    way = path(Settings())
    found = corners(Settings())
    assert [round(at, 3) for at, _, _ in found[:3]] == [0.16, 7.907, 10.226]
    assert [angle for _, angle, _ in found] == ["theta"] * 7 + ["psi"] * 7 + ["phi"] * 7
    column = {"phi": 0, "theta": 1, "psi": 2}
    for at, angle, degrees in found:
        attitude = np.degrees(at_times.attitudes(way, np.array([at, at + 1.9])))
        expected = np.zeros(3)
        expected[column[angle]] = degrees
        assert attitude == pytest.approx(np.tile(expected, (2, 1)), abs=1e-9)
    assert way.ends == pytest.approx(found[-1][0] + 2)


def test_rates_are_the_true_rates_of_the_servo():
    rates = at_times.rates(motion(Settings()), np.array([0.0, 0.1, 1.0, 3.0, 1e6]))
    assert np.degrees(rates[:, 1]) == pytest.approx([313.2, 313.2, 0, -17.4, 0])
    assert not rates[:, [0, 2]].any()


def test_continuous_and_exact_reading_gives_the_path():
    exact = Settings(resolution=0.0, read_every=0.0)
    times = np.linspace(0, path(exact).ends, 5000)
    assert np.array_equal(at_times.attitudes(motion(exact), times), at_times.attitudes(path(exact), times))


@settings(deadline=None, max_examples=20)
@given(st.floats(0.02, 0.5), st.floats(0.05, 2), st.sampled_from(["straight", "hold"]))
def test_a_reading_is_the_nearest_multiple_of_the_resolution(every, resolution, interpolate):
    servo = Settings(swings=1, read_every=every, resolution=radians(resolution), interpolate=interpolate)
    read = np.arange(20) * every
    true, told = at_times.attitudes(path(servo), read), at_times.attitudes(motion(servo), read)
    assert np.abs(true - told).max() <= radians(resolution) / 2 + 1e-12
    steps = told / radians(resolution)
    assert steps == pytest.approx(np.rint(steps), abs=1e-6)


def test_between_two_readings_the_position_is_interpolated_or_held():
    every = Settings().read_every
    read, between = np.array([30, 31]) * every, np.array([30.25]) * every
    for shape, weight in (("straight", 0.25), ("hold", 0.0)):
        servo = motion(Settings(interpolate=shape))
        before, after = at_times.attitudes(servo, read)
        assert at_times.attitudes(servo, between)[0] == pytest.approx(before + weight * (after - before))


def test_the_sequence_ends_at_zero():
    servo = motion(Settings())
    assert isinstance(servo, Servo)
    assert not at_times.attitudes(servo, np.array([servo.ends, servo.ends + 1e6])).any()
    assert not at_times.accelerations(servo, np.array([1.0])).any()


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        (Settings(read_every=1e-6), r"read_every: \d+ positions in 107.517 s; expected at most 1000000, or 0 s"),
        (Settings(read_every=1e-320), "read_every: inf positions in 107.517 s; expected at most 1000000, or 0 s"),
        (Settings(resolution=-0.1), "resolution: it is -0.1 rad; expected 0 rad or more$"),
        (Settings(resolution=1e-310), "resolution: it is 1e-310 rad; expected 0 rad, or 1e-300 rad or more$"),
    ],
)
def test_too_many_readings_and_an_impossible_resolution_are_refused(settings: Settings, sentence: str):
    with pytest.raises(BadMotion, match=f"^{sentence}"):
        motion(settings)
