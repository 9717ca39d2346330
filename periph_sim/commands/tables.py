"""One style of tables and lines for all commands: titles go in; what fits 80 columns with every word comes out."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

WIDTH = 80


def terminal() -> Console:
    """Standard output. Below 80 columns the terminal may break lines, but no table loses words."""
    console = Console()
    console.width = max(console.width, WIDTH)
    return console


def plain_table(*columns: str) -> Table:
    """A table with a line under its titles and none between its rows."""
    return Table(*columns, box=SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)


def say(console: Console, line: str, style: str = "") -> None:
    """One line as it is: whole, so that it can be searched for, and without colours or markup of its own."""
    console.print(line, style=style, highlight=False, markup=False, soft_wrap=True)
