"""`periph-sim new --live`: a case with budgets is written from the log of a live session; other logs are rejected."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from periph_sim.interfaces.commands.live_case import toml
from periph_sim.outside import Session
from periph_sim.outside.live.case_for_line import case_for_line
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.interfaces.commands.conftest import Run
from tests.outside.live.echo import written
from tests.outside.sessions import Records

ROOT = Path(__file__).parents[3]


def run_live(case: Path, log: Path, data: bytes, changes: tuple[str, ...] = ()) -> Records:
    records = Records()
    session = Session(case_for_line(case, "scia", changes), log=log, subscribe=records.subscribe)
    line = session.serial("scia")
    session.advance(session.ticks("1 ms"))
    line.write(data)
    session.advance(session.ticks("7 ms") + 1)
    records.events = session.finish().events - line.received  # each byte read for the client is an event
    return records


def test_the_written_case_has_the_records_of_the_live_session(periph_sim: Run, tmp_path: Path) -> None:
    for folder in ("cases", "logs", "new"):
        (tmp_path / folder).mkdir()
    log = tmp_path / "logs" / "live.jsonl"
    records = run_live(written(tmp_path / "cases"), log, b"hello", ("seed=7",))
    outcome = periph_sim("new", "--live", str(log), str(tmp_path / "new" / "again"))
    case = tmp_path / "new" / "again.toml"
    assert outcome.status == 0 and outcome.out.startswith(f"written: {case}\nrun it: ")
    again = Records()
    made = load(case)
    scene = Scene(made, again.subscribe)
    result = scene.run()
    assert again.kept == records.kept and len(records.kept) > 50
    assert result.events == records.events
    assert (made.seed, result.sci_bytes, result.verdict) == (7, 5, "pass")
    assert {budget.name: budget.max for budget in made.budget} == {"overruns": 0}
    assert periph_sim("run", str(case)).status == 0
    assert "exists already" in periph_sim("new", "--live", str(log), str(tmp_path / "new" / "again.toml")).err


def test_a_case_keeps_all_budgets_except_those_of_its_host(periph_sim: Run, tmp_path: Path) -> None:
    log = tmp_path / "live.jsonl"
    run_live(ROOT / "timing" / "imu_hil.toml", log, bytes(24))
    assert periph_sim("new", "--live", str(log), str(tmp_path / "mine")).status == 0
    before, after = load(ROOT / "timing" / "imu_hil.toml"), load(tmp_path / "mine.toml")
    left_out = {"wrong bytes", "data age"}
    assert after.budget == tuple(budget for budget in before.budget if budget.name not in left_out)
    assert (after.host, after.controller) == (None, before.controller.model_copy(update={"check": "expect"}))
    assert after.unit == before.unit
    assert after.outside is not None and after.outside.wires == ("RX",)


LED = """
pins = { led = 34 }
[watch.led]
kind = "blink"
wire = "led"
rate = "1 kHz"
tolerance = "1 us"
"""
SILENCE = """
pins = { other = 16, receive = 28 }
[serial]
send = [{ name = "quiet", to = "SCI-B", text = "x", at = "1 ms", expect = "nothing", within = "1 ms" }]
"""


@pytest.mark.parametrize(("table", "name"), [(LED, "led"), (SILENCE, "quiet")], ids=["watch", "silence"])
def test_a_budget_of_another_table_is_the_only_one(periph_sim: Run, tmp_path: Path, table: str, name: str) -> None:
    case, log = written(tmp_path), tmp_path / "live.jsonl"
    case.write_text(case.read_text().replace('["SCI-A"]\n', f'["SCI-A", "SCI-B", "GPIO"]{table}'))
    run_live(case, log, b"hello")
    outcome = periph_sim("new", "--live", str(log))
    assert outcome.status == 0, outcome.err
    assert [budget.name for budget in load(tmp_path / "echo_live.toml").budget] == [name]


@pytest.mark.parametrize("file", sorted((ROOT / "timing").glob("*.toml")), ids=lambda file: file.stem)
def test_a_written_toml_tree_reads_back_equal(file: Path) -> None:
    tree = tomllib.loads(file.read_text(encoding="utf-8")) | {
        "odd key": {"": [], "a.b": [{}, {"c": [[1, "\u00e9\n"]]}]}
    }
    assert tomllib.loads(toml(tree)) == tree


def test_a_file_that_is_no_log_of_a_case_is_rejected(periph_sim: Run, tmp_path: Path) -> None:
    log = tmp_path / "live.jsonl"
    for text, sentence in (
        (None, "No such file or directory; give the log of a session"),
        ("hello\n", "line 1: found no head"),
        ('{"format": "periph-sim outside", "version": 1, "case": "x", "ticks_per_second": 3, "wires": []}\n',
         "its case, x, came from no file; replay it with Python's replay()"),
        ('{"format": "periph-sim outside", "version": 1, "case": "x", "ticks_per_second": 3, "wires": [], '
         '"file": "gone.toml"}\n[1, {}]\n', "gone.toml: cannot be read"),
        ('{"format": "periph-sim outside", "version": 1, "case": "x", "ticks_per_second": 3, "wires": [], '
         '"file": "gone.toml"}\n', "line 2: found nothing after the head, expected what a session did"),
    ):  # fmt: skip
        if text is not None:
            log.write_text(text)
        assert sentence in periph_sim.refused("new", "--live", str(log))
    assert "--live takes at most the name" in periph_sim("new", "--live", str(log), "a", "b").err
