"""Output that all commands share: JSON objects, errors in one sentence, the progress bar, the command line."""

from __future__ import annotations

import json
import os
import shlex
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

import click

from ... import form

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
    "periph_sim.processor.image_files.model.BadImage",
}


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
        if MISTAKES.isdisjoint(f"{kind.__module__}.{kind.__qualname__}" for kind in type(error).__mro__):
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
