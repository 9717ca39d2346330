"""The whole experiment with emulator, real sensors and truth, and refused cases."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.imu.moving.experiment import lag_between, run
from periph_sim.imu.moving.text_report import as_json, lines, rms
from periph_sim.imu.rotations import quaternions
from periph_sim.scene.case.model import BadCase
from tests.imu.moving.subjects import STILL, TWO_ANGLES, parameters, subject


def test_over_wires_bytes_equal_the_computed_ones_and_attitudes_those_without_wires():
    one = subject("0.8", TWO_ANGLES)
    over, without = run(one, wires=True), run(one, wires=False)
    assert over.bytes is not None and (over.bytes.compared, over.bytes.different) == (40 * 18 * 2, 0)
    assert without.bytes is None
    for rates in ("as built", "corrected"):
        assert np.array_equal(over.emulated[rates].attitudes, without.emulated[rates].attitudes)
    chips, ideal = (rms(outcome.apart()["real sensors less truth"].total) for outcome in (over, without))
    assert 0 < chips < 1.5 and 0 < ideal < 1.5


def test_at_rest_the_emulator_agrees_with_real_sensors():
    """At this published point no age and no motion disturb: all differences are within the noise."""
    outcome = run(subject("4", STILL), wires=False)
    apart = {name: rms(one.total[50:]) for name, one in outcome.apart().items()}
    assert apart["real sensors less truth"] < 0.6
    assert apart["emulator corrected less truth"] < 0.6
    assert apart["emulator corrected less real sensors"] < 0.9


def test_with_two_angles_only_the_corrected_emulator_follows_and_most_of_its_error_is_lag():
    outcome = run(subject("8", TWO_ANGLES), wires=False)
    apart = {name: rms(one.total) for name, one in outcome.apart().items()}
    assert apart["emulator as built less real sensors"] > 8 > 3 > apart["emulator corrected less real sensors"]
    late = outcome.behind("corrected")
    assert 0.021 < late.seconds < 0.041, "the lag is the data age and half a period of the derivative"
    assert rms(late.apart.total) < 0.5 * apart["emulator corrected less real sensors"]


@pytest.mark.parametrize(
    "changes",
    [
        ("unit.dsp.settings.models_run=frame",),
        (
            "unit.dsp.firmware=imu_hil_robust",
            'unit.dsp.modules=["I2C-A", "SCI-A", "GPIO", "TIMER0", "TIMER1"]',
        ),  # with imu_hil_robust the default is "frame"
    ],
)
def test_models_that_run_once_per_frame_are_only_compared_over_wires(changes: tuple[str, ...]):
    one = subject("0.3", TWO_ANGLES, *changes)
    over = run(one, wires=True)
    assert over.bytes is not None and over.bytes.different == 0 < over.bytes.compared
    with pytest.raises(BadCase) as refused:
        run(one, wires=False)
    assert "unit.dsp.settings.models_run: without wires, the models run once a round" in str(refused.value)


def test_results_as_text_and_json():
    outcome = run(subject("0.3", TWO_ANGLES), wires=True)
    shown = list(lines(outcome))
    assert shown[:2] == ["imu_moving: 15 rounds; emulator in q16, noise of seed 1, over SCI, firmware and", "  I2C"]
    assert shown[-1] == "540 of 540 bytes read from the emulator equal those computed without wires"
    assert max(map(len, shown)) <= 80
    found = json.loads(json.dumps(as_json(outcome)))
    assert found["bytes"] == {"compared": 540, "different": 0}
    total = found["apart"]["emulator corrected less truth"]["total"]
    rows = [line.split()[-1] for line in shown if line.startswith(" emulator corrected less truth")]
    assert rows == [f"{total['rms']:.3f}", f"{total['worst']:.2f}"]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ("host.motion={}", "host: a moving experiment needs a motion; give host.motion"),
        (
            "host.lose=[[3, 4]]",
            "host.lose: a lost byte shifts all others; a moving experiment needs whole frames",
        ),
        ("controller.order=['gyroscope']", "a moving experiment reads gyroscope, accelerometer, magnetometer in each"),
        ("inputs.rounds=['5 ms']", "inputs: a moving experiment has its rounds and frames by the schedules"),
        ("unit.dsp.settings={}", 'needs one unit with sensor models; give it arithmetic = "q16"'),
    ],
)
def test_a_case_without_a_moving_experiment_is_refused_with_its_line(change: str, sentence: str):
    with pytest.raises(BadCase) as refused:
        subject("1", change)
    assert sentence in str(refused.value) and "imu_moving.toml" in str(refused.value)


def test_an_inclined_board_is_refused(tmp_path):
    inclined = parameters(tmp_path, '[magnetometer]\nboard_azimuth = "5 deg"\n')
    with pytest.raises(BadCase, match="does not support an inclined magnetometer board"):
        subject("1", inclined)


TIMES = np.arange(400) * 0.02


def attitude(times: np.ndarray) -> np.ndarray:
    angles = np.stack([np.sin(2 * times), 0.7 * np.sin(1.3 * times), 3 * np.sin(0.9 * times)], axis=1)
    return quaternions(angles)


@settings(max_examples=15)
@given(st.integers(0, 100))
def test_an_injected_lag_is_found(milliseconds: int):
    late = lag_between(TIMES, attitude(TIMES - milliseconds / 1000), attitude(TIMES))
    assert late.seconds == pytest.approx(milliseconds / 1000, abs=0.0011)
    assert late.apart.total.max() < 0.15 and len(late.apart.total) == 395


def test_signs_of_quaternions_do_not_matter():
    signs = np.where(np.arange(400) % 3, 1.0, -1.0)[:, np.newaxis]
    late = lag_between(TIMES, attitude(TIMES - 0.03), attitude(TIMES) * signs)
    assert late.seconds == pytest.approx(0.03, abs=0.0011) and late.apart.total.max() < 0.15


@pytest.mark.parametrize("rounds", [0, 1, 5])
def test_too_short_a_series_has_no_lag(rounds: int):
    late = lag_between(TIMES[:rounds], attitude(TIMES[:rounds]), attitude(TIMES[:rounds]))
    assert (late.seconds, len(late.apart.total)) == (0.0, 0)
