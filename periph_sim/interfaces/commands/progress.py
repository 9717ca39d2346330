"""A progress bar on standard error if that is a terminal; after a long interpreted run, advice how to speed it up.

seconds, form --> "interpreted, in 12 s; compiled, a run takes a fifth to a fourteenth of that: make core", or nothing
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click

from ... import form

LONG = 5  # seconds from which an interpreted run gets the advice
SHARE = "a fifth to a fourteenth"  # of the shipped cases' CPU time, by `python -m tests.bench.forms` in both forms


@contextmanager
def progress(name: str) -> Iterator[Callable[[float], None] | None]:
    """Yield a function that receives the part done, 0 to 1; None if the bar would not be visible."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(name, total=1.0)
        began = time.monotonic()
        yield lambda done: bar.update(task, completed=done)
    line = cost_of_form(time.monotonic() - began)
    if line:
        click.echo(line, err=True)


def cost_of_form(seconds: float) -> str:
    """Return advice after an interpreted run of `seconds`; "" if it is short, already noted, or was requested."""
    asked = os.environ.get(form.VARIABLE) == form.INTERPRETED
    if form.running != form.INTERPRETED or form.note or asked or seconds < LONG:
        return ""
    return f"interpreted, in {seconds:.0f} s; compiled, a run takes {SHARE} of that: {form.way()}"
