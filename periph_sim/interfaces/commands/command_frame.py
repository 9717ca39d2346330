"""Code that all commands share: their decorator, values of options, reports of input errors, and output of answers.

arguments --> rate_given, ...: values   input errors --> one line on standard error, status 2
answer -----> lines, tables as wide as the terminal (at least 80 columns), or one JSON object
"""

from __future__ import annotations

import json
import os
import re
import shlex
import sys
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from fractions import Fraction
from inspect import cleandoc
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click
from click.core import ParameterSource

from ... import form
from ...core.exact_number import exact_number
from ...core.output_encoding import writes_utf8
from ...core.phrases import nearest, shorten
from ...core.text_table import WIDTH, table_rows, together

if TYPE_CHECKING:
    from ...records.run import Run
    from ...traces.capture.capture import Capture


Section = Literal["run", "understand", "traces", "sensors"]


class Command(click.Command):
    """A command whose messages about its command line suggest the fix."""

    former: Mapping[str, str] = {}  # a dictionary from former names of options to the present ones

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        args = [self._renamed(ctx, text) for text in args]
        given = [*args]
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            long = [name[2:] for one in self.params for name in one.opts if name[:2] == "--"]
            unknown, near = error.option_name, nearest(error.option_name.lstrip("-"), long)
            for text in given:  # click reads a long option with only one dash as several short options
                meant = nearest(text[1:], long) if SINGLE_DASH.match(text) and unknown[1] in text else []
                if meant:
                    unknown, near = text, meant[:1]
            names = " or ".join(f"'--{name}'" for name in near)
            hint = f" Did you mean {names}?" if near else ""
            raise click.NoSuchOption(unknown, f"No such option {unknown!r}.{hint}", ctx=ctx) from None
        except click.UsageError as error:
            before, after = _split_change(given)
            if after and "extra argument" in error.message:
                fix = f"--set {shlex.quote(f'{before}={after}')}"
                raise click.UsageError(f"--set {before}: expected KEY=VALUE; write {fix}", ctx) from None
            raise

    def _renamed(self, ctx: click.Context, text: str) -> str:
        """Return an argument with the present name of its option. Print a notice if `text` has a former name."""
        name, equals, value = text.partition("=")
        new = self.former.get(name)
        if new is None:
            return text
        if not ctx.resilient_parsing:  # no notice while a shell completes the line
            click.echo(f"{name} of {ctx.info_name} is now {new}; the next release refuses {name}", err=True)
        return f"{new}{equals}{value}"


SINGLE_DASH = re.compile(r"-[A-Za-z][\w-]+")


def _split_change(given: Sequence[str]) -> tuple[str, str]:
    """Find a --set that is split by blanks: `--set KEY = VALUE`. Return (KEY, VALUE); ("", "") if none is split."""
    for n, option in enumerate(given[:-2]):
        key = given[n + 1].rstrip(":= ")
        value, unit, *_ = *(word.removeprefix("=").strip() for word in given[n + 2 :] if word != "="), "", ""
        if option == "--set" and "=" not in key and not value.startswith("-"):
            return key, f"{value} {unit}" if unit.isalpha() or unit == "%" else value
    return "", ""


def command(
    section: Section, *examples: str, former: Mapping[str, str] | None = None
) -> Callable[[Callable[..., object]], click.Command]:
    """Return a decorator that makes a function a command of periph-sim.

    section: the section of `periph-sim --help` that lists the command.
    examples: the command lines with which the help of the command begins.
    former: a dictionary from former names of options to the present names. The former names still work.
    """

    def made(function: Callable[..., object]) -> click.Command:
        found = click.command(cls=Command)(function)
        found.former = former or {}
        lines = "\n".join(f"$ {example}" for example in examples)
        found.help = f"\b\n{lines}\n\n{cleandoc(found.help or '')}"
        return found

    return made


CODES = {
    "bold": 1,
    "dim": 2,
    "italic": 3,
    "red": 31,
    "green": 32,
    "yellow": 33,
}  # a dictionary from styles to ANSI escape codes
UNSEEN = dict.fromkeys((7, 8, 11, 12, 13))  # control characters that `say` removes from its texts
TAB = 8


def say(*texts: str, style: str = "") -> None:
    """Print texts. Long lines are not wrapped, so that the output can be searched.

    style: a key of CODES; "" for no style. Styles are used only if `_has_styles` returns True.
    """
    styled = bool(style) and _has_styles()
    for line in (line for text in texts for line in text.split("\n")):
        line = line.translate(UNSEEN).expandtabs(TAB)
        click.echo(f"\x1b[{CODES[style]}m{line}\x1b[0m" if styled and line else line, color=True)


def _has_styles() -> bool:
    """Return True if output may have styles.

    It may if standard output is a terminal, or if FORCE_COLOR or TTY_COMPATIBLE requests styles. NO_COLOR and some
    values of TERM forbid styles.
    """
    if os.environ.get("NO_COLOR") or os.environ.get("TERM") in ("dumb", "unknown"):
        return False
    return sys.stdout.isatty() or bool(os.environ.get("FORCE_COLOR")) or os.environ.get("TTY_COMPATIBLE") == "1"


def print_table(
    titles: Sequence[str],
    rows: Sequence[tuple[Sequence[str], str]],
    right: Collection[int] = (),
    whole: Collection[int] = (),
) -> None:
    """Print a table with a line under the titles. The table may use the width of the terminal, but at least 80 columns.

    rows: the cells and the style of each row.
    right: the numbers, from 0, of the columns that are aligned at the right.
    whole: the numbers, from 0, of the columns whose cells are kept on one line.
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
    """Return the number of columns from the environment variable COLUMNS, else of the terminal; 0 if it is unknown."""
    said = os.environ.get("COLUMNS", "")
    if said.isdecimal():
        return int(said)
    for stream in (sys.__stdin__, sys.__stdout__, sys.__stderr__):
        try:
            return 0 if stream is None else os.get_terminal_size(stream.fileno()).columns
        except (ValueError, OSError):  # the stream is closed or is not a terminal
            pass
    return 0


VERSION = 2  # version of the JSON output; it increases when a key is removed or gets another meaning


def print_json(command: str, answer: Mapping[str, object]) -> None:
    """Print an answer as one JSON object on standard output.

    The first keys of the object are `schema`, which names the command, and `schema_version`. The last key is `form`:
    whether the simulation core was compiled or interpreted.
    """
    head = {"schema": f"periph-sim {command}", "schema_version": VERSION}
    click.echo(json.dumps({**head, **answer, "form": form.running}, indent=2, ensure_ascii=not writes_utf8()))


def print_answer(command: str, answer: Mapping[str, object] | str) -> None:
    """Print an answer: a text as it is, or a dictionary by `print_json`."""
    if isinstance(answer, str):
        click.echo(answer)
    else:
        print_json(command, answer)


# Classes of errors that the user's input causes. They are named and not imported, because a command needs few of them.
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
    "periph_sim.outside.errors.OutsideError",
    "periph_sim.processor.image_files.model.BadImage",
}


def is_mistake(error: BaseException) -> bool:
    """Return True if an error was caused by the user's input. The text of such an error is a sentence."""
    return not MISTAKES.isdisjoint(f"{kind.__module__}.{kind.__qualname__}" for kind in type(error).__mro__)


def running_user_code() -> AbstractContextManager[None]:
    """Return a context in which user code prints to standard error, because standard output belongs to the command."""
    from ...processor.user_code import output_aside

    return output_aside()


LONG = 5  # in seconds; an interpreted run that takes at least this time gets the advice to compile the core
# The CPU time of a compiled run as a share of that of an interpreted run, measured by `python -m tests.bench.forms`.
SHARE = "a fifth to a fourteenth"


@contextmanager
def progress(name: str) -> Iterator[Callable[[float], None] | None]:
    """Yield a function that displays the completed share, 0 to 1, as a bar; None if standard error is no terminal.

    If it is a terminal, the advice of `cost_of_form` is printed after a block without error. name: the text at the bar.
    """
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

    Return "" if the core is compiled, if the run was short, if another note on the form (compiled or interpreted) has
    been printed already, or if the user requested the interpreted form.
    """
    asked = os.environ.get(form.VARIABLE) == form.INTERPRETED
    if form.running != form.INTERPRETED or form.note or asked or seconds < LONG:
        return ""
    return f"interpreted, in {seconds:.0f} s; compiled, a run takes {SHARE} of that: {form.way()}"


def command_line() -> str:
    """Return the command line without the program's folder: "periph-sim run timing/imu_hil.toml --seconds 1"."""
    return shlex.join(["periph-sim", *sys.argv[1:]])


FILE_NAME = re.compile(r"[A-Za-z0-9_][\w.-]*")


def read_capture(path: Path, rate: str | None, salvage: bool = False, option: str = "--rate") -> Capture:
    """Read the capture in a file. Raise BadCapture if it cannot be read, and ClickException if the rate is invalid.

    rate: the sample rate as the user wrote it; None if the option is not given.
    salvage: True to read a damaged file up to the damage.
    option: the name of the option for the rate, for messages.
    """
    from ...traces import formats

    return formats.read(path, None if rate is None else rate_given(option, rate), salvage=salvage)


def rate_given(option: str, text: str) -> Fraction:
    """Parse a rate, such as '4 MHz'. Return it in Hz; it is above 0. option: the name of the option, for messages."""
    from ...traces.capture.capture import rate_of

    try:
        rate = rate_of(text)
    except ValueError as error:
        raise click.ClickException(f"{option}: {error}") from None
    if not rate:
        raise click.ClickException(f"{option}: expected more than 0")
    return rate


def time_given(option: str, text: str) -> Fraction:
    """Parse a time of 0 or more. Return seconds. option: the name of the option, for messages."""
    from ...core.table import duration

    try:
        return duration(text)
    except ValueError as error:
        raise click.ClickException(f"{option}: {error}") from None


def address_given(option: str, text: str) -> tuple[str, int]:
    """Parse "[ADDRESS:]PORT". Return (address, port); the default address is 127.0.0.1."""
    address, _, port = text.rpartition(":")
    if not port.isdecimal() or int(port) > 65535:
        raise click.UsageError(f"{option} {text!r}: expected a port up to 65535, or ADDRESS:PORT; 0 is any free port")
    return address.strip("[]") or "127.0.0.1", int(port)


def i2c_address_given(option: str, text: str, most: int = 0x7F) -> int:
    """Parse an I2C address. option: the name of the option, for messages. most: the largest address."""
    try:
        address = int(text, 0)
    except ValueError:
        address = -1
    if not 0 <= address <= most:
        kind = f"{most.bit_length()}-bit address; expected 0 to 0x{most:X}"
        raise click.ClickException(f"{option}: {text!r} is no {kind}, right-aligned")
    return address


def pace_given(text: str) -> Fraction:
    """Parse --pace. Return the number of simulated seconds per second of real time."""
    try:
        return exact_number(text)
    except ValueError:
        raise click.UsageError(f"--pace {shorten(repr(text))}: expected a number, as in 1 or 0.5") from None


def length_given(text: str) -> Fraction:
    """Parse the value of --seconds, such as 10 or '10 s'. Return seconds, 0 or more."""
    return time_given("--seconds", text if text.strip()[-1:].isalpha() else f"{text} s")


def given_options() -> dict[str, str]:
    """Return a dictionary from the parameters that the command line states to their options, such as "--baud"."""
    context = click.get_current_context()
    named = {one.name or "": one.opts[0] for one in context.command.params}
    given = ParameterSource.COMMANDLINE
    return {name: option for name, option in named.items() if context.get_parameter_source(name) is given}


def check_file_name(place: Path) -> None:
    """Raise ClickException if a file name begins with "." or "-", or has not only letters, digits, "_", "." and "-"."""
    if not FILE_NAME.fullmatch(place.name):
        raise click.ClickException(f"{place.name!r} is no name for files; expected letters, digits, '_' and '-'")


def require_distinct_outputs(**outputs: Path | None) -> None:
    """Raise ClickException if two options name the same output file. outputs: the path that each option names."""
    taken: dict[Path, str] = {}
    for option, path in outputs.items():
        if path is not None:
            other = taken.setdefault(path.resolve(), option)
            if other != option:
                raise click.ClickException(f"--{other} and --{option} both name {path}; give each its own file")


def open_run(path: Path, sysclk: str | None) -> Run:
    """Open a recorded run. Raise BadCapture or NotInRun if the file cannot be read or does not contain a run.

    sysclk: the frequency of SYSCLKOUT as the user wrote it; None if the option is not given.
    """
    from ...records.run import Run

    return Run.read(path, None if sysclk is None else rate_given("--sysclk", sysclk))
