"""The common style of the tables and lines of all commands, which fit 80 columns without losing words.

Tables are formatted by `core.text_table` for the width of the terminal, with a style for each row. In a pipe or a file,
where styles are not visible, the same lines are printed without rich, because its import takes longer than the
printing.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Collection, Iterator, Sequence
from typing import TYPE_CHECKING, TypeAlias

import click

from ...core.text_table import WIDTH, table_rows, together

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.text import Text

__all__ = ["WIDTH", "Piped", "PlainTable", "Screen", "say", "terminal"]

STYLED = ("FORCE_COLOR", "TTY_COMPATIBLE")  # variables that make rich use styles in a pipe
UNSEEN = dict.fromkeys((7, 8, 11, 12, 13))  # control codes that rich removes, and so are removed from piped output too
TAB = 8


class Piped:
    """Standard output that is not a terminal."""

    def __init__(self, width: int) -> None:
        self.width = width

    def print(self, table: PlainTable) -> None:
        for line, _ in table.lines(self.width):
            self.say(line)

    def say(self, text: str) -> None:
        for line in text.split("\n"):
            click.echo(line.translate(UNSEEN).expandtabs(TAB), color=True)  # color=True leaves the line unchanged


Screen: TypeAlias = "Console | Piped"


def terminal() -> Screen:
    """Return the standard output. A terminal with fewer than 80 columns may break lines, but no table loses words."""
    if not sys.stdout.isatty() and not any(name in os.environ for name in STYLED):
        return Piped(max(_columns(), WIDTH))
    from rich.console import Console

    console = Console()
    console.width = max(console.width, WIDTH)
    return console


def _columns() -> int:
    """Return the number of columns, from the variable COLUMNS or from the terminal; 0 if there is none."""
    said = os.environ.get("COLUMNS", "")
    if said.isdecimal():
        return int(said)
    for stream in (sys.__stdin__, sys.__stdout__, sys.__stderr__):
        try:
            return 0 if stream is None else os.get_terminal_size(stream.fileno()).columns
        except (ValueError, OSError):  # the stream is closed or no terminal
            pass
    return 0


class PlainTable:
    """A table for `Screen.print`, with a line under its titles and no lines between its rows.

    right: the numbers of the columns that are aligned at the right.
    whole: the numbers of the columns whose cells are kept on one line.
    """

    def __init__(self, titles: Sequence[str], right: Collection[int] = (), whole: Collection[int] = ()) -> None:
        self._titles, self._right, self._whole = titles, right, whole
        self._rows: list[list[str]] = []
        self._styles: list[str] = []

    def add_row(self, *cells: str, style: str = "") -> None:
        self._rows.append([together(cell) if n in self._whole else cell for n, cell in enumerate(cells)])
        self._styles.append(style)

    def lines(self, width: int) -> Iterator[tuple[str, str]]:
        """Yield each line with its style."""
        lowest = max(title.count("\n") for title in self._titles)
        titles = ["\n" * (lowest - title.count("\n")) + title for title in self._titles]
        head, *rows = table_rows(titles, self._rows, self._right, width)
        yield "", ""
        yield from ((line, "bold") for line in head[:-1])
        yield head[-1], ""
        for lines, style in zip(rows, self._styles, strict=True):
            yield from ((line, style) for line in lines)
        yield "", ""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        for line, style in self.lines(options.max_width):
            yield Text(line, style=style, no_wrap=True, overflow="ignore")


def say(screen: Screen, line: str, style: str = "") -> None:
    """Print one line without breaks, so that it can be searched for, and without colours or markup of its own."""
    if isinstance(screen, Piped):
        screen.say(line)
    else:
        screen.print(line, style=style, highlight=False, markup=False, emoji=False, soft_wrap=True)
