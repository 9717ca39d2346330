"""`periph-sim prove CASE`: run a case at many phases, and find the ranges of phases in which budgets break.

The glossary in `periph_sim.proof` has the terms.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ...proof.phases import ROUNDS
from ...timing.verdict import PROVEN
from .command_frame import command, given_options, print_json, progress, running_user_code, time_given
from .shared_options import CHANGES, CLUSTER, JSON, SVG, cluster_given, diagram_file
from .watch import note_inputs

if TYPE_CHECKING:
    from ...proof.cover import Worst
    from ..reports.certain_failure import CertainFailure
    from ..reports.coverage import Coverage

MOST_PPM = 10_000  # highest value of --ppm
STEP = 97  # the default of --step in cycles; a prime number that divides no usual clock divider or length of a wait
# The parameters of `prove` that are allowed with --table, and those that are allowed with --questions.
WITH_TABLE = ("case", "changes", "folder", "table", "ppm", "rates", "any_tick", "save", "questions", "as_json")
WITH_QUESTIONS = ("case", "changes", "step", "only", "rounds", "start_up", "table", "questions", "jobs", "as_json")


@command(
    "run",
    "periph-sim prove timing/imu_hil.toml --phases '1.5 ms to 1.6 ms'",
    "periph-sim prove case.toml --step 9973 --svg windows.svg",
)
@click.argument("case", type=click.Path(path_type=Path))
@CHANGES
@click.option(
    "--step",
    type=click.IntRange(min=1),
    default=STEP,
    metavar="CYCLES",
    help=f"Distance of phases that are not near a write.  [{STEP}; 1: every phase]",
)
@click.option("--phases", "only", metavar="TIMES", help="Run only these phases: '1.5 ms to 1.6 ms'.")
@click.option(
    "--rounds",
    type=click.IntRange(min=3),
    default=ROUNDS,
    metavar="N",
    help=f"Number of rounds at one phase, for the ends of windows.  [{ROUNDS}]",
)
@click.option("--start-up", is_flag=True, help="Move the first start through the start-up instead.")
@click.option("--jobs", type=click.IntRange(min=1), help="Number of processes.  [number of cores; 1: only this one]")
@CLUSTER
@click.option(
    "--witness",
    "folder",
    type=click.Path(path_type=Path, exists=True, file_okay=False),
    help="Write a case for the worst value of each budget to this folder.",
)
@click.option("--table", is_flag=True, help="Prove all starts with a table of states. Firmware images only.")
@click.option(
    "--ppm",
    metavar="PPM",
    callback=lambda context, option, text: None if text is None else _ppm_given("--ppm", text),
    help="With --table: cover all clocks of the controller within PPM of the case's.",
)
@click.option(
    "--host-ppm",
    "rates",
    metavar="PPM",
    callback=lambda context, option, text: None if text is None else _ppm_given("--host-ppm", text),
    help="With --table and a [controller]: cover all bit rates of the host within PPM of the case's.",
)
@click.option("--any-tick", is_flag=True, help="With --table, [host] and [controller]: let rounds start at any tick.")
@click.option(
    "--save",
    is_flag=True,
    help="Save the result beside the case, in coverage or proofs.",
)
@click.option("--questions", is_flag=True, help="Also run with other answers to the open questions.")
@SVG
@JSON
def prove(
    case: Path,
    changes: tuple[str, ...],
    step: int,
    only: str | None,
    rounds: int,
    start_up: bool,
    jobs: int | None,
    cluster: str | None,
    folder: Path | None,
    table: bool,
    ppm: Fraction | None,
    rates: Fraction | None,
    any_tick: bool,
    save: bool,
    questions: bool,
    svg: Path | None,
    as_json: bool,
) -> int:
    """Run CASE at many phases, and show the phases at which budgets break.

    With a [host] and a [controller], a phase is the start of a frame, counted from the start of a round; those at
    which an interrupt comes near a write are run cycle by cycle, if there are not too many. With only one of them, it
    is the start of a frame or round, counted from its nominal time. With neither, it is the delay of [[serial.send]].

    Without --table, the result holds for the phases that were run, in the states that these runs reached. It is no
    proof for other states, other run times of code, or other clocks.

    With --table, the states between rounds and frames are compared, and each start is run from each of these states.
    If no further state appears, the budgets are proven for all starts. This needs one unit, with ppm 0, that runs an
    image, and constant data. With --ppm, this is done for each clock of the controller that gives other lengths in
    ticks. With --host-ppm, frames are run at all rates that the SCI samples differently. With --any-tick, rounds are
    also started between two cycles of the CPU, which takes longer. Allowed with --table are --set, --witness, --save,
    --json, --ppm, --host-ppm, --any-tick and --questions, and --jobs with --ppm, --questions, or a case that has a
    [host] and a [controller].

    With --questions, the phases or the table are run again with each other answer to the open questions, and with
    pairs of related answers. The output names the budgets whose verdict depends on an answer.

    With --save, the result is written to coverage/NAME.json beside the case, with --table and a proven budget to
    proofs/NAME.json. A coverage or a table that was stopped is continued.

    Exit status 0: no run failed, and every budget that the output does not list as left out held at all these phases
    (with --table: is proven; with --questions: with every answer); 1: otherwise; 2: the command was stopped (results
    so far are shown, except with --table), or a file could not be written.
    """
    from ...proof.coverage_file import CoverageFile
    from ...proof.saved_paths import coverage_path, proof_path
    from ...proof.stretch import CoveredCase, Job
    from ..reports.certain_failure import certain_failures
    from ..reports.coverage import STOPPED, choose, run_coverage
    from .prove_text import HELD, show, words_of

    if save and changes:
        raise click.UsageError("--save with --set: a saved result is of the unchanged case; remove one of them")
    for option, given in (("--ppm", ppm), ("--host-ppm", rates), ("--any-tick", any_tick or None)):
        if given is not None and not table:
            raise click.UsageError(f"{option} needs --table; add it")
    if table:
        _refuse_others("--table", (*WITH_TABLE, "jobs"))
    if questions:
        from ..reports.questions.covered_rows import Cover
        from ..reports.questions.dependence import RUN
        from .under_questions import judge_under_questions

        _refuse_others("--questions", WITH_QUESTIONS)
        cover = Cover(step, None if only is None else _between(only), rounds, start_up, table)
        with running_user_code():
            left_out = CoveredCase(Job(str(case), changes, start_up, rounds)).left_out
        judged = judge_under_questions("prove --questions", case, changes, None, jobs, as_json, cover.row, left_out)
        return int(not all(one.holds and (not table or one.word == PROVEN or one.name == RUN) for one in judged))
    if table:
        from .prove_table import prove_with_table

        if save:
            _check_writable(proof_path(case))
        return prove_with_table(Job(str(case), changes), ppm, rates, any_tick, jobs, folder, save, as_json)
    if save and start_up:
        raise click.UsageError("--save with --start-up: a coverage file covers the rounds; remove one of them")
    with running_user_code():
        workers = cluster_given(cluster, jobs)
        path = coverage_path(case) if save else None
        note_inputs([case], changes, written=[] if path is None else [path])
        if path is not None:
            _check_writable(path)
        job = Job(str(case), changes, start_up, rounds)
        found = choose(job, step, None if only is None else _between(only))
        saved = None if path is None else CoverageFile.read(path)
        if saved is not None and not found.continue_from(saved) and saved.is_complete:
            click.echo(f"{path} has a coverage of other phases or files, which a complete one replaces", err=True)
        click.echo(_announcement(found), err=True)
        # `choose` regards all imported modules as dependencies of the coverage, so Dask is imported after it.
        with workers as executor, progress(found.case.case.name) as on_progress:
            run_coverage(found, jobs or os.cpu_count() or 1, on_progress, path, executor)
        certain: list[CertainFailure] = []
        files, failed = [] if path is None else [path], ""
        try:
            certain = [] if found.stopped else certain_failures(found)
            written, failed = ([], "") if folder is None else _write_witnesses(found, case, changes, folder)
            files[:0] = written
            files += [] if svg is None else _draw(found, certain, svg)
        except KeyboardInterrupt:
            found.stopped = found.stopped or STOPPED
    if as_json:
        print_json("prove", _object(found, words_of(found), certain, files))
    else:
        show(found, certain, files)
    for reason in filter(None, (found.stopped, failed)):
        click.echo(f"Error: {reason}", err=True)
    if found.stopped or failed:
        return 2
    return int(any(word != HELD for word in words_of(found).values()) or bool(found.windows or found.found.drifting))


def _ppm_given(option: str, text: str) -> Fraction:
    """Return the value of an option in ppm. Raise ClickException if it is not a number from 0 to MOST_PPM."""
    from ...core.exact_number import exact_number

    try:
        number = exact_number(text)
    except ValueError:
        number = Fraction(-1)
    if not 0 <= number <= MOST_PPM:
        raise click.ClickException(f"{option} {text!r}: expected a number from 0 to {MOST_PPM:,}")
    return number


def _refuse_others(option: str, effective: Sequence[str]) -> None:
    """Raise UsageError if the command line has a parameter that is not allowed together with `option`.

    effective: the names of the allowed parameters.
    """
    for name, other in given_options().items():
        if name not in effective:
            raise click.UsageError(f"{other} has no effect with {option}; remove it")


def _draw(found: Coverage, certain: Sequence[CertainFailure], place: Path) -> list[Path]:
    """Write a diagram of the windows of phases in which budgets break. Return the written files.

    place: an .svg file, or a folder, which also gets a diagram of the shares of runs that fail.
    """
    from ..reports.baselines.files import write_all
    from ..reports.phase_picture import picture, picture_of_shares

    name = found.case.case.name
    pictures = {diagram_file(place, f"{name}_phases"): picture(found)}
    if certain and place.is_dir():
        pictures[place / f"{name}_certain.svg"] = picture_of_shares(found, certain)
    write_all(pictures)
    return [*pictures]


def _check_writable(path: Path) -> None:
    """Raise ClickException if the file of a result cannot be written, because of its folder.

    path: the path of the file. Its folder, such as "proofs", is inside the folder of the case. If it does not exist,
        the folder of the case must be writable, so that it can be created.

    Raise nothing if the folder of the case does not exist: the error of reading the case is clearer.
    """
    folder = path.parent
    if os.path.lexists(folder) and not folder.is_dir():
        raise click.ClickException(f"--save: {folder}: it is no folder; move or remove it")
    there = folder if folder.exists() else folder.parent
    if there.exists() and not os.access(there, os.W_OK):
        raise click.ClickException(f"--save: {there} is not writable; change its permissions")


def _between(text: str) -> tuple[Fraction, Fraction]:
    """Return the times of an option such as "1.5 ms to 1.6 ms", in seconds."""
    first, to, last = text.partition(" to ")
    if not to:
        raise click.ClickException(f"--phases {text!r}: expected two times, for instance '1.5 ms to 1.6 ms'")
    return time_given("--phases", first.strip()), time_given("--phases", last.strip())


def _announcement(found: Coverage) -> str:
    """Return a line such as "slave: 929 phases to run, about 3 s of CPU if nothing breaks"."""
    seconds = max(1, round(found.seconds * found.missing / len(found.chosen)))
    done = f"continued after {found.run_count:,} phases; " if found.finished else ""
    missing = f"{found.missing:,} phase{'s' * (found.missing != 1)}"
    return f"{found.case.case.name}: {done}{missing} to run, about {seconds} s of CPU if nothing breaks"


# JSON and files -----------------------------------------------------------------


def _object(
    found: Coverage, words: Mapping[str, str], certain: Sequence[CertainFailure], files: Sequence[Path]
) -> dict[str, object]:
    phases = found.case.phases
    return {
        "case": found.case.case.name,
        "phases": {
            "moved": phases.moved,
            "start_up": phases.start_up,
            "count": phases.count,
            "cycle_s": float(phases.seconds(1)),
            "chosen": len(found.chosen),
            "run": found.run_count,
            "near": found.choice.near,
            "step": found.choice.step,
            "rounds": found.choice.rounds,
        },
        "runs": found.found.runs,
        "budgets": {name: _budget(found.found.worst.get(name), word) for name, word in words.items()},
        "windows": [
            {
                "name": one.name,
                "first": one.first,
                "last": one.last,
                "run": one.run,
                "closed": one.is_closed,
            }
            for one in found.windows
        ],
        "certain": [one._asdict() for one in certain],
        "drifting": [
            {"names": sorted(one.names), "first": one.first, "last": one.last} for one in found.found.drifting
        ],
        "not_covered": dict(found.case.left_out),
        "reasons": found.found.reasons,
        "written": [str(file) for file in files],
        "stopped": found.stopped,
    }


def _budget(worst: Worst | None, word: str) -> dict[str, object]:
    if worst is None:
        return {"verdict": word}
    verdict = worst.verdict
    figures = {key: getattr(verdict, key) for key in ("worst", "unit", "limit", "margin")}
    return {"verdict": word, **figures, "first_phase": worst.phases[0], "last_phase": worst.phases[-1]}


def _write_witnesses(found: Coverage, case: Path, changes: Sequence[str], folder: Path) -> tuple[list[Path], str]:
    """Write a witness for each judged budget: a case that shows its worst value.

    Return the written files, and the reason why others are missing; "" if all could be written.
    """
    from ...traces.capture.capture import BadCapture
    from ..reports.witness import witness_file

    files: list[Path] = []
    try:
        for worst in found.found.worst.values():
            if worst.verdict.passed or worst.verdict.broken:
                run = (*found.case.phases.inputs(worst.phases), worst.seed)
                files.append(witness_file(found.case, worst.verdict, run, case, changes, folder))
    except BadCapture as error:  # the file cannot be written
        return files, str(error)
    return files, ""
