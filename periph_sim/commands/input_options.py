"""What several commands take: a capture, a rate, a time. Texts of options go in, values or one sentence come out."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..core.exact_number import exact_number
from ..core.shorten import shorten
from ..core.time import TimeError, seconds

if TYPE_CHECKING:
    from ..records.run import Run
    from ..scene.project import Project
    from ..traces.capture.capture import Capture

RATE = click.option("--rate", metavar="RATE", help="Samples a second, where the file does not say: '4 MHz'.")
SALVAGE = click.option(
    "--salvage", is_flag=True, help="Read a damaged file up to the damage, and say what was dropped."
)
GUARANTEED = click.option(
    "--guaranteed/--no-guaranteed", default=None, help="Demand proven budgets; refused, since nothing is proven yet."
)
RUN_FILE = click.argument("run", type=click.Path(path_type=Path))
SYSCLK = click.option("--sysclk", metavar="RATE", help="SYSCLKOUT, where RUN does not show it: '150 MHz'.")


def read_capture(path: Path, rate: str | None, salvage: bool = False, option: str = "--rate") -> Capture:
    """The capture in a file; BadCapture if it cannot be read. option: how the rate was given, for messages."""
    from ..traces import formats

    return formats.read(path, None if rate is None else rate_given(option, rate), salvage=salvage)


def rate_given(option: str, text: str) -> Fraction:
    """Samples a second, above 0."""
    from ..traces.capture.capture import rate_of

    try:
        rate = rate_of(text)
    except ValueError as error:
        raise click.ClickException(f"{option}: {error}") from None
    if not rate:
        raise click.ClickException(f"{option}: expected more than 0")
    return rate


def time_given(option: str, text: str) -> Fraction:
    """Seconds, 0 or more."""
    try:
        length = seconds(text)
    except TimeError as error:
        raise click.ClickException(f"{option}: {error}") from None
    if length < 0:
        raise click.ClickException(f"{option}: {text!r} is negative; expected 0 or more")
    return length


def address_given(option: str, text: str) -> tuple[str, int]:
    """(address, port) of "[ADDRESS:]PORT": this computer's own where none is given."""
    address, _, port = text.rpartition(":")
    if not port.isdecimal() or int(port) > 65535:
        raise click.UsageError(f"{option} {text!r}: expected a port up to 65535, or ADDRESS:PORT; 0 is any free port")
    return address.strip("[]") or "127.0.0.1", int(port)


def pace_given(text: str) -> Fraction:
    """Simulated seconds a second."""
    try:
        return exact_number(text)
    except ValueError:
        raise click.UsageError(f"--pace {shorten(repr(text))}: expected a number, as in 1 or 0.5") from None


def length_given(text: str) -> Fraction:
    """Seconds to simulate, 0 or more: 10 or '10 s'."""
    from ..core.settings import duration

    try:
        return duration(text if text.strip()[-1:].isalpha() else f"{text} s")
    except ValueError as error:
        raise click.ClickException(f"--seconds: {error}") from None


def apart(**outputs: Path | None) -> None:
    """Refuse two options that name one file to be written, where the later one would take the other's place."""
    taken: dict[Path, str] = {}
    for option, path in outputs.items():
        if path is not None:
            other = taken.setdefault(path.resolve(), option)
            if other != option:
                raise click.ClickException(f"--{other} and --{option} both name {path}; give each a file of its own")


def refuse_guaranteed(asked: bool | None, project: Project | None = None) -> None:
    """Refuse --guaranteed, and `guaranteed = true` of the project. asked: None where the option is not given."""
    from ..scene.project import project_of
    from ..timing.verdict import NOTHING_PROVEN

    if asked:
        raise click.ClickException(f"--guaranteed: {NOTHING_PROVEN}; leave the option out")
    project = project or project_of(Path())
    if asked is None and project.settings.guaranteed:
        raise click.ClickException(f"{project.where('guaranteed')}: {NOTHING_PROVEN}; remove it or use --no-guaranteed")


def open_run(path: Path, sysclk: str | None) -> Run:
    """A recorded run; BadCapture or NotInRun if there is none in the file."""
    from ..records.run import Run

    return Run.read(path, None if sysclk is None else rate_given("--sysclk", sysclk))
