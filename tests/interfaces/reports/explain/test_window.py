"""Windows around worst occurrences against a recording of the whole run."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from periph_sim.core.records import RECORDED, Kind
from periph_sim.core.time import Timebase
from periph_sim.interfaces.reports.explain.window import END_KEPT, windows, windows_of_edges, windows_of_table
from periph_sim.replay.wire_log import WireLog
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from periph_sim.timing.verdict import Verdict
from periph_sim.traces.capture.capture import Capture, Channel, Span
from periph_sim.traces.formats.record_table import Columns
from tests.scene.small import case

CASES = Path(__file__).parents[4] / "timing"
LENGTH = Fraction(3, 20)


@pytest.fixture(scope="module")
def whole():
    """Run the case with slow models; return the case, its result, and records and edges of the whole run."""
    case = load(CASES / "imu_hil_published.toml", ["unit.dsp.settings.model_cost=400 us", "unit.dsp.pll=8"])
    columns = Columns()
    scene = Scene(case, lambda recorder, _: recorder.subscribe(RECORDED, columns.add))
    log = WireLog(*scene.wires.values())
    result = scene.run(LENGTH)
    table = columns.table(Fraction(scene.timebase.per_second), scene.kernel.now, {}, scene.clocks())
    return case, result, table, log.capture(scene.timebase, scene.kernel.now)


def test_a_window_holds_every_record_of_its_range(whole):
    case, result, table, _ = whole
    records = sorted(table.records(), key=lambda r: r.tick)
    found = windows(case, result.budgets, LENGTH)
    assert [w.verdict.name for w in found] == [v.name for v in result.budgets if v.at_s is not None]
    for window in found:
        (kept,) = window.kept
        assert list(window.records) == [r for r in records if kept.begin <= r.tick < kept.end]
        assert kept.begin <= window.begin <= window.end < kept.end
        assert kept.begin <= window.drawn.begin < window.drawn.end <= kept.end


def test_before_has_the_last_record_of_each_name(whole):
    case, _, table, _ = whole
    response = Verdict("late", "response", "us", 5.0, 1, 0, 1, "pass", 0.105)
    (window,) = windows(case, [response], LENGTH)
    last = {}
    for record in table.records():
        if record.tick < window.kept[0].begin:
            last[record[2:5]] = record
    assert sorted(window.before) == sorted(last.values())
    assert {r.kind for r in window.before} == set(RECORDED) - {Kind.NOTE}


def test_the_edges_equal_those_of_the_wires(whole):
    case, result, _, capture = whole
    for window in windows(case, result.budgets, LENGTH):
        for channel in window.edges.channels:
            theirs = capture.channel(channel.name)
            for span in window.edges.known(channel):
                ours, right = channel.cut(span), theirs.cut(span)
                assert ours.initial == right.initial
                assert np.array_equal(ours.edges, right.edges)


def test_a_recorded_run_gives_the_same_windows(whole):
    case, result, table, _ = whole
    recorded = windows_of_table(case.name, table, Timebase(int(table.per_second)), result.budgets, 0)
    for again, one in zip(recorded, windows(case, result.budgets, LENGTH), strict=True):
        assert (again.begin, again.end, again.drawn, again.kept) == (one.begin, one.end, one.drawn, one.kept)
        assert again.records == one.records
        assert again.before == one.before
        assert again.run.cycles.how == one.run.cycles.how == "SYSCLKOUT 120 MHz"


def test_the_middle_of_a_long_occurrence_is_not_kept():
    case = load(CASES / "imu_hil_published.toml")
    long = Verdict("long", "from span model begin to note lost", "us", 400_000.0, 1, 0, 1, "fail", 0.010)
    (window,) = windows(case, [long], Fraction(1, 2))
    first, second = window.kept
    per_second = window.timebase.per_second
    assert first.end == window.begin + per_second * END_KEPT
    assert second.begin == window.end - per_second * END_KEPT
    assert window.end - window.begin == per_second * 4 // 10
    assert all(first.begin <= r.tick < first.end or second.begin <= r.tick < second.end for r in window.records)
    scl = window.edges.channel("SCL")
    assert not any(first.end <= edge < hole.end for hole in scl.unknown for edge in scl.edges.tolist())
    assert window.edges.known(scl)[-1].end == window.edges.length


def test_a_long_age_may_begin_before_the_run():
    case = load(CASES / "imu_hil_published.toml")
    (window,) = windows(case, [Verdict("old", "age", "us", 300_000.0, 1, 0, 1, "fail", 0.001)])
    assert window.begin < window.start == 0 < window.end
    assert window.records and window.edges.channel("SCL").edges.size


def test_a_verdict_without_an_instant_has_no_window():
    case = load(CASES / "imu_hil_published.toml")
    assert windows(case, [Verdict("none", "stuck", "count", 0, 0, 0, 0, "pass", None)]) == []


def test_a_stretch_begins_when_the_controller_releases_scl():
    case = load(CASES / "imu_hil_published.toml", ["unit.dsp.settings.frame_cost=200 us", "host.first=4.24 ms"])
    scene = Scene(case)
    stretch = next(v for v in scene.run(Fraction(1, 10)).budgets if v.name == "stretch")
    assert stretch.worst > 0
    (window,) = windows(case, [stretch], Fraction(1, 10))
    scl = window.edges.channel("SCL")
    assert window.end in scl.edges.tolist()
    assert (window.end - window.begin) * 1e6 / window.timebase.per_second == pytest.approx(stretch.worst, abs=1e-3)
    assert not scl.at(np.arange(window.begin, window.end, 1000)).any()


def test_five_milliseconds_before_and_after_an_occurrence_are_kept():
    """There is one edge at tick 100 and none until the end at 1 s."""
    timebase = Timebase(150_000_000)
    ms = timebase.per_second // 1000
    scl = Channel("SCL", 0, 1, np.array([100]))
    edges = Capture(Path("made"), Fraction(timebase.per_second), 1000 * ms, (scl,), sampled=False)
    late = Verdict("late", "response", "us", 2000.0, 1, 0, 1, "fail", 0.5)
    (window,) = windows_of_edges(edges, timebase, [late], 0)
    assert (window.begin, window.end, window.kept) == (500 * ms, 502 * ms, (Span(495 * ms, 507 * ms + 1),))
    assert [channel.name for channel in window.edges.channels] == ["SCL"] and window.records == ()


def test_the_last_tick_of_the_kept_span_is_run():
    """A START at 10 ms, which is 5 ms after the occurrence."""
    made = case("20 ms", controller={"first": "10 ms", "request": [{"address": 0x50, "count": 1}]})
    (window,) = windows(made, [Verdict("early", "response", "us", 0.0, 1, 1, 1, "pass", 0.005)])
    start = window.timebase.per_second // 100
    assert window.kept[-1].end == start + 1 and start in {r.tick for r in window.records if r.kind is Kind.BUS}
