"""All commands report, draw and explain every measure, each with a limit that the run must break."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.interfaces.reports.html import gather
from periph_sim.timing.budget_schema import SPAN
from periph_sim.timing.language.language import FORMS
from periph_sim.timing.measures.registry import MEASURES
from tests.interfaces.commands.conftest import CommandResult, Run

BROKEN = {  # a maximum that each kind of value exceeds
    "time": '"1 ns"',
    "count": "0",
    "%": '"0.001 %"',
}
NEVER = ("missed rounds", "nacked rounds", "nacked", "wrong bytes", "overruns", "stuck", "lost flags")
MEASURED = {
    "response": "time",
    "round": "time",
    "age": "time",
    "model age": "time",
    "fifo high-water": "count",
    "span:model": "time",
    "from flag I2C-A.I2CSTR.XRDY rise to access W I2C-A.I2CDXR": "time",
    "from bus START to bus STOP, same round": "time",
    "period of edge SCL rise": "time",
    "jitter of bus START": "time",
    "jitter of age": "time",
    "from last frame RX end of burst to edge MODEL rise": "time",
    "count of bus byte from bus START to bus STOP": "count",
    "sum of record receiver received": "count",
    "value of record receiver words": "count",
    "level of SCI-A.SCIFFRX.RXFFST at interrupt SCIRXINTA enter": "count",
    "interrupt latency SCIRXINTA to first access": "time",
    "reaction": "time",
    "gap between rounds": "time",
    "margin of I2CDXR": "time",
    "SCL held per transfer": "time",
    "cpu load per 10 ms": "%",
    "bus load per 10 ms": "%",
    "age of magnetometer": "time",
    "model age of gyroscope": "time",
    "count of bus address read": "count",
    "level of SCI-A.SCIFFRX.RXFFST": "count",
    "interrupt latency SCIRXINTA": "time",
    "time in wire MODEL high": "time",
    "each time in flag I2C-A.I2CSTR.AAS = 1": "time",
    "each time in bus free": "time",
    "share of any 10 ms in cpu idle": "%",
    "cpu load": "%",
    "bus load": "%",
    "slack": "time",
    "race I2C-A.I2CSTR.RRDY": "count",
    "cleared along I2C-A.I2CSTR.RRDY": "count",
    "value error of gyroscope": "count",
}
CASE = """\
name = "all"
duration = "30 ms"

[unit.dsp]
firmware = "imu_hil"
modules = ["I2C-A", "SCI-A", "GPIO"]
pins = { MODEL = 34 }

[controller]
order = ["gyroscope", "accelerometer", "magnetometer"]
check = "host"

[host]
"""


def limit(measure: str) -> str:
    if measure in NEVER:
        return "min = 1"
    if measure in ("stretch", "SCL held per transfer"):
        return 'min = "1 us"'
    return f"max = {BROKEN[MEASURED[measure]]}"


ALL = ("stretch", *NEVER, *MEASURED)
# Tested elsewhere: calls and stack in tests/scene/test_image_budgets.py, busy in tests/devices.
TESTED_ELSEWHERE = {"calls", "stack", "busy"}


def test_the_case_has_every_measure_and_form():
    forms = {measure.split(" ")[0] for measure in ALL} & set(FORMS)
    assert {m for m in ALL if m in MEASURES or m.startswith(SPAN)} == {*MEASURES, f"{SPAN}model"}
    assert forms == set(FORMS) - TESTED_ELSEWHERE


@pytest.fixture
def case(desk: Path) -> str:
    budgets = [f'[[budget]]\nname = "{measure}"\nmeasure = "{measure}"\n{limit(measure)}\n' for measure in ALL]
    (desk / "all.toml").write_text(CASE + "\n".join(budgets), encoding="utf-8")
    return "all.toml"


def require_failure(result: CommandResult) -> CommandResult:
    assert (result.status, result.err) == (1, "")
    return result


def test_worst_explains_each_budget(periph_sim: Run, case: str, desk: Path):
    (desk / "out").mkdir()
    lines = require_failure(periph_sim("worst", case, "--svg", "out")).out.splitlines()
    for measure in ALL:
        if measure in NEVER:
            assert f"{measure}: 0: it never happened" in lines
        else:
            head = next(n for n, line in enumerate(lines) if line.startswith(f"{measure} ") and " allowed, at " in line)
            assert lines[head + 1].startswith("    "), measure
    assert len([*(desk / "out").iterdir()]) == len(ALL) - len(NEVER)


def test_check_reports_and_explains_each_budget(periph_sim: Run, case: str, desk: Path):
    found = require_failure(periph_sim("check", case, "--json", "--jobs", "1", "--junit", "all.xml")).json_object[
        "cases"
    ][0]
    assert found["broken"] == [*ALL] and set(found["causes"]) == set(ALL) - set(NEVER)
    assert all(found["causes"][measure]["steps"] for measure in MEASURED)
    assert (desk / "all.xml").read_text(encoding="utf-8").count("<failure") >= len(ALL)


def test_the_report_draws_each_budget(periph_sim: Run, case: str, desk: Path, monkeypatch: pytest.MonkeyPatch):
    """The page shows one violation of each budget only, because each takes a picture of its own."""
    shown = gather.shown_violations
    monkeypatch.setattr(gather, "shown_violations", lambda over, worst: shown(over, worst)[:1])
    require_failure(periph_sim("run", case, "--html", "all.html"))
    page = (desk / "all.html").read_text(encoding="utf-8")
    assert all(f'data-name="{measure}"' in page or f">{measure}<" in page for measure in ALL)
