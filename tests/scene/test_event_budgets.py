"""Budgets on named events in running scenes equal those of the recorded run, and only needed kinds are recorded."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim import BadCase, Scene, load, timing
from periph_sim.core.records import RECORDED, Kind
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.f28335.pie.register_map import LINES
from periph_sim.processor.interrupts import pie_lines
from periph_sim.scene.scope import scope_of_case
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.language.scope import MAPS, VECTORS
from periph_sim.traces.formats.record_table import Columns
from tests.scene.runs import TIMING, run_case
from tests.scene.small import sentence_of

XRDY, DXR = "flag I2C-A.I2CSTR.XRDY rise", "access W I2C-A.I2CDXR"


def with_budgets(name: str, *budgets: Budget):
    return load(TIMING / f"{name}.toml").model_copy(update={"budget": budgets})


def budget(measure: str, **limits: str | int) -> Budget:
    return Budget(name=measure, measure=measure, **limits)


def test_each_budget_equals_the_measure_of_the_recorded_run():
    pairs = [
        (XRDY, DXR, "same transfer"),
        (DXR, "bus STOP", "next, same round"),
        ("edge SCL fall", "edge SCL rise", ""),
        ("flag PIE.PIEIFR9.INTx1 rise", "interrupt SCIRXINTA enter", "next"),
    ]
    measured = [budget(f"from {a} to {b}, {rule}".removesuffix(", "), max="1 s") for a, b, rule in pairs]
    case = with_budgets("imu_hil_published", *measured, budget("interrupt latency SCIRXINTA", max="1 us"))
    columns = Columns()
    ran = run_case(case, "0.07", lambda recorder, timebase: recorder.subscribe(RECORDED, columns.add))
    table = columns.table(ran.scene.timebase.per_second, ran.scene.kernel.now, {"dsp": ("I2C-A", "SCI-A", "GPIO")}, {})
    per_us = ran.scene.timebase.per_second / 1e6
    for verdict, (a, b, rule) in zip(ran.result.budgets, pairs, strict=False):
        found = timing.between(table, a, b, rule=rule, transfers_in_round=3)
        assert verdict.count == len(found.duration) > 0
        assert verdict.worst == pytest.approx(found.duration.max() / per_us, abs=1e-4)
    assert ran.result.budgets[-1].worst == ran.result.budgets[-2].worst
    assert ran.result.budgets[-1].count == 4  # frames end 3.04 ms after 0, 20, 40 and 60 ms


def test_loads_slack_levels_and_counts_of_the_imu_case():
    measures = {
        "cpu load": {"max": "50 %"},
        "bus load": {"max": "50 %"},
        "slack": {"min": "10 ms"},
        "level of SCI-A.SCIFFRX.RXFFST": {"max": 16},
        "count of bus address read": {"exactly": 9},
        "time in model": {"max": "1 s"},
        "period of bus START": {"max": "1 s"},
    }
    ran = run_case(
        with_budgets("imu_hil_published", *(budget(name, **limits) for name, limits in measures.items())), "0.06"
    )
    found = {v.name: v for v in ran.result.budgets}
    assert ran.broken() == []
    assert 1.667 < found["cpu load"].worst < 1.7  # four models of 250 us, three frames, and reads
    assert 12.5 < found["bus load"].worst < 12.7  # three rounds of 2.52 ms
    assert found["slack"].worst == 17380.0
    assert (found["level of SCI-A.SCIFFRX.RXFFST"].worst, found["count of bus address read"].worst) == (12, 9)
    assert found["time in model"].worst == 1000.0  # four runs, the first before any request
    assert found["period of bus START"].count == 8


@pytest.mark.parametrize(
    ("measure", "limits", "kinds"),
    [
        ("from frame to bus STOP", {"max": "1 s"}, {Kind.FRAME, Kind.BUS}),
        ("from edge SCL rise to edge SCL fall", {"max": "1 s"}, {Kind.EDGE}),
        ("from edge SCL rise to edge SCL fall, same transfer", {"max": "1 s"}, {Kind.EDGE, Kind.BUS}),
        (f"from {XRDY} to {DXR}", {"max": "1 s"}, {Kind.FLAG, Kind.ACCESS}),
        ("time in model", {"max": "1 s"}, {Kind.SPAN}),
        ("cpu load", {"max": "9 %"}, {Kind.IRQ, Kind.WAIT}),
        ("count of note duty", {"max": 0}, {Kind.NOTE}),
        ("slack", {"min": "1 ms"}, {Kind.ROUND}),
        ("response", {"max": "1 s"}, {Kind.TRANSFER}),
    ],
)
def test_only_what_a_budget_asks_for_is_recorded(measure: str, limits, kinds: set[Kind]):
    scene = Scene(with_budgets("imu_hil_published", budget(measure, **limits)))
    assert {kind for kind in Kind if scene.recorder.wants(kind)} == kinds


def test_each_of_two_units_is_measured_by_its_prefix():
    measures = [f"from {u}:I2C-A.I2CSTR.SCD rise to access R {u}:I2C-A.I2CSTR" for u in ("flag head", "flag imu")]
    measures = [m.replace("access R flag ", "access R ") for m in measures] + ["cpu load of imu", "cpu load of head"]
    limits = [{"max": "1 s"}, {"max": "1 s"}, {"max": "9 %"}, {"max": "9 %"}]
    case = with_budgets("two_dsps", *(budget(m, **given) for m, given in zip(measures, limits, strict=True)))
    ran = run_case(case, "0.05")
    assert ran.broken() == []
    assert all(v.count > 0 for v in ran.result.budgets)
    imu, head = ran.result.budgets[2:]
    assert imu.worst > head.worst


BASE = (TIMING / "imu_hil_published.toml").read_text(encoding="utf-8").split("[[budget]]")[0]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            'measure = "from edge SLC rise to frame"\nmax = "1 us"',
            "line 25: budget.b.measure: there is no wire 'SLC'; did you mean SCL?",
        ),
        (
            'measure = "count of access W I2C-A.I2CDRX"\nmax = 1',
            "line 25: budget.b.measure: I2C-A has no register 'I2CDRX'; did you mean I2CMDR or I2CDXR or I2CDRR?",
        ),
        (
            'measure = "response"\nmax = "9 us"\np99 = "10 us"',
            "line 27: budget.b.p99: p99 10 us is above max 9 us, which no value may exceed; lower p99 or leave it out",
        ),
        (
            'measure = "response"\nmax = "9 us"\nexactly = "9 us"',
            "line 27: budget.b.exactly: exactly says all that max could; leave one of them out",
        ),
        (
            'measure = "response"\nmax = "9 us"\nafter = "300000 d"',
            "line 27: budget.b.after: a time of 3e+05 d is too long: with ticks of 1/3000000000 s the longest is "
            "17791.9 d",
        ),
    ],
)
def test_a_mistake_is_reported_with_its_line(tmp_path: Path, text: str, sentence: str):
    path = tmp_path / "a.toml"
    path.write_text(f'{BASE}[[budget]]\nname = "b"\n{text}\n', encoding="utf-8")
    assert sentence_of(BadCase, lambda: Scene(load(path))) == f"{path}, {sentence}"


def test_the_names_of_events_are_those_of_the_parts_of_a_scene():
    assert set(MAPS) == set(PART.by_name)
    for module, vectors in VECTORS.items():
        assert tuple(LINES[v] for v in vectors if v in LINES) == pie_lines(PART.by_name[module]), module
    case = load(TIMING / "imu_hil_published.toml")
    scene = Scene(case)
    assert set(scope_of_case(case).wires) == set(scene.wires)
    for name, socket in scene.units["dsp"].sockets.items():
        assert socket.chip.MAP is MAPS[name]


def test_records_of_transfers_are_those_of_the_address_or_the_unit_that_they_name():
    texts = [
        f"count of record transfer {thing}{of}" for thing in ("phase", "read") for of in ("", " of 0x68", " of 0x50")
    ]
    case = with_budgets("imu_hil_published", *(budget(text, min=0) for text in texts))
    phases, gyroscope, absent, *reads = (verdict.worst for verdict in run_case(case, "0.07").result.budgets)
    assert phases == 3 * gyroscope > 0 == absent
    assert reads == [phases / 2, gyroscope / 2, 0]
    with pytest.raises(BadCase, match="there is no unit 'imu'"):
        Scene(with_budgets("imu_hil_published", budget("count of record transfer held alone of imu", min=0)))
