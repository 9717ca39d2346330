"""`periph-sim profile CASE`: time spent in functions of a case's images, and their executed source lines."""

from __future__ import annotations

import json
from contextlib import ExitStack
from pathlib import Path

import click

from ...scene.case.load import load
from .input_options import apart, length_given
from .json_output import print_json
from .progress import progress
from .usage_error import running_user_code

SECTION = "understand"
EXAMPLE = "periph-sim profile case.toml --lcov coverage.info"


@click.command()
@click.argument("case", type=click.Path(path_type=Path))
@click.option("--seconds", type=str, help="Simulate this long instead of the case's duration; 10 or '10 s'.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change one key of the case.")
@click.option("--speedscope", type=click.Path(path_type=Path), help="Write stacks with their times to this file.")
@click.option("--lcov", type=click.Path(path_type=Path), help="Write line and branch coverage to this file.")
@click.option("-v", "--verbose", is_flag=True, help="List all functions that were called.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
def profile(
    case: Path,
    seconds: str | None,
    changes: tuple[str, ...],
    speedscope: Path | None,
    lcov: Path | None,
    verbose: bool,
    as_json: bool,
) -> int:
    """Run CASE and show where its images spent their time, by function.

    The file of --speedscope is a flame graph for speedscope.app and for Perfetto; that of --lcov is for genhtml and
    editors. Exit status 0, regardless of budgets: `run` judges them.
    """
    from ...scene.profiled import profiled
    from ...traces.formats.atomic_write import atomic_write
    from ..reports.profile.formats import as_json as as_dict
    from ..reports.profile.formats import speedscope as flame_graph
    from ..reports.profile.formats import text
    from ..reports.profile.lcov import covered_files, tracefile

    apart(speedscope=speedscope, lcov=lcov)
    with running_user_code(), ExitStack() as outputs:
        length = None if seconds is None else length_given(seconds)
        flames = None if speedscope is None else outputs.enter_context(atomic_write(speedscope))
        lines = None if lcov is None else outputs.enter_context(atomic_write(lcov))
        with progress(case.stem) as on_progress:
            run = profiled(load(case, list(changes)), length, on_progress, lines is not None)
        if flames is not None:
            stacks = flame_graph(run.profiles, run.ticks_per_second, run.name, run.place_of)
            flames.write_text(json.dumps(stacks), encoding="utf-8")
        if lines is not None:
            files = covered_files((p.image, p.functions, run.coverage[unit]) for unit, p in run.programs.items())
            lines.write_text(tracefile(files, run.name), encoding="utf-8")
    if as_json:
        print_json("profile", as_dict(run.profiles, run.ticks_per_second, run.place_of))
    else:
        click.echo(text(run.profiles, run.ticks_per_second, run.place_of, verbose))
    return 0
