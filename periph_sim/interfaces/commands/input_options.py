"""Options of several commands, such as a capture, a rate, a time, and their parsing."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ...core.exact_number import exact_number
from ...core.shorten import shorten
from .command_output import usage_errors_in_one_sentence

if TYPE_CHECKING:
    from ...records.run import Run
    from ...traces.capture.capture import Capture

FILE_NAME = re.compile(r"[A-Za-z0-9_][\w.-]*")
RATE = click.option("--rate", metavar="RATE", help="Sample rate, if the file has none: '4 MHz'.")
SALVAGE = click.option(
    "--salvage", is_flag=True, help="Read a damaged file up to the damage, and say what was dropped."
)
GUARANTEED = click.option(
    "--guaranteed/--no-guaranteed",
    default=None,
    expose_value=False,
    callback=lambda context, option, asked: _refuse_guaranteed(asked),
    help="Require proven budgets; an error, since nothing is proven yet.",
)
CHANGES = click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change one key of the case.")
SECONDS = click.option(
    "--seconds",
    "length",
    type=str,
    callback=lambda context, option, text: None if text is None else length_given(text),
    help="Simulate this long instead of the case's duration; 10 or '10 s'.",
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
RUN_FILE = click.argument("run", type=click.Path(path_type=Path))
SYSCLK = click.option("--sysclk", metavar="RATE", help="SYSCLKOUT, if RUN does not contain it: '150 MHz'.")


def read_capture(path: Path, rate: str | None, salvage: bool = False, option: str = "--rate") -> Capture:
    """Read the capture in a file. Raise BadCapture if it cannot be read.

    option: the name of the option for the rate, for messages.
    """
    from ...traces import formats

    return formats.read(path, None if rate is None else rate_given(option, rate), salvage=salvage)


def rate_given(option: str, text: str) -> Fraction:
    """Parse a rate above 0 in samples per second."""
    from ...traces.capture.capture import rate_of

    try:
        rate = rate_of(text)
    except ValueError as error:
        raise click.ClickException(f"{option}: {error}") from None
    if not rate:
        raise click.ClickException(f"{option}: expected more than 0")
    return rate


def time_given(option: str, text: str) -> Fraction:
    """Parse a time of 0 or more. Return seconds."""
    from ...core.settings import duration

    try:
        return duration(text)
    except ValueError as error:
        raise click.ClickException(f"{option}: {error}") from None


def address_given(option: str, text: str) -> tuple[str, int]:
    """Parse "[ADDRESS:]PORT". Return (address, port); the default address is that of this computer."""
    address, _, port = text.rpartition(":")
    if not port.isdecimal() or int(port) > 65535:
        raise click.UsageError(f"{option} {text!r}: expected a port up to 65535, or ADDRESS:PORT; 0 is any free port")
    return address.strip("[]") or "127.0.0.1", int(port)


def pace_given(text: str) -> Fraction:
    """Parse --pace. Return the number of simulated seconds per second."""
    try:
        return exact_number(text)
    except ValueError:
        raise click.UsageError(f"--pace {shorten(repr(text))}: expected a number, as in 1 or 0.5") from None


def length_given(text: str) -> Fraction:
    """Parse the value of --seconds, such as 10 or '10 s'. Return seconds, 0 or more."""
    return time_given("--seconds", text if text.strip()[-1:].isalpha() else f"{text} s")


def check_file_name(place: Path) -> None:
    """Reject a file name with characters that are difficult to type or to import."""
    if not FILE_NAME.fullmatch(place.name):
        raise click.ClickException(f"{place.name!r} is no name for files; expected letters, digits, '_' and '-'")


def apart(**outputs: Path | None) -> None:
    """Reject two options that name the same output file."""
    taken: dict[Path, str] = {}
    for option, path in outputs.items():
        if path is not None:
            other = taken.setdefault(path.resolve(), option)
            if other != option:
                raise click.ClickException(f"--{other} and --{option} both name {path}; give each its own file")


def _refuse_guaranteed(asked: bool | None) -> None:
    """Reject --guaranteed, and `guaranteed = true` in the project's settings.

    asked: the value of the option; None if it is not given.
    """
    from ...scene.project import project_of
    from ...timing.verdict import NOTHING_PROVEN

    if asked:
        raise click.ClickException(f"--guaranteed: {NOTHING_PROVEN}; remove the option")
    with usage_errors_in_one_sentence():
        project = project_of(Path())
    if asked is None and project.settings.guaranteed:
        raise click.ClickException(f"{project.where('guaranteed')}: {NOTHING_PROVEN}; remove it or use --no-guaranteed")


def open_run(path: Path, sysclk: str | None) -> Run:
    """Open a recorded run. Raise BadCapture or NotInRun if the file does not contain one."""
    from ...records.run import Run

    return Run.read(path, None if sysclk is None else rate_given("--sysclk", sysclk))
