"""Every kind of motion: defaults, ranges, rates that equal the derivative, units in settings, and a test of its own."""

from __future__ import annotations

from math import inf, pi, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.imu.motion import BadMotion, Motion, kinds, sampled, sines, static, steps
from periph_sim.imu.motion.quantities import Pose
from periph_sim.scene.firmware_loader import BadSetting, filled
from tests.imu.motion import at_times

EXAMPLES = {
    "flight": {},  # needs a file: see test_flight
    "servo": {"swings": 1, "hold": "0.5 s"},
    "sines": {"angles": ({"of": "theta", "amplitude": "20 deg", "frequency": "0.5 Hz"},)},
    "static": {"theta": "10 deg"},
    "steps": {"steps": ({"at": "1 s", "theta": "10 deg"},)},
}


def make(name: str, **given: object):
    kind = kinds()[name]
    return kind.motion(filled(kind.Settings, given, name))


def test_all_kinds_are_found_and_each_has_an_example():
    assert sorted(kinds()) == sorted(EXAMPLES)


@pytest.mark.parametrize("name", [name for name, given in EXAMPLES.items() if given])
@settings(deadline=None, max_examples=30)
@given(times=st.lists(st.floats(0, 1e6), min_size=1, max_size=5))
def test_one_time_or_many_give_the_same_finite_values(name: str, times: list[float]):
    motion = make(name, **EXAMPLES[name])
    together = np.hstack([at_times.attitudes(motion, np.array(times)), at_times.accelerations(motion, np.array(times))])
    assert together.shape == (len(times), 6) and at_times.rates(motion, np.array(times)).shape == (len(times), 3)
    assert together.tolist() == [[*sampled(motion, time)] for time in times]


def test_static_stays():
    motion = static.motion(static.Settings(phi=0.1, az=-0.5))
    assert [[*sampled(motion, seconds)] for seconds in (0.0, 1e9)] == [[0.1, 0, 0, 0, 0, -0.5]] * 2
    assert motion.ends == 0 and not at_times.rates(motion, np.array([0.0])).any()


def test_steps_change_the_named_values_and_keep_them():
    motion = make(
        "steps",
        start={"psi": "90 deg"},
        steps=({"at": "1 s", "theta": "10 deg"}, {"at": "2 s", "ax": "0.5 g"}, {"at": "2500 ms", "theta": "-10 deg"}),
    )
    values = np.array([sampled(motion, seconds) for seconds in (0, 0.999, 1, 1.999, 2, 3)])
    assert np.degrees(values[:, 1]) == pytest.approx([0, 0, 10, 10, 10, -10])
    assert np.degrees(values[:, 2]) == pytest.approx([90] * 6)
    assert values[:, 3].tolist() == [0, 0, 0, 0, 0.5, 0.5]
    assert motion.ends == 2.5


def test_steps_with_times_that_do_not_increase_are_refused():
    step = steps.Step
    with pytest.raises(BadMotion, match=r"^steps.1: it is at 1 s; expected later than 1 s, the one before$"):
        steps.motion(steps.Settings((step(at=1.0), step(at=1.0))))


def test_sines_are_added_and_their_rates_equal_the_derivative():
    motion = make(
        "sines",
        mean={"theta": "5 deg"},
        angles=(
            {"of": "theta", "amplitude": "20 deg", "frequency": "0.5 Hz", "phase": "90 deg"},
            {"of": "theta", "amplitude": "3 deg", "frequency": "2 Hz"},
            {"of": "psi", "amplitude": "90 deg", "frequency": "0.1 Hz"},
        ),
        accelerations=({"of": "ay", "amplitude": "981 mg", "frequency": "1 Hz"},),
    )
    times = np.linspace(0, 10, 1001)
    attitude = at_times.attitudes(motion, times)
    assert np.degrees(attitude[0]) == pytest.approx([0, 25, 0])
    assert at_times.accelerations(motion, np.array([0.25]))[0] == pytest.approx([0, 0.981, 0])
    step = 1e-6
    slope = (at_times.attitudes(motion, times + step) - at_times.attitudes(motion, times - step)) / (2 * step)
    assert at_times.rates(motion, times) == pytest.approx(slope, abs=1e-6)
    assert motion.ends == inf


def test_sines_without_waves_are_refused():
    with pytest.raises(BadMotion, match=r"^it has no waves"):
        sines.motion(sines.Settings())


WAVE = sines.AccelerationWave("ax", 60.0, 0.5)


@pytest.mark.parametrize(
    ("motion", "sentence"),
    [
        *(
            (static.motion(Pose(psi=psi)), f"psi is {psi:.6g} rad at 0.5 s; expected -6.28319 to 6.28319 rad")
            for psi in (np.nan, np.inf, -2.1 * pi)
        ),
        (sines.motion(sines.Settings((), (WAVE, WAVE))), "ax is 120 g at 0.5 s; expected -100 to 100 g"),
    ],
)
def test_motion_out_of_range_is_refused_with_name_value_time_and_range(motion: Motion, sentence: str):
    with pytest.raises(BadMotion) as caught:
        sampled(motion, 0.5)
    assert str(caught.value) == f"motion: {sentence}"


@pytest.mark.parametrize(
    ("name", "given", "sentence"),
    [
        ("static", {"theta": 10}, "10 has no unit; write a number, a blank and rad or deg or mrad"),
        ("static", {"psi": 0.5}, "0.5 has no unit; write a number, a blank and rad or deg or mrad"),
        ("servo", {"hold": 2.0}, "2.0 has no unit; write a number, a blank and ns or us or ms or s or min or h or d"),
        ("static", {"theta": "10"}, "'10': expected a number, a blank and rad or deg or mrad"),
        ("static", {"theta": "10 g"}, "'10 g': expected a number, a blank and rad or deg or mrad"),
        ("static", {"theta": "nan deg"}, "'nan deg': 'nan' is not a number"),
        ("static", {"theta": "361 deg"}, "'361 deg': expected -6.28319 to 6.28319 rad"),
        ("static", {"ax": "1e999 g"}, "'1e999 g': '1e999' is not a number"),
        ("static", {"ax": "101 g"}, "'101 g': expected -100 to 100 g"),
        ("static", {"tetha": "1 deg"}, "static has no setting 'tetha'; did you mean theta?"),
        ("servo", {"fast": "0 rpm"}, "'0 rpm': expected 1e-06 to 1000 rad/s"),
        ("servo", {"hold": "-1 s"}, "'-1 s': expected 0 s or more"),
        ("servo", {"swings": 0}, "expected 1 to 100, but it is 0"),
        ("servo", {"interpolate": "cubic"}, "expected 'straight' or 'hold', but it is 'cubic'"),
        ("steps", {}, "it is missing"),
        (
            "steps",
            {"steps": [{"at": "1 s", "roll": "1 deg"}]},
            "0.roll: there is no such key; it has at, phi, theta, psi, ax, ay, az",
        ),
        (
            "sines",
            {"angles": [{"of": "ax", "amplitude": "1 deg", "frequency": "1 Hz"}]},
            "0.of: expected 'phi', 'theta' or 'psi', but it is 'ax'",
        ),
    ],
)
def test_impossible_settings_are_refused_in_one_sentence(name: str, given: dict[str, object], sentence: str):
    with pytest.raises(BadSetting) as caught:
        make(name, **given)
    assert str(caught.value) == sentence


def test_units():
    settings = filled(static.Settings, {"phi": "1/2 rad", "theta": "180 deg", "ax": "9.81 m/s^2", "az": "5 mg"}, "")
    assert (settings.phi, settings.theta, settings.ax) == pytest.approx((0.5, pi, 1.0))
    assert settings.az == 0.005 and radians(180) == pi
