"""The log of a session: it replaces no input, and a session that is refused keeps the previous log."""

from __future__ import annotations

import json
from pathlib import Path

from periph_sim.outside import Session
from periph_sim.outside.live.case_for_line import case_for_line
from periph_sim.outside.live.pty_door import PtyDoor
from tests.outside.live.echo import written
from tests.outside.sessions import refuses


def test_a_log_never_replaces_the_case(tmp_path: Path) -> None:
    case = written(tmp_path)
    before = case.read_text()
    link = tmp_path / "link.jsonl"
    link.symlink_to(case)
    for log in (case, link):
        refuses(
            "the session reads this file; give the log another place", Session, case_for_line(case, "scia"), log=log
        )
    assert case.read_text() == before


def test_a_log_never_replaces_a_file_of_the_case_or_a_module_of_its_firmware(tmp_path: Path) -> None:
    case = written(tmp_path)
    drivers, earlier = tmp_path / "drivers.py", tmp_path / "earlier.jsonl"
    text = case.read_text().replace("[unit.dsp]", '[outside]\nwires = ["RX"]\nlog = "earlier.jsonl"\n[unit.dsp]')
    case.write_text(text)
    for file in (drivers, earlier):
        file.write_text("as it was\n")
    for log in (drivers, earlier, tmp_path / "echo_firmware.py"):
        before = log.read_text()
        refuses(
            "the session reads this file; give the log another place", Session, case_for_line(case, "scia"), log=log
        )
        assert log.read_text() == before


def test_a_session_refused_before_time_advances_keeps_the_previous_log(tmp_path: Path) -> None:
    log, taken = tmp_path / "live.jsonl", tmp_path / "taken"
    before = "the last session\n" * 10
    log.write_text(before)
    taken.touch()
    with Session(case_for_line(written(tmp_path), "scia"), log=log) as session:
        line = session.serial("scia")
        refuses("File exists", PtyDoor, line, 115_200, "8n1", taken)
    assert log.read_text() == before
    new = tmp_path / "new.jsonl"
    with Session(case_for_line(written(tmp_path), "scia"), log=new):
        pass
    assert not new.exists()
    with Session(case_for_line(written(tmp_path), "scia"), log=new):
        new.unlink()  # another program has removed it
    with Session(case_for_line(written(tmp_path), "scia"), log=log) as session:
        session.serial("scia")
        session.advance(1)
        assert log.read_text().startswith('{"format": "periph-sim outside"') and log.read_text().count("\n") == 2


def test_the_head_of_a_log_contains_the_case_its_changes_and_the_wires(tmp_path: Path) -> None:
    log = tmp_path / "logs" / "live.jsonl"
    log.parent.mkdir()
    with Session(case_for_line(written(tmp_path), "scia", ("duration=2 s",)), log=log) as session:
        session.serial("scia")
        session.finish()
    head, *rows = map(json.loads, log.read_text().splitlines())
    assert head == {
        "format": "periph-sim outside",
        "version": 1,
        "case": "echo",
        "ticks_per_second": session.ticks_per_second,
        "wires": ["RX"],
        "file": "../echo.toml",
        "set": ["duration=2 s"],
    }
    assert rows == [{"serial": "RX"}, {"end": 0}]


def test_the_lines_of_a_party_are_added_to_those_of_the_case(tmp_path: Path) -> None:
    case = written(tmp_path)
    case.write_text(case.read_text().replace("[unit.dsp]", '[outside]\nwires = ["TX"]\n[unit.dsp]'))
    for port in ("scia", "SCI-A", "dsp.SCI-A"):
        ready = case_for_line(case, port)
        assert ready.outside is not None and ready.outside.wires == ("TX", "RX")
    refuses(r"no case was given; f28335://PATH/OF/CASE.toml\?port=scia", case_for_line, "", "scia")
