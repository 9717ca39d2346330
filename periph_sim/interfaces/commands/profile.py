"""`periph-sim profile CASE`: the time spent in each function of a case's images, and the executed source lines."""

from __future__ import annotations

import json
from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path

import click

from ...scene.case.load import load
from .command_frame import command, print_answer, progress, require_distinct_outputs, running_user_code
from .shared_options import CHANGES, JSON, SECONDS
from .watch import note_saved_results


@command(
    "understand",
    "periph-sim profile timing/imu_hil_image.toml --lcov coverage.info",
    "periph-sim profile timing/imu_hil_image.toml --speedscope profile.json",
)
@click.argument("case", type=click.Path(path_type=Path))
@SECONDS
@CHANGES
@click.option("--speedscope", type=click.Path(path_type=Path), help="Write stacks with their times to this file.")
@click.option("--lcov", type=click.Path(path_type=Path), help="Write line and branch coverage to this file.")
@click.option("-v", "--verbose", is_flag=True, help="List all functions that were called.")
@JSON
def profile(
    case: Path,
    length: Fraction | None,
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
    from ...traces.formats import atomic_write
    from ..reports import profile as report

    require_distinct_outputs(speedscope=speedscope, lcov=lcov)
    with running_user_code(), ExitStack() as outputs:
        note_saved_results(case)
        flames = None if speedscope is None else outputs.enter_context(atomic_write(speedscope))
        lines = None if lcov is None else outputs.enter_context(atomic_write(lcov))
        with progress(case.stem) as on_progress:
            run = report.profiled(load(case, list(changes)), length, on_progress, lines is not None)
        if flames is not None:
            flames.write_text(json.dumps(report.speedscope(run)), encoding="utf-8")
        if lines is not None:
            lines.write_text(report.tracefile(report.covered_files(run), run.name), encoding="utf-8")
    print_answer("profile", report.as_json(run) if as_json else report.text(run, verbose))
    return 0
