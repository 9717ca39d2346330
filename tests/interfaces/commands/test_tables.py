"""Lines and tables in a pipe are those that rich makes there, and rich is not asked for them."""

from __future__ import annotations

import random
from io import StringIO

import pytest
from rich.console import Console

from periph_sim.interfaces.commands.tables import Piped, PlainTable, say, terminal

LINES = (
    *("", "one", "ends in blanks   ", "  begins with them", "a\ttab", "\t\ttwo", "two\nlines", "\n", "[bold]no markup"),
    *("x" * 200, "words " * 40, "bell\a and \b back", "µs ─ ✓", "a :smile: is no picture", "12 34.5 'text' None"),
)


def by_rich(width: int, what: str | PlainTable) -> str:
    console = Console(file=StringIO(), width=width, color_system=None)
    if isinstance(what, str):
        say(console, what, "bold")
    else:
        console.print(what)
    written = console.file
    assert isinstance(written, StringIO)
    return written.getvalue()


def piped(width: int, what: str | PlainTable, capsys: pytest.CaptureFixture[str]) -> str:
    screen = Piped(width)
    if isinstance(what, str):
        say(screen, what, "bold")
    else:
        screen.print(what)
    return capsys.readouterr().out


@pytest.mark.parametrize("line", LINES, ids=range(len(LINES)))
def test_a_line_is_as_rich_writes_it(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert piped(80, line, capsys) == by_rich(80, line)


@pytest.mark.parametrize("seed", range(4))
def test_a_table_is_as_rich_writes_it(seed: int, capsys: pytest.CaptureFixture[str]) -> None:
    draw = random.Random(seed)
    table = PlainTable(("what", "two\nlines", "number"), right=(2,), whole=(2,))
    for _ in range(5):
        words = [" ".join(draw.choices(("a", "word", "long" * 9), k=draw.randrange(9))) for _ in range(2)]
        table.add_row(*words, f"{draw.randrange(10**6)} us", style=draw.choice(("", "red")))
    width = draw.randrange(80, 130)
    assert piped(width, table, capsys) == by_rich(width, table)


@pytest.mark.parametrize(("columns", "width"), [("20", 80), ("132", 132), ("none", None)])
def test_a_pipe_is_as_wide_as_columns_says(columns: str, width: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    for name in ("FORCE_COLOR", "TTY_COMPATIBLE"):
        monkeypatch.delenv(name, raising=False)
    screen = terminal()
    assert isinstance(screen, Piped) and screen.width == (width or max(80, Console().width))
    monkeypatch.setenv("FORCE_COLOR", "1")
    styled = terminal()
    assert isinstance(styled, Console) and styled.width == screen.width and styled.is_terminal
