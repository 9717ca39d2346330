"""`periph-sim run CASE`: run a case, print the verdicts of its budgets, and set the exit status."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ...processor.user_code import FirmwareError
from ...proof.saved_paths import coverage_path, proof_path
from ...records.recording import recording
from ...scene.case.load import load
from ...scene.result import Result
from ...scene.scene import Scene
from .command_frame import (
    command,
    command_line,
    print_json,
    progress,
    require_distinct_outputs,
    running_user_code,
    say,
)
from .completion import complete_optimization
from .result_text import show
from .shared_options import CHANGES, GUARANTEED, JOBS, JSON, SECONDS
from .watch import note_saved_results

if TYPE_CHECKING:
    from ..reports.explain.chain import Chain


@command(
    "run",
    "periph-sim run timing/imu_hil.toml --seconds 1 --explain",
    "periph-sim run timing/imu_hil.toml --set seed=2 --record run.psr",
    "periph-sim run timing/responder.toml --seconds 0.01 --questions",
)
@click.argument("case", type=click.Path(path_type=Path))
@SECONDS
@CHANGES
@click.option(
    "--disable",
    multiple=True,
    metavar="NAME",
    shell_complete=complete_optimization,
    help="Switch off an optimization: bits, polls, decoding; or all.",
)
@click.option("--fidelity", metavar="LEVEL", hidden=True, help="Obsolete: every run is exact.")
@click.option("--max-error", metavar="TIME", hidden=True, help="Obsolete: every run is exact.")
@click.option("--record", type=click.Path(path_type=Path), help="Write the run to a file; its suffix says the format.")
@click.option("--html", type=click.Path(path_type=Path), help="Write a report with plots and timelines to this file.")
@GUARANTEED
@click.option("--explain", is_flag=True, help="Explain the worst occurrence of each budget.")
@click.option(
    "-v", "--verbose", is_flag=True, help="List the undocumented behaviours that the run assumed; count skipped polls."
)
@click.option(
    "--questions",
    is_flag=True,
    help="Run again with each other answer to the open questions on which the run depends, and with pairs of them.",
)
@JOBS
@JSON
def run(
    case: Path,
    length: Fraction | None,
    changes: tuple[str, ...],
    disable: tuple[str, ...],
    fidelity: str | None,
    max_error: str | None,
    record: Path | None,
    html: Path | None,
    guaranteed: bool,
    explain: bool,
    verbose: bool,
    questions: bool,
    jobs: int | None,
    as_json: bool,
) -> int:
    """Run CASE and judge its budgets.

    Exit status 0: the case has budgets, all of them hold (with --guaranteed: and are proven), and nothing hangs;
    1: otherwise. With --questions, this applies to all runs.
    """
    for_one = {"--record": record, "--html": html, "--explain": explain, "--verbose": verbose}
    for option in (option for option, given in for_one.items() if given and questions):
        raise click.ClickException(f"{option} is for one run, and --questions makes many; leave one of them out")
    if guaranteed and questions:
        what = "--questions runs the case with other answers, which no proof covers; use --no-guaranteed"
        raise click.ClickException(what)
    if jobs is not None and not questions:
        raise click.ClickException("--jobs needs --questions, since a single run takes one process; leave it out")
    require_distinct_outputs(record=record, html=html)
    if disable:
        changes += (f"disable={json.dumps(disable, ensure_ascii=False)}",)
    if fidelity or max_error:
        changes += (f"fidelity={fidelity or 'auto'}",)
    if questions:
        from .under_questions import judge_under_questions

        judged = judge_under_questions("run --questions", case, changes, length, jobs, as_json)
        return int(not all(one.holds for one in judged))
    with running_user_code(), ExitStack() as outputs:
        note_saved_results(case)
        loaded = load(case, list(changes))
        unfinished = None
        if html is not None:
            from ...traces.formats import atomic_write

            unfinished = outputs.enter_context(atomic_write(html))
        with recording(record, loaded.recorded_modules) as (subscribe, ended_at):
            scene = Scene(loaded, subscribe, keep_values=html is not None)
            stopped: Exception | None = None
            try:
                with progress(loaded.name) as on_progress:
                    result = scene.run(length, on_progress)
            except FirmwareError as error:
                stopped = error
            ended_at(scene.kernel.now, scene.clocks())
        if stopped is not None:
            at = scene.timebase.show(scene.kernel.now - scene.start)
            kept = "" if record is None else f"; {record} contains the run up to there"
            raise click.ClickException(f"{stopped}; this was at {at} of the run{kept}")
        proof = None
        if guaranteed or proof_path(case).exists():
            from ..reports.proofs import mark_proven

            proof = mark_proven(case, changes, result.budgets)
        covered = None
        if not changes and length is None and coverage_path(case).exists():
            from ..reports.coverage_line import phases_report

            covered = phases_report(case)
        chains: dict[str, Chain] = {}
        if explain:
            from ..reports.explain.explain import explain as explained

            found = explained(scene.case, result.budgets, scene.typical(), length)
            chains = {one.window.verdict.name: one.chain for one in found}
        interrupted: KeyboardInterrupt | None = None
        assumed: Mapping[str, Sequence[str]] = {name: chain.assumed for name, chain in chains.items()}
        if any(one.broken for one in result.budgets) and not (explain or as_json):
            from ..reports.explain.assumed import assumed_in

            try:  # `assumed_in` runs up to a second of the case again; Ctrl-C ends only that run
                assumed = assumed_in(scene.case, result, length)
            except KeyboardInterrupt as error:
                interrupted = error
        if unfinished is not None:
            from ..reports.html.gather import case_report
            from ..reports.html.page import page

            values = [limit.values(scene.start) for limit in scene.limits]
            per_second = scene.timebase.per_second
            about = "" if proof is None else proof.line
            typical = scene.typical()
            report = case_report(loaded, result, values, typical, per_second, length, changes, None, covered, about)
            unfinished.write_text(page([report], loaded.name, command_line()), encoding="utf-8")
    missing = [text for _, text in proof.missing(result.budgets)] if guaranteed and proof is not None else []
    if as_json:
        print_json("run", _object(result, chains if explain else None))
    else:
        show(result, loaded, verbose, assumed)
        lines = "" if covered is None else covered.line, "" if proof is None else proof.line_beside(missing)
        say(*filter(None, lines))
        if interrupted is not None:
            raise interrupted
        if chains:
            from ..reports.explain.chain import text

            for chain in chains.values():
                click.echo("\n".join(["", *text(chain)]))
    for reason in missing:
        click.echo(f"guaranteed: {reason}", err=True)
    return int(result.verdict != "pass" or bool(missing))


def _object(result: Result, chains: dict[str, Chain] | None) -> dict[str, object]:
    """Return the result as a dictionary for JSON.

    chains: for the name of each budget, the explanation that becomes its key `chain`. The key is null for a budget
        whose worst value has no instant. None: the result has no key `chain`.
    """
    shown = dataclasses.asdict(result)
    if chains is not None:
        from ..reports.explain.chain import as_json

        for budget in shown["budgets"]:
            chain = chains.get(budget["name"])
            budget["chain"] = None if chain is None else as_json(chain)
    return shown
