"""Options that several commands have, each with the same meaning in all of them.

`replay` accepts fewer values of --frame than the other commands, because captures are decoded without mark and space.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ...core.tolerance import Tolerance, parse_tolerance
from .command_frame import length_given
from .completion import complete_key

if TYPE_CHECKING:
    from ..reports.cluster import ClusterExecutor

F = TypeVar("F", bound=Callable[..., Any])
NUMBER = re.compile(r"-?\d+")
RATE = click.option("--rate", metavar="RATE", help="Sample rate, if the file has none: '4 MHz'.")
SALVAGE = click.option(
    "--salvage",
    is_flag=True,
    help="Read a damaged file (no .psr, .fst, .ghw) up to the damage, and say what was dropped.",
)
GUARANTEED = click.option(
    "--guaranteed/--no-guaranteed",
    default=None,
    callback=lambda context, option, asked: _guaranteed(asked),
    help="Require a proof (prove --table --save) of each budget.",
)
CHANGES = click.option(
    "--set",
    "changes",
    multiple=True,
    metavar="KEY=VALUE",
    shell_complete=complete_key,
    help="Change one key of the case.",
)
SECONDS = click.option(
    "--seconds",
    "length",
    type=str,
    callback=lambda context, option, text: None if text is None else length_given(text),
    help="Simulate this long instead of the case's duration; 10 or '10 s'.",
)
JOBS = click.option(
    "--jobs", type=click.IntRange(min=1), help="Number of processes.  [number of cores; 1: only this one]"
)
CLUSTER = click.option("--cluster", metavar="ADDRESS", help="Use the workers of this Dask scheduler: 10.0.0.5:8786.")
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
RUN_FILE = click.argument("run", type=click.Path(path_type=Path))
MAP = click.option(
    "--map", "mapping", metavar="LINE=CHANNEL,...", help="Channels of the lines, by name or index: scl=0,sda=1 or rx=0."
)
EIGHT_BITS = "8n1"  # the default of --frame
FRAME = click.option(
    "--frame",
    metavar="FRAME",
    help="Data bits, parity n, o, e, m or s (replay: n, o or e), and stop bits.  [8n1]",
)
SVG = click.option(
    "--svg",
    type=click.Path(path_type=Path),
    metavar="PLACE",
    callback=lambda context, option, place: _checked_place(place),
    help="Draw timing diagrams: one to an .svg file, or each to a file in a folder.",
)
SYSCLK = click.option("--sysclk", metavar="RATE", help="SYSCLKOUT, if RUN does not contain it: '150 MHz'.")


def cluster_given(address: str | None, jobs: int | None) -> AbstractContextManager[ClusterExecutor | None]:
    """Return a context that is connected to the cluster of --cluster; its value is None if the option is not given."""
    if address is None:
        return nullcontext()
    if jobs is not None:
        raise click.UsageError("--cluster with --jobs: a cluster has its own workers; remove one of them")
    from ..reports.cluster import connected

    return connected(address)


def diagram_file(place: Path, name: str) -> Path:
    """Return the file of a diagram for --svg. name: the name of the file, without suffix, if `place` is a folder."""
    return place / f"{name}.svg" if place.is_dir() else place


def _checked_place(place: Path | None) -> Path | None:
    """Return the place of diagrams. Raise ClickException if it is neither a folder nor the name of an .svg file."""
    if place is None or place.is_dir() or place.suffix.lower() == ".svg":
        return place
    raise click.ClickException(f"--svg: {place} is no folder; create it, or give another, or an .svg file")


def tolerance_option(plain: bool = False) -> Callable[[F], F]:
    """Return the option --tolerance. plain: True to accept a number without a unit as cycles, with a notice."""

    def parsed(context: click.Context, option: click.Parameter, text: str | None) -> Tolerance | None:
        if text is None:
            return None
        if plain and NUMBER.fullmatch(text.strip()):
            text = f"{text.strip()} cycles"
            click.echo(f"--tolerance without a unit is obsolete; write --tolerance '{text}'", err=True)
        try:
            return parse_tolerance(text)
        except ValueError as error:
            raise click.ClickException(f"--tolerance: {error}") from None

    help = "Allowed difference of times: '3 us' or '20 cycles'."
    return click.option("--tolerance", metavar="TIME", callback=parsed, help=help)


def _guaranteed(asked: bool | None) -> bool:
    """Return True if budgets must be proven: by the option, or by `guaranteed = true` in the project's settings.

    asked: True for --guaranteed, False for --no-guaranteed, None if neither option is given.
    """
    from ...scene.project import project_of

    if asked is not None:
        return asked
    return project_of(Path()).settings.guaranteed
