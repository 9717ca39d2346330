"""One style of tables and lines for all commands: titles go in; what fits 80 columns with every word comes out.

Tables are those of `core.text_table`, as wide as the terminal, with a style for each row.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from rich.console import Console, ConsoleOptions
from rich.text import Text

from ..core.text_table import WIDTH, table_rows, together

__all__ = ["WIDTH", "PlainTable", "plain_table", "say", "terminal"]


def terminal() -> Console:
    """Standard output. Below 80 columns the terminal may break lines, but no table loses words."""
    console = Console()
    console.width = max(console.width, WIDTH)
    return console


class PlainTable:
    """A table with a line under its titles and none between its rows; for `Console.print`."""

    def __init__(self) -> None:
        self._titles: list[str] = []
        self._right: set[int] = set()
        self._whole: set[int] = set()  # columns whose cells stay on one line
        self._rows: list[list[str]] = []
        self._styles: list[str] = []

    def add_column(self, title: str, justify: Literal["left", "right"] = "left", no_wrap: bool = False) -> None:
        number = len(self._titles)
        self._titles.append(title)
        if justify == "right":
            self._right.add(number)
        if no_wrap:
            self._whole.add(number)

    def add_row(self, *cells: str, style: str = "") -> None:
        self._rows.append([together(cell) if n in self._whole else cell for n, cell in enumerate(cells)])
        self._styles.append(style)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        lowest = max(title.count("\n") for title in self._titles)
        titles = ["\n" * (lowest - title.count("\n")) + title for title in self._titles]
        head, *rows = table_rows(titles, self._rows, self._right, options.max_width)
        yield _whole("")
        yield from (_whole(line, "bold") for line in head[:-1])
        yield _whole(head[-1])
        for lines, style in zip(rows, self._styles, strict=True):
            yield from (_whole(line, style) for line in lines)
        yield _whole("")


def _whole(line: str, style: str = "") -> Text:
    return Text(line, style=style, no_wrap=True, overflow="ignore")


def plain_table(*columns: str) -> PlainTable:
    table = PlainTable()
    for title in columns:
        table.add_column(title)
    return table


def say(console: Console, line: str, style: str = "") -> None:
    """One line as it is: whole, so that it can be searched for, and without colours or markup of its own."""
    console.print(line, style=style, highlight=False, markup=False, soft_wrap=True)
