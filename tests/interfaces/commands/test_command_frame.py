"""Lines and tables equal those of rich, which is not imported; a long interpreted run suggests compiling the core."""

from __future__ import annotations

import random
from io import StringIO

import pytest
from rich.console import Console
from rich.text import Text

from periph_sim import form
from periph_sim.core.text_table import table_rows, together
from periph_sim.interfaces.commands.command_frame import LONG, SHARE, cost_of_form, print_table, progress, say

LINES = (
    *("", "one", "ends in blanks   ", "  begins with them", "a\ttab", "\t\ttwo", "two\nlines", "\n", "[bold]no markup"),
    *("x" * 200, "words " * 40, "bell\a and \b back", "µs ─ ✓", "a :smile: is no picture", "12 34.5 'text' None"),
)


def by_rich(styled: bool, *lines: tuple[str, str]) -> str:
    console = Console(file=StringIO(), force_terminal=styled, color_system="standard" if styled else None)
    for text, style in lines:
        console.print(Text(text, style=style), soft_wrap=True)
    written = console.file
    assert isinstance(written, StringIO)
    return written.getvalue().replace("\x1b[0m\x1b[1m", "")  # rich ends and repeats a style at a tab


@pytest.fixture(params=["a pipe", "a terminal"])
def styled(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    for name in ("FORCE_COLOR", "TTY_COMPATIBLE", "NO_COLOR", "TERM"):
        monkeypatch.delenv(name, raising=False)
    if request.param == "a terminal":
        monkeypatch.setenv("FORCE_COLOR", "1")
    return bool(request.param == "a terminal")


@pytest.mark.parametrize("line", LINES, ids=range(len(LINES)))
def test_a_line_equals_that_of_rich(line: str, styled: bool, capsys: pytest.CaptureFixture[str]) -> None:
    say(line, style="bold")
    assert capsys.readouterr().out == by_rich(styled, (line, "bold"))


@pytest.mark.parametrize("columns", [20, 80, 101, 132])
def test_a_table_equals_that_of_rich_at_80_columns_or_more(
    columns: int, styled: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    draw = random.Random(columns)
    rows = []
    for style in ("", "red", "green", "yellow", "dim"):
        words = [" ".join(draw.choices(("a", "word", "long" * 9), k=draw.randrange(9))) for _ in range(2)]
        rows.append(([*words, f"{draw.randrange(10**6)} us"], style))
    print_table(("what", "two\nlines", "number"), rows, right=(2,), whole=(2,))
    cells = [[*row[:2], together(row[2])] for row, _ in rows]
    head, *body = table_rows(("\nwhat", "two\nlines", "\nnumber"), cells, (2,), max(columns, 80))
    lines = [*((line, "bold") for line in head[:-1]), (head[-1], "")]
    lines += [(line, style) for part, (_, style) in zip(body, rows, strict=True) for line in part]
    assert capsys.readouterr().out == by_rich(styled, ("", ""), *lines, ("", ""))


@pytest.mark.parametrize(("name", "value"), [("TERM", "dumb"), ("NO_COLOR", "1"), ("FORCE_COLOR", "")])
def test_variables_turn_styles_off(
    name: str, value: str, styled: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(name, value)
    say("red", style="red")
    assert capsys.readouterr().out == "red\n"


@pytest.fixture
def interpreted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(form, "running", form.INTERPRETED)
    monkeypatch.setattr(form, "note", "")
    monkeypatch.delenv(form.VARIABLE, raising=False)


def test_a_long_interpreted_run_suggests_compiling_the_core(interpreted: None) -> None:
    assert cost_of_form(LONG + 0.2) == f"interpreted, in 5 s; compiled, a run takes {SHARE} of that: make core"


def test_an_installed_package_suggests_its_own_build_command(interpreted: None, monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(form, "PACKAGE", tmp_path / "site-packages" / "periph_sim")
    assert cost_of_form(60).endswith(": python -m periph_sim.form.build")


@pytest.mark.parametrize("why", ["short", "compiled", "told already", "asked for"])
def test_otherwise_there_is_no_suggestion(interpreted: None, monkeypatch: pytest.MonkeyPatch, why: str) -> None:
    if why == "compiled":
        monkeypatch.setattr(form, "running", form.COMPILED)
    elif why == "told already":
        monkeypatch.setattr(form, "note", "the compiled core is not whole")
    elif why == "asked for":
        monkeypatch.setenv(form.VARIABLE, form.INTERPRETED)
    assert cost_of_form(LONG - 0.1 if why == "short" else 60) == ""


def test_without_a_terminal_there_is_no_progress_bar_and_no_suggestion(interpreted: None, monkeypatch, capsys) -> None:
    monkeypatch.setattr("periph_sim.interfaces.commands.command_frame.LONG", 0)
    with progress("case") as told:
        assert told is None
    assert capsys.readouterr() == ("", "")


def test_on_a_terminal_the_suggestion_follows_the_progress_bar(interpreted: None, monkeypatch, capsys) -> None:
    monkeypatch.setattr("periph_sim.interfaces.commands.command_frame.LONG", 0)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with progress("case") as told:
        assert told is not None
        told(0.5)
    came = capsys.readouterr()
    assert came.out == "" and came.err.splitlines()[-1].endswith(": make core")
