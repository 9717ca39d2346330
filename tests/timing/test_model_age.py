"""The age of values of sensor models when they are read, and their errors compared with the true motion."""

from __future__ import annotations

import pytest

from periph_sim import BadCase, Scene, Verdict, load
from tests.imu.moving.subjects import TWO_ANGLES
from tests.interfaces.reports.explain.made import explain
from tests.scene.runs import TIMING, run_file

AGES = 'budget=[{name = "age", measure = "age", max = "9 s"}, {name = "model age", measure = "model age", max = "9 s"}]'


def judged(name: str, seconds: str, *changes: str) -> dict[str, Verdict]:
    return {verdict.name: verdict for verdict in run_file(name, seconds, *changes).result.budgets}


def test_the_model_age_is_the_data_age_if_chips_show_values_of_frames():
    """A round begins 1.957 ms after a frame, and the magnetometer's read is 3.737 ms after that frame."""
    found = judged("imu_hil_published", "0.2", AGES)
    assert found["model age"].worst == found["age"].worst == pytest.approx(23_933, abs=1)
    assert found["model age"].count == found["age"].count == 30


def test_a_frame_that_the_models_use_again_is_older():
    found = judged("imu_hil_published", "0.3", AGES, "host.period=40 ms")
    assert found["model age"].worst == found["age"].worst == pytest.approx(43_933, abs=1)
    stopped = judged("imu_hil_published", "0.3", AGES, "host.frames=2")
    assert stopped["model age"].worst == stopped["age"].worst == pytest.approx(263_933, abs=1)


def test_a_frame_sent_while_the_models_run_does_not_reduce_the_age():
    """The models run from 7.62 ms, after the round, to 23.62 ms. The next frame ends at 23.04 ms."""
    found = judged("imu_hil_published", "0.2", AGES, "unit.dsp.settings.model_cost=16 ms")
    assert found["model age"].worst == found["age"].worst == pytest.approx(23_933, abs=1)


def test_without_a_frame_there_is_no_age():
    found = judged("imu_hil_published", "0.1", AGES, "host.frames=0")
    assert (found["model age"].verdict, found["model age"].count) == ("not judged", 0)
    assert found["model age"].found == "no span 'model' was over that began after a host frame had come"
    assert (found["age"].verdict, found["age"].count, found["age"].occasions) == ("not judged", 0, 0)


def test_the_worst_model_age_is_explained_from_the_frame_to_the_read():
    case = load(TIMING / "imu_moving.toml", [AGES, "duration=0.1 s"])
    scene = Scene(case)
    (worst,) = [verdict for verdict in scene.run().budgets if verdict.name == "model age"]
    explained = explain(case, [worst])["model age"]
    request, entered, frame, *steps, read = explained.chain.steps
    assert request.what == "SCI-A.SCIFFRX.RXFFINT set (the request that set it)"
    assert entered.what.startswith("SCIRXINTA entered"), "the module receives a character before its stop bit is over"
    assert frame.what.startswith("RX: ") and frame.what.endswith(" is over")
    assert read.at == 0 and read.what.startswith("repeated START, magnetometer")
    assert -frame.at - explained.chain.length in (0, 1)  # the age is measured to the nanosecond, three ticks
    assert any("model" in step.what for step in steps)
    assert explained.chain.length == explained.window.end - explained.window.begin == round(worst.worst * 3000)


# The case of the moving experiment -------------------------------------------------------------------------------


def test_the_case_passes_on_age_and_error_at_the_same_time():
    found = judged("imu_moving", "1")
    assert {verdict.verdict for verdict in found.values()} == {"pass"}
    assert found["fresh and right"].count == 47
    assert "model age 21.043 ms" in found["fresh and right"].found


@pytest.mark.parametrize(
    ("change", "measure"),
    [
        ("host.first=2 ms", "model age"),  # also ready before the models, but for a longer time
        ("host.first=7 ms", "model age"),  # ends too late for the models of its round
        ("host.motion.read_every=400 ms", "value error of accelerometer"),  # straight lines while the servos turn
        ("unit.dsp.settings.arithmetic=q3", "value error of accelerometer"),
    ],
)
def test_one_changed_line_breaks_the_case(change: str, measure: str):
    found = judged("imu_moving", "1", change)["fresh and right"]
    assert (found.verdict, found.measure) == ("fail", measure)


def test_only_the_corrected_gyroscope_is_correct_when_two_angles_change(tmp_path):
    (tmp_path / "corrected.toml").write_text('[gyroscope]\nrates = "corrected"\n')
    corrected = f"unit.dsp.settings.parameters={tmp_path / 'corrected.toml'}"
    budget = (
        'budget=[{name = "gyroscope", measure = "value error of gyroscope at frame", max = "20 LSB", after = "50 ms"}]'
    )
    assert judged("imu_moving", "1.5", TWO_ANGLES, budget)["gyroscope"].verdict == "fail"
    assert judged("imu_moving", "1.5", TWO_ANGLES, budget, corrected)["gyroscope"].verdict == "pass"


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            "budget=[{name='v', measure='value error', max=1}]",
            r"budget\.v\.measure: 'value error' of sensor models needs ",
        ),
        (
            "budget=[{name='f', measure='count of frame RX error', max=1}, "
            "{name='v', measure='count of record data value error', max=1}]",
            r"budget\.v\.measure: 'count of record data value error' of sensor models",
        ),
        (
            "serial.expect=[{name='e', from='SCI-A', text='x', within='9 ms', after='record data value error'}]",
            r"host: a value error of sensor models needs a motion to compare with; give \[host\.motion\]",
        ),
    ],
)
def test_values_of_models_without_a_motion_have_no_truth(change: str, sentence: str):
    with pytest.raises(BadCase, match=sentence):
        run_file("imu_models", "0.1", change)
