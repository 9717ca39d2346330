"""A long interpreted run is told how it is quicker; nobody else is told anything."""

from __future__ import annotations

import pytest

from periph_sim import form
from periph_sim.interfaces.commands.command_output import LONG, SHARE, cost_of_form, progress


@pytest.fixture
def interpreted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(form, "running", form.INTERPRETED)
    monkeypatch.setattr(form, "note", "")
    monkeypatch.delenv(form.VARIABLE, raising=False)


def test_a_long_interpreted_run_is_told_what_it_costs_and_the_way_out(interpreted: None) -> None:
    assert cost_of_form(LONG + 0.2) == f"interpreted, in 5 s; compiled, a run takes {SHARE} of that: make core"


def test_outside_of_a_clone_the_way_is_the_packages_own(interpreted: None, monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(form, "PACKAGE", tmp_path / "site-packages" / "periph_sim")
    assert cost_of_form(60).endswith(": python -m periph_sim.form.build")


@pytest.mark.parametrize("why", ["short", "compiled", "told already", "asked for"])
def test_else_nothing_is_told(interpreted: None, monkeypatch: pytest.MonkeyPatch, why: str) -> None:
    if why == "compiled":
        monkeypatch.setattr(form, "running", form.COMPILED)
    elif why == "told already":
        monkeypatch.setattr(form, "note", "the compiled core is not whole")
    elif why == "asked for":
        monkeypatch.setenv(form.VARIABLE, form.INTERPRETED)
    assert cost_of_form(LONG - 0.1 if why == "short" else 60) == ""


def test_where_nobody_looks_there_is_no_bar_and_no_line(interpreted: None, monkeypatch, capsys) -> None:
    monkeypatch.setattr("periph_sim.interfaces.commands.command_output.LONG", 0)
    with progress("case") as told:
        assert told is None
    assert capsys.readouterr() == ("", "")


def test_on_a_terminal_the_line_comes_after_the_bar(interpreted: None, monkeypatch, capsys) -> None:
    monkeypatch.setattr("periph_sim.interfaces.commands.command_output.LONG", 0)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with progress("case") as told:
        assert told is not None
        told(0.5)
    came = capsys.readouterr()
    assert came.out == "" and came.err.splitlines()[-1].endswith(": make core")
