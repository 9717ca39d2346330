"""The HTML page of a replay has a row for each divergence, with the waves of the replay above those of the capture."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.interfaces.reports.html.gather import CaseReport
from periph_sim.interfaces.reports.html.page import page
from periph_sim.interfaces.reports.html.replayed import replay_report
from periph_sim.replay.i2c_closed_loop import I2cReplay
from periph_sim.replay.i2c_master import I2cMasterReplay
from periph_sim.replay.i2c_open_loop import I2cOpenReplay
from periph_sim.replay.replay import Replay
from periph_sim.replay.session import SessionReplay
from periph_sim.replay.uart import UartReplay, line_format
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from tests.interfaces.commands.test_replay import WRONG
from tests.replay.test_i2c_replay import CASES, RESPONDER
from tests.replay.test_polling import memory, stored_and_read
from tests.traces.formats.make_traces import FOLDER

__all__ = ["memory"]  # a fixture

BUSY = 900  # us; the captured memory refuses three polls, 310 us apart


def reported(case: Path, player: type[Replay], *arguments: object, changes: tuple[str, ...] = ()) -> CaseReport:
    loaded = load(case, list(changes))
    replay = player(loaded, *arguments)  # type: ignore[arg-type]
    return replay_report(loaded, replay, replay.run(), changes)


@pytest.mark.parametrize("busy_us", [BUSY, 3000])
def test_a_wrong_byte_is_marked_in_the_waves_of_the_replay_and_of_the_capture_below_it(memory: Path, busy_us: int):
    changes = ("unit.dsp.settings.broken=true", f"unit.dsp.settings.busy_us={busy_us}")
    report = reported(memory, I2cReplay, stored_and_read(3), "SCL", "SDA", [0x50], changes=changes)
    (row,) = report.budgets
    assert (report.verdict, row.verdict.name, row.verdict.verdict) == ("fail", "first wrong byte", "fail")
    assert row.failure is not None and row.timeline is not None
    assert row.failure.what.startswith("expected data read 21 at 0.003640 s of the capture, found data read 20 at ")
    assert row.failure.why.startswith("I2CDXR = 0x20 was written at memory.py:24")
    assert row.failure.source is not None and row.failure.source.line == 24
    lanes = {lane.name: lane for _, group in row.timeline.groups for lane in group}
    marked = {}
    for name in ("bytes", "captured bytes"):
        lane = lanes[name]
        marked[name] = [one[:2] for one in zip(lane.labels, lane.at, lane.strong, strict=True) if one[2]]
    assert marked["bytes"] == [("0x20 not 0x21", 0)]
    assert marked["captured bytes"] == [("0x21", 0)], "aligned at the last event that agreed"
    assert [data for line in row.timeline.rows for data in line.data if data[2]] == [("20", "NACK", "21")]
    assert "expected data read 21" in page([report], report.name)


def test_the_captured_waves_equal_those_of_the_replay_where_both_agree(memory: Path):
    changes = ("unit.dsp.settings.broken=true", f"unit.dsp.settings.busy_us={BUSY}")
    (row,) = reported(memory, I2cReplay, stored_and_read(3), "SCL", "SDA", [0x50], changes=changes).budgets
    lanes = {lane.name: lane for _, group in row.timeline.groups for lane in group}
    clock, captured = (set(lanes[name].at) for name in ("SCL", "captured SCL"))
    assert clock == captured and len(clock) > 100
    assert lanes["captured SCL"].initial == 1
    assert {"0x50 W", "0x50 R"} < set(lanes["captured bytes"].labels) < set(lanes["bytes"].labels)


def test_a_replay_without_divergences_has_one_row_with_the_number_of_its_events():
    report = reported(RESPONDER, I2cReplay, formats.read(FOLDER / "imu_round.sr"), "SCL", "SDA", [0x53])
    (row,) = report.budgets
    assert (report.verdict, report.standing, report.findings) == ("pass", "good", ())
    assert (row.verdict.worst, row.verdict.limit, row.failure) == (63, 63, None)
    assert report.name == "responder, imu_round.sr" and "63, exactly 63" in page([report], report.name)


def test_a_session_has_its_budgets_with_waves_in_the_time_of_the_capture():
    capture = formats.read(FOLDER / "imu_session.sr")
    options = (
        capture,
        "SCL",
        "SDA",
        capture,
        "RX",
        Fraction(0),
        line_format(115200, "8n1"),
        (),
        None,
        Fraction(5, 10**6),
    )
    report = reported(CASES / "imu_hil_published.toml", SessionReplay, *options)
    assert report.verdict == "pass" and report.budgets[0].verdict.name == "events as in the capture"
    response = next(row for row in report.budgets if row.verdict.name == "response")
    assert response.timeline is not None and response.verdict.at_s is not None
    assert response.timeline.origin == round(response.verdict.at_s * response.timeline.per_second)


@pytest.mark.parametrize(
    ("case", "player", "options", "changes"),
    [
        ("responder", I2cOpenReplay, ("nack.sr", "SCL", "SDA"), tuple(WRONG[1:])),
        ("captured_master", I2cMasterReplay, ("nack.sr", "SCL", "SDA"), ()),
        ("uart_logger", UartReplay, ("host_frames.sr", "RX", line_format(115200, "8n1")), ()),
        ("uart_logger", UartReplay, ("host_frames.sr", "RX", line_format(57600, "8n1")), ()),
    ],
)
def test_each_kind_of_replay_has_a_page(case, player, options, changes):
    name, *rest = options
    report = reported(CASES / f"{case}.toml", player, formats.read(FOLDER / name), *rest, changes=changes)
    assert report.name in page([report], report.name) and report.budgets
    assert all(row.timeline is not None for row in report.budgets if row.verdict.at_s is not None)
