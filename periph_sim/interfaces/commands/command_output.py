"""Output of all commands: lines, tables, JSON objects, errors in one sentence, the progress bar.

Tables fit 80 columns without losing words. Lines have styles on a terminal, but not in a pipe or a file.
"""

from __future__ import annotations

import json
import os
import shlex
import sys
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager

import click

from ... import form
from ...core.text_table import WIDTH, table_rows, together

CODES = {"bold": 1, "dim": 2, "italic": 3, "red": 31, "yellow": 33}  # of the styles of lines, in escape sequences
UNSEEN = dict.fromkeys((7, 8, 11, 12, 13))  # control codes that are removed from lines
TAB = 8


def say(*texts: str, style: str = "") -> None:
    """Print texts without breaking their lines, so that they can be searched for. style: a key of CODES, or ""."""
    styled = bool(style) and _has_styles()
    for line in (line for text in texts for line in text.split("\n")):
        line = line.translate(UNSEEN).expandtabs(TAB)
        click.echo(f"\x1b[{CODES[style]}m{line}\x1b[0m" if styled and line else line, color=True)


def _has_styles() -> bool:
    """Return True if standard output is a terminal with styles, or if a variable says so."""
    if os.environ.get("NO_COLOR") or os.environ.get("TERM") in ("dumb", "unknown"):
        return False
    return sys.stdout.isatty() or bool(os.environ.get("FORCE_COLOR")) or os.environ.get("TTY_COMPATIBLE") == "1"


def print_table(
    titles: Sequence[str],
    rows: Sequence[tuple[Sequence[str], str]],
    right: Collection[int] = (),
    whole: Collection[int] = (),
) -> None:
    """Print a table with a line under its titles. It is as wide as the terminal, but at least 80 columns.

    rows: the cells of each row, and its style.
    right: the numbers of the columns that are aligned at the right.
    whole: the numbers of the columns whose cells are kept on one line.
    """
    lowest = max(title.count("\n") for title in titles)
    low_titles = ["\n" * (lowest - title.count("\n")) + title for title in titles]
    cells = [[together(cell) if n in whole else cell for n, cell in enumerate(row)] for row, _ in rows]
    head, *body = table_rows(low_titles, cells, right, max(_columns(), WIDTH))
    say("", *head[:-1], style="bold")
    say(head[-1])
    for lines, (_, style) in zip(body, rows, strict=True):
        say(*lines, style=style)
    say("")


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


VERSION = 2  # incremented when a key is removed or changes its meaning, not for a new key


def print_json(command: str, answer: Mapping[str, object]) -> None:
    """Print one object on standard output. Its `schema` is the command, and its `schema_version` is VERSION.

    Its last key, `form`, is the form of the core that was used.
    """
    answer_object = {"schema": f"periph-sim {command}", "schema_version": VERSION, **answer, "form": form.running}
    click.echo(json.dumps(answer_object, indent=2, ensure_ascii=False))


def print_answer(command: str, answer: Mapping[str, object] | str) -> None:
    """Print an answer, which is a text, or an object for JSON."""
    if isinstance(answer, str):
        click.echo(answer)
    else:
        print_json(command, answer)


# Errors caused by input. They are given by name, so that a command that cannot raise an error need not import it.
MISTAKES = {
    "periph_sim.interfaces.reports.baselines.files.BadCheck",
    "periph_sim.scene.case.model.BadCase",
    "periph_sim.core.input_error.InputError",
    "periph_sim.core.kernel.SimulationStuck",
    "periph_sim.core.time.TimeError",
    "periph_sim.core.wire.TooManyParties",
    "periph_sim.f28335.memory.memory_map.NoSuchAddress",
    "periph_sim.traces.capture.capture.BadCapture",
    "periph_sim.processor.user_code.FirmwareError",
    "periph_sim.records.run.NotInRun",
    "periph_sim.records.recording.BadRecording",
    "periph_sim.replay.BadReplay",
    "periph_sim.outside.errors.OutsideError",
    "periph_sim.processor.image_files.load.BadImage",
}


def is_mistake(error: BaseException) -> bool:
    """Return True if input caused the error; then its text is a sentence."""
    return not MISTAKES.isdisjoint(f"{kind.__module__}.{kind.__qualname__}" for kind in type(error).__mro__)


@contextmanager
def running_user_code() -> Iterator[None]:
    """Apply `usage_errors_in_one_sentence`, and redirect the output of user code to standard error."""
    from ...processor.user_code import output_aside

    with usage_errors_in_one_sentence(), output_aside():
        yield


@contextmanager
def usage_errors_in_one_sentence() -> Iterator[None]:
    """Turn errors caused by input into one line on standard error and status 2."""
    try:
        yield
    except Exception as error:
        if not is_mistake(error):
            raise
        raise click.ClickException(str(error)) from None


LONG = 5  # an interpreted run of this many seconds or more gets the advice to compile the core
# CPU time of the shipped cases compiled, relative to interpreted; measured with `python -m tests.bench.forms`.
SHARE = "a fifth to a fourteenth"


@contextmanager
def progress(name: str) -> Iterator[Callable[[float], None] | None]:
    """Yield a function that displays the completed share, 0 to 1; None if the bar would not be visible."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(name, total=1.0)
        began = time.monotonic()
        yield lambda done: bar.update(task, completed=done)
    line = cost_of_form(time.monotonic() - began)
    if line:
        click.echo(line, err=True)


def cost_of_form(seconds: float) -> str:
    """Return advice to compile the core after an interpreted run of `seconds`.

    Return "" if the run was short, a note on this has been printed already, or the interpreted form was requested.
    """
    asked = os.environ.get(form.VARIABLE) == form.INTERPRETED
    if form.running != form.INTERPRETED or form.note or asked or seconds < LONG:
        return ""
    return f"interpreted, in {seconds:.0f} s; compiled, a run takes {SHARE} of that: {form.way()}"


def command_line() -> str:
    """Return the command line without the program's folder: "periph-sim run timing/imu_hil.toml --seconds 1"."""
    return shlex.join(["periph-sim", *sys.argv[1:]])
