"""A session captured from a simulated run: in its replay the firmware acts the same and the budgets are equal."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest

from periph_sim.replay.report import Report
from periph_sim.replay.session import SessionReplay, _bursts
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from periph_sim.timing.verdict import Verdict
from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Capture
from periph_sim.traces.decode import i2c
from periph_sim.traces.decode.uart import Event, Line, UartRowKind
from tests.replay.make_session import ran, sampled, samples
from tests.replay.slow import slow_case
from tests.scene.runs import TIMING, Edges
from tests.traces.decode.drawing import of_bytes
from tests.traces.formats.make_traces import FOLDER

US = Fraction(1, 10**6)
IMU = TIMING / "imu_hil_published.toml"
HOST = Line(115200)


def replay(capture: Capture, *changes: str, case: Path = IMU, **options) -> Report:
    given = {"wanted": HOST, "longest_low": 5 * US, **options}
    serial = given.pop("serial", capture)
    return SessionReplay(load(case, list(changes)), capture, "SCL", "SDA", serial, "RX", **given).run()


def by_name(budgets: list[Verdict]) -> dict[str, Verdict]:
    return {verdict.name: verdict for verdict in budgets}


@cache
def run(*changes: str) -> tuple[Result, Capture]:
    return ran(Fraction(110, 1000), *changes)


OF_ROUNDS = {"round complete", "missed rounds", "nacked rounds", "schedule slack"}


@pytest.mark.parametrize("rate", [None, 8_000_000, 1_000_000])
@pytest.mark.parametrize("changes", [(), ("unit.dsp.settings.model_cost=400 us",), ("host.period=7 ms",)])
def test_the_same_bytes_and_the_same_budgets_within_the_sampling_period(rate, changes):
    result, edges = run(*changes)
    report = replay(edges if rate is None else sampled(edges, rate), *changes)
    assert report.first_divergence is None and report.agreed == report.events == 6 * 3 * 21
    was, came = by_name(result.budgets), by_name(report.budgets)
    assert set(came) >= OF_ROUNDS, "rounds are read off the captured bus"
    assert report.verdict == ("pass" if all(came[name].verdict == "pass" for name in came) else "fail")
    period = 0.01 if rate is None else 1e6 / rate
    for name, verdict in came.items():
        assert verdict.verdict == was[name].verdict, name
        tolerance = 2 * period if verdict.unit == "us" else 0
        assert verdict.worst == pytest.approx(was[name].worst, abs=tolerance), name
        if name not in ("model execution", "SCI FIFO high-water"):  # which extend beyond the capture
            assert verdict.count == was[name].count, name


def test_longest_low_makes_no_event_of_a_sampled_capture_early():
    """At 4 MHz the low phases of 5 us are captured as 5 or 5.25 us."""
    report = replay(sampled(run()[1], 4_000_000), tolerance=US)
    assert report.verdict == "pass" and report.lag_worst_us <= 0.5


def test_the_trace_of_the_repository_passes():
    report = replay(formats.read(FOLDER / "imu_session.sr"))
    assert (report.verdict, report.kind, report.agreed) == ("pass", "session", 3 * 3 * 21)
    came = by_name(report.budgets)
    assert came["response"].worst == pytest.approx(5, abs=1) and came["response"].count == 9
    assert came["data age"].worst == pytest.approx(23_933, abs=2) and came["SCI FIFO high-water"].worst == 12
    assert came["data age"].at_s == pytest.approx(0.026975, abs=2e-6), "counted from the capture's begin"
    later = replay(formats.read(FOLDER / "imu_session.sr"), "start=10 s")
    assert by_name(later.budgets)["data age"].at_s == came["data age"].at_s
    assert later.simulated_s == report.simulated_s == pytest.approx(0.051), "from 1 ms before the capture's 50 ms"


def test_budgets_on_rounds_that_the_capture_does_not_have_are_left_out_by_name():
    notes = [note for note in replay(run()[1], first=2).notes if "is not judged" in note]
    assert notes[0] == (
        "budget 'round complete' is not judged: 'round' needs rounds of the case's requests, and the capture has none"
    )
    assert len(notes) == len(OF_ROUNDS)


def test_a_request_that_is_not_in_the_capture_is_a_missed_round_and_not_a_nack():
    """In the second round, register 30 of the accelerometer is read instead of 32."""
    capture = formats.read(FOLDER / "imu_session.sr")
    changed = i2c.transfers(capture, "SCL", "SDA")[4].phases[0].bytes[1].bits[6]
    assert changed.high is not None
    wave = bytearray(samples(capture))
    for place in range(changed.at - 3, changed.at + changed.high):
        wave[place] ^= 2
    report = replay(of_bytes(bytes(wave), ("SCL", "SDA", "RX"), 1_000_000))
    came = by_name(report.budgets)
    assert report.first_divergence is None and report.verdict == "fail"
    assert (came["nacked rounds"].worst, came["missed rounds"].worst) == (0, 1)
    (note,) = [note for note in report.notes if "none of the case's requests" in note]
    assert note.endswith("missed: 1; the first, at 0.025890 s, writes 30 to 0x53")


# Differences from the captured run -----------------------------------------------------


def test_a_slower_model_breaks_its_budget_on_the_captured_session():
    report = replay(run()[1], "unit.dsp.settings.model_cost=320 us")
    came = by_name(report.budgets)
    assert report.first_divergence is None, "the bytes are still the right ones"
    assert report.verdict == "fail" and came["model execution"].verdict == "fail"
    assert came["model execution"].worst == 320


def test_firmware_that_does_not_wait_for_sdir_sends_wrong_bytes():
    report = replay(run()[1], "unit.dsp.settings.sdir_wait=false")
    assert report.verdict == "fail" and report.divergences[0].kind == "byte"
    assert any(change.what == "W I2C-A.I2CDXR" for change in report.divergences[0].history)
    assert by_name(report.budgets)["wrong bytes"].verdict == "fail"


def test_a_host_at_another_time_gives_other_ages():
    """The second of two files may begin earlier or later than the first."""
    _, edges = run()
    on_time, early = (by_name(replay(edges, serial=edges, offset=Fraction(at, 1000)).budgets) for at in (0, -2))
    assert early["data age"].worst == pytest.approx(on_time["data age"].worst + 2000, abs=1)


# Stretches -----------------------------------------------------------------------------

BUDGETS = """
[controller]
period = "2 ms"
first = "1 ms"

[[controller.request]]
address = 0x50
count = 1
expect = "a7"

[host]
first = "0.5 ms"
period = "5 ms"

[[budget]]
name = "stretch"
measure = "stretch"
max = "50 us"

[[budget]]
name = "response"
measure = "response"
max = "80 us"

[[budget]]
name = "wrong bytes"
measure = "wrong bytes"
max = 0
"""


@pytest.mark.parametrize("wait", [0, 40, 90])
def test_with_longest_low_stretches_are_those_of_the_captured_run(tmp_path, wait):
    """The wires do not show who held SCL. With --longest-low the firmware holds it itself, as in the run."""
    case = slow_case(tmp_path, '"I2C-A", "SCI-A"', BUDGETS)
    change = f"unit.dsp.settings.wait={wait}"
    edges = Edges()
    scene = Scene(load(case, [change]), edges.subscribe)
    was = by_name(scene.run(Fraction(20, 1000)).budgets)
    capture = edges.capture(scene.kernel.now + 1)
    report = replay(capture, change, case=case)
    came = by_name(report.budgets)
    for name in ("stretch", "response", "wrong bytes"):
        assert (came[name].worst, came[name].count) == pytest.approx((was[name].worst, was[name].count), abs=0.01)
        assert came[name].verdict == was[name].verdict
    assert report.lag_worst_us == pytest.approx(0, abs=0.01)
    as_captured = replay(capture, change, case=case, longest_low=None)
    assert by_name(as_captured.budgets)["stretch"].worst == 0
    assert any("--longest-low TIME" in note for note in as_captured.notes)


@pytest.mark.parametrize(("byte", "wrong"), [(0x22, 0), (0xA7, 10)])
def test_without_a_check_against_the_host_the_captured_bytes_are_expected(tmp_path, byte: int, wrong: int):
    """The captured byte is 22, whatever the case expects."""
    case = slow_case(tmp_path, '"I2C-A", "SCI-A"', BUDGETS)
    edges = Edges()
    scene = Scene(load(case, ["unit.dsp.settings.byte=0x22"]), edges.subscribe)
    scene.run(Fraction(20, 1000))
    report = replay(edges.capture(scene.kernel.now + 1), f"unit.dsp.settings.byte={byte}", case=case)
    judged = by_name(report.budgets)["wrong bytes"]
    assert (judged.verdict, judged.worst, judged.count) == ("fail" if wrong else "pass", wrong, 10)


STUCK = """
[[budget]]
name = "stuck"
measure = "stuck"
max = 0
"""


def test_firmware_that_holds_scl_until_patience_is_over_is_stuck(tmp_path):
    case = slow_case(tmp_path, '"I2C-A", "SCI-A"', BUDGETS + STUCK)
    edges = Edges()
    scene = Scene(load(case), edges.subscribe)
    scene.run(Fraction(20, 1000))
    for wait, times in ((1_000, 0), (100_000, 1)):
        report = replay(
            edges.capture(scene.kernel.now + 1),
            f"unit.dsp.settings.wait={wait}",
            case=case,
            patience=Fraction(10, 1000),
        )
        assert by_name(report.budgets)["stuck"].worst == times


def test_a_frame_ends_with_its_twelfth_byte_or_a_pause():
    """Bytes are 10 positions apart; a pause of more than 30 also ends a frame."""
    begins = [*range(0, 140, 10), 160, 190, 221, 231]
    found = _bursts([Event(UartRowKind.FRAME, at, at + 10) for at in begins], Fraction(30), 12)
    assert [[frame.at for frame in burst] for burst in found] == [begins[:12], begins[12:16], begins[16:]]


def test_a_session_needs_both_modules_in_one_unit():
    with pytest.raises(BadCase, match="no unit has SCI-A"):
        replay(run()[1], case=TIMING / "responder.toml")
