"""`periph-sim check [PATH...]`: run cases, compare their figures with saved ones (baselines), set the exit status."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ...timing.verdict import BROKEN, NOT_JUDGED, PROVEN, SEEN
from .command_frame import (
    command,
    command_line,
    print_json,
    print_table,
    progress,
    require_distinct_outputs,
    running_user_code,
    say,
)
from .shared_options import CHANGES, CLUSTER, GUARANTEED, JOBS, JSON, cluster_given, tolerance_option
from .watch import note_inputs

if TYPE_CHECKING:
    from ...core.tolerance import Tolerance
    from ..reports.baselines.check import CaseCheck
    from ..reports.baselines.outcome import RejectedCase
    from ..reports.cluster import ClusterExecutor


@command("run", "periph-sim check timing --junit results.xml", "periph-sim check timing/imu_hil.toml --update-baseline")
@click.argument("paths", nargs=-1, type=click.Path(path_type=Path), metavar="[PATH]...")
@tolerance_option(plain=True)
@click.option("--update-baseline", "update", is_flag=True, help="Make the figures of this run the new baselines.")
@CHANGES
@GUARANTEED
@JOBS
@CLUSTER
@JSON
@click.option("--junit", "junit_file", type=click.Path(path_type=Path), help="Write JUnit XML to this file.")
@click.option("--html", "html_file", type=click.Path(path_type=Path), help="Write one report of all cases here.")
@click.option("--summary", "summary_file", type=click.Path(path_type=Path), help="Write a summary in Markdown here.")
@click.option("--since", metavar="COMMIT", help="With --summary: show changes since this commit's baselines.")
@click.option(
    "--annotations", type=click.Choice(["github"]), help="Print a line for each finding in the format of a CI service."
)
def check(
    paths: tuple[Path, ...],
    tolerance: Tolerance | None,
    update: bool,
    changes: tuple[str, ...],
    guaranteed: bool,
    jobs: int | None,
    cluster: str | None,
    as_json: bool,
    junit_file: Path | None,
    html_file: Path | None,
    summary_file: Path | None,
    since: str | None,
    annotations: str | None,
) -> int:
    """Run cases and compare their figures with their baselines, exactly.

    PATH is a case file, or a folder with cases in it or below it. Default: `cases` of
    [tool.periph-sim] in the nearest pyproject.toml, else timing beside this file, else its folder. Without such a
    table: timing, else the current folder. Baselines are baselines/NAME.json beside the case, or in `baselines` of
    that table. If a case has a coverage file (prove --save), the runs that gave its worst values are repeated and
    compared, too.

    Exit status 0: the budgets that a case lists in `breaks` are broken, all others hold (with --guaranteed: and
    are proven), nothing hangs,
    and all figures are those of the baselines and coverage files; 1: otherwise; 2: a case could not be run
    (the others were). Cases that are driven from outside are listed, but not run.
    """
    import msgspec

    from ...scene.project import baseline_path, project_of
    from ...traces.formats import atomic_write
    from ..reports.baselines.check import case_files
    from ..reports.baselines.check import check as checked
    from ..reports.explain import chain as chains

    if update and changes:
        raise click.UsageError("--update-baseline with --set: a baseline is of the unchanged case; remove one of them")
    if since is not None and summary_file is None:
        raise click.UsageError("--since is for --summary; give both")
    require_distinct_outputs(junit=junit_file, html=html_file, summary=summary_file)
    refused: list[RejectedCase] = []
    with running_user_code(), ExitStack() as outputs:
        workers = cluster_given(cluster, jobs)
        project = project_of(Path())
        cases = case_files(paths or project.cases())
        if any(file is not None for file in (junit_file, html_file, summary_file)):
            note_inputs(cases, changes, written=[baseline_path(case) for case in cases] if update else [])
        before = None
        if since is not None:
            from ..reports.baselines.summary import baselines_at

            before = since, baselines_at(since, map(baseline_path, cases))
        # Output files are opened before the runs, so that a file that cannot be written is reported at once.
        unfinished, unfinished_html, unfinished_summary = (
            None if file is None else outputs.enter_context(atomic_write(file))
            for file in (junit_file, html_file, summary_file)
        )
        executor = outputs.enter_context(workers)
        with progress("check") as on_progress:
            checks = checked(
                paths or project.cases(),
                jobs=jobs or project.settings.jobs,
                tolerance=project.settings.tolerance if tolerance is None else tolerance,
                update=update,
                changes=changes,
                keep_values=html_file is not None,
                on_progress=on_progress,
                on_refused=refused.append,
                cluster=executor,
                guaranteed=guaranteed,
            )
        outside = [one for one in refused if one.outside]
        refused = [one for one in refused if not one.outside]
        if outside and not checks and not refused:
            raise click.ClickException(f"there is nothing to check: {outside[0].why}")
        if unfinished is not None:
            from ..reports.baselines.ci_output import junit

            unfinished.write_text(junit(checks, refused), encoding="utf-8")
        if unfinished_html is not None:
            unfinished_html.write_text(_html(checks, refused, jobs, executor), encoding="utf-8")
        if unfinished_summary is not None:
            from ..reports.baselines.summary import summary

            unfinished_summary.write_text(summary(checks, refused, before), encoding="utf-8")
    passed = all(one.passed for one in checks) and not refused
    if as_json:
        print_json(
            "check",
            {
                "verdict": "pass" if passed else "fail",
                "cases": [
                    {
                        "case": one.outcome.figures.case,
                        "file": one.outcome.path.as_posix(),
                        "verdict": "pass" if one.passed else "fail",
                        "breaks": list(one.outcome.breaks),
                        "broken": one.outcome.broken,
                        "not_judged": [name for name in one.outcome.not_passed if name not in one.outcome.broken],
                        "baseline": {"file": one.baseline.as_posix(), "state": one.state},
                        "coverage": _coverage(one),
                        "proven": [verdict.name for verdict in one.outcome.verdicts if verdict.proven],
                        "findings": [asdict(finding) for finding in one.findings],
                        "causes": {name: chains.as_json(chain) for name, chain in one.causes.items()},
                        "changes": [asdict(change) for change in one.changes],
                        "figures": msgspec.to_builtins(one.outcome.figures),
                    }
                    for one in checks
                ],
                "refused": [{"file": one.path.as_posix(), "why": one.why} for one in refused],
                "driven_from_outside": [{"file": one.path.as_posix(), "why": one.why} for one in outside],
            },
        )
    else:
        _show(checks, refused)
        say(*(f"{one.path.as_posix()}: driven from outside, so not run here" for one in outside))
    if annotations is not None:
        from ..reports.baselines.ci_output import github

        for line in github(checks, refused):
            # GitHub reads standard output and standard error. With --json, standard output must remain one JSON object.
            click.echo(line, err=as_json)
    if refused:
        return 2
    return 0 if passed else 1


def _coverage(one: CaseCheck) -> dict[str, str] | None:
    if one.coverage is None:
        return None
    return {"file": one.coverage.file.as_posix(), "state": one.coverage.state, "says": one.coverage.report.line}


def _html(
    checks: list[CaseCheck], refused: list[RejectedCase], jobs: int | None, cluster: ClusterExecutor | None
) -> str:
    """Return the HTML report. Each case is run again to get its timelines.

    If the connection to the cluster is lost, the cases are run on this computer.
    """
    from ..reports.baselines.workers import workers
    from ..reports.cluster import ClusterError
    from ..reports.html.gather import report_of_file
    from ..reports.html.page import page

    with workers(jobs, len(checks), cluster) as start:
        waiting = [
            start(
                report_of_file,
                one.outcome.path,
                one.outcome.changes,
                one.outcome.result,
                one.outcome.values,
                one.outcome.typical,
                one.outcome.figures.ticks_per_second,
                [finding.text for finding in one.findings],
                None if one.coverage is None else one.coverage.report,
                one.proof_line,
            )
            for one in checks
        ]
        try:
            reports = [came() for came in waiting]
        except ClusterError:
            return _html(checks, refused, jobs, None)
    title = reports[0].name if len(reports) == 1 and not refused else "periph-sim check"
    return page(reports, title, command_line(), [f"{one.path.stem} cannot be run: {one.why}" for one in refused])


def _show(checks: list[CaseCheck], refused: list[RejectedCase]) -> None:
    from ..reports.explain import chain as chains
    from .result_text import budget_table, legend

    say(f"check: {sum(one.passed for one in checks)} of {len(checks) + len(refused)} as they should be", style="bold")
    rows: list[tuple[tuple[str, ...], str]] = [
        *map(_row, checks),
        *(((case.path.stem, *[""] * (len(TITLES) - 2), "refused"), "red") for case in refused),
    ]
    covered = any(one.coverage is not None for one in checks)
    left_out = {COVERAGE} if not covered else set()
    if not any(verdict.proven for one in checks for verdict in one.outcome.verdicts):
        left_out.add(PROVEN)
    columns = [place for place, title in enumerate(TITLES) if title not in left_out]
    rows = [(tuple(cells[place] for place in columns), style) for cells, style in rows]
    titles = [TITLES[place] for place in columns]
    print_table(titles, rows, right=range(1, titles.index("baseline")), whole=range(len(columns)))
    if checks:
        say(LEGEND, *[COVERAGE_LEGEND] * covered)
    say(*(f"Error: {case.why}" for case in refused))
    for one in (one for one in checks if not one.passed):
        if set(one.outcome.not_passed) != set(one.outcome.breaks):
            say(f"{one.outcome.figures.case}: FAIL", style="red")
            budget_table(one.outcome.verdicts)
            say(*legend(one.outcome.verdicts))
        say(*(f"{one.outcome.path.as_posix()}, line {finding.line}: {finding.text}" for finding in one.findings))
        for chain in one.causes.values():
            click.echo("\n".join(["", *chains.text(chain)]))
    for one in checks:
        notes = [str(change) for change in one.changes if change.note]
        if notes and one.state != "written":
            about = "counts of the simulation, which cannot fail"
            say(f"note: {one.outcome.figures.case}: {', '.join(notes)} ({about})")
        if errors := one.outcome.result.reception():
            say(f"note: {one.outcome.figures.case}: {', '.join(errors)}")
    say(*(one.coverage.report.line for one in checks if one.coverage is not None and not one.coverage.findings))
    say(*(one.proof_line for one in checks if one.proof_line))
    for one in checks:
        if one.state == "written":
            say(*(f"{one.outcome.figures.case}: {change}" for change in one.changes))
            click.echo(f"written: {one.baseline.as_posix()}")
            if one.changes:
                click.echo(one.diff)


# The column COVERAGE is shown only if a case has a coverage file, which `prove --save` writes. The column PROVEN is
# shown only if a budget is proven.
COVERAGE = "coverage"
TITLES = ("case", PROVEN, "seen", "broken", "not\njudged", "must\nbreak", "baseline", COVERAGE, "")
LEGEND = "columns count budgets; must break: named in `breaks`; baseline: changed figures"
COVERAGE_LEGEND = "coverage: worst values of prove --save, run again; other phases are not run"


def _row(one: CaseCheck) -> tuple[tuple[str, ...], str]:
    """Return the cells and the style of a case's row.

    The cells contain the numbers of budgets by verdict, and the states of the baseline and of the coverage.
    """
    words = [verdict.word for verdict in one.outcome.verdicts]
    numbers = [str(words.count(word)) for word in (PROVEN, SEEN, BROKEN, NOT_JUDGED)]
    changed = sum(not change.note for change in one.changes)
    state = f"{changed} changed" if one.state == "changed" else one.state
    coverage = ""
    if one.coverage is not None:
        differing = one.coverage.state == "changed"
        coverage = f"{len(one.coverage.findings)} changed" if differing else one.coverage.state
    cells = (one.outcome.figures.case, *numbers, str(len(one.outcome.breaks)), state, coverage)
    return (*cells, "pass" if one.passed else "fail"), "green" if one.passed else "red"
