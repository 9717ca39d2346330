"""`periph-sim prove CASE --table`: prove budgets for all starts with closed tables, and show the result.

The glossary in `periph_sim.proof` has the terms. Users read "start" for an entry, and "meeting" for a group.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path

import click

from ...core.phrases import counted
from ...core.text_table import paragraph
from ...proof.calls import T, Ts, call_here
from ...proof.closed_table import BOTH, Contradiction, milliseconds, starts_text
from ...proof.dependencies import Dependencies, dependencies, files_read
from ...proof.free_run import NotClosed
from ...proof.proof_file import except_for, proof_of
from ...proof.saved_file import text_of
from ...proof.saved_paths import proof_path, unfinished_path
from ...proof.stretch import CoveredCase, Job
from ...proof.table_proof import TableProof, WorstInProof, prove
from ...scene.case.load import load
from ...timing.verdict import BROKEN, PROVEN, figure, limit
from ..reports.baselines.files import write_all
from ..reports.cluster import worker_pool
from ..reports.kept_calls import KeptCalls
from ..reports.processes import results_of
from ..reports.witness import witness_file
from .command_frame import print_json, print_table, progress, running_user_code, say
from .watch import note_inputs


def prove_with_table(
    job: Job,
    within: Fraction | None,
    rates: Fraction | None,
    any_tick: bool,
    jobs: int | None,
    folder: Path | None,
    save: bool,
    as_json: bool,
) -> int:
    """Make the table of a case, show it, and return the exit status: 0 if all covered budgets are proven, else 1.

    within, rates: the values of --ppm and --host-ppm; None for an option that is not given. any_tick: --any-tick.
    jobs: the number of worker processes; None for the number of cores. It has an effect if there are several tables,
        or if the case has rounds and frames.
    folder: the folder for the witnesses, which are cases that show the worst values; None to write none.
    save: True to write the proof file, if a budget is proven.

    Raise ClickException if the case has no table, or if the tables cannot be completed or saved.
    """
    case = Path(job.file)
    with running_user_code():
        note_inputs([case], job.changes, written=[proof_path(case), unfinished_path(case)] if save else [])
        kept = KeptCalls(case) if save else None  # made first, so that its file does not count as a dependency
        with files_read() as read:
            loaded = load(case, list(job.changes))
            if jobs is not None and within is None and (loaded.host is None or loaded.controller is None):
                raise click.UsageError("--jobs has no effect with --table for this case; remove it")
            before = dependencies(case.parent, loaded.files()) if save else None

            def depends() -> Dependencies | None:
                is_same = before is not None and not before.differences(case.parent)
                return dependencies(case.parent, [*read, *loaded.files()]) if is_same else None

            made = _proof(job, within, rates, any_tick, jobs or os.cpu_count() or 1, kept, depends)
            proof = None
            if before is not None and not made.has_failed:
                proof = proof_of(made, dependencies(case.parent, [*read, *made.covered.case.files()]))
                changed = before.differences(case.parent)
                if changed:
                    raise click.ClickException(f"{changed[0]} while the tables were made, so no proof is saved")
        texts = {} if proof is None or not proof.proven else {proof_path(case): text_of(proof)}
        write_all(texts)
        files = [*([] if folder is None else _write_witnesses(made, job, folder)), *texts]
        if kept is not None:
            kept.remove()
    if as_json:
        print_json("prove", _object(made, files))
    else:
        _show(made, files)
    if save and not texts:
        click.echo(f"{proof_path(case)} is not written, because no budget is proven", err=True)
    return int(any(word != PROVEN for word in made.words().values()) or made.has_failed)


def _proof(
    job: Job,
    within: Fraction | None,
    rates: Fraction | None,
    any_tick: bool,
    jobs: int,
    kept: KeptCalls | None,
    depends: Callable[[], Dependencies | None],
) -> TableProof:
    """Return the tables of a case. Raise ClickException if it can have none, or if they cannot be completed.

    kept: keeps the results of finished calls in a file; None to keep none.
    depends: returns the dependencies of these results; None if one of them has changed meanwhile.
    """
    name = load(Path(job.file), list(job.changes)).name

    def announce(tables: int, starts: int, seconds: float) -> None:
        about, of = max(1, round(seconds)), f"{tables} tables, each of about " if tables > 1 else ""
        click.echo(f"{name}: {of}{starts:,} starts to run, about {about} s of CPU", err=True)

    if kept is not None and kept.note:
        click.echo(f"{name}: {kept.note}", err=True)
    try:
        with ExitStack() as pool, progress(name) as on_progress:
            workers: list[Executor] = []

            def call_all(work: Callable[[*Ts], T], calls: Sequence[tuple[*Ts]]) -> Iterable[T]:
                if len(calls) < 2 or jobs == 1:
                    return call_here(work, calls)
                if not workers:
                    workers.append(pool.enter_context(worker_pool(jobs, None)))
                return results_of(workers[0], work, calls)

            keeping = call_all if kept is None else kept.call_all(call_all, depends)
            return prove(job, within, on_progress, announce, keeping, rates, any_tick)
    except NotClosed as error:
        if kept is not None:
            kept.remove()
        raise click.ClickException(
            f"{name} has no closed table: {error} (without --table, prove runs phases)"
        ) from None
    except Contradiction as error:
        raise click.ClickException(str(error)) from None
    except (BrokenProcessPool, KeyboardInterrupt) as error:
        is_stopped = isinstance(error, KeyboardInterrupt)
        if kept is None and is_stopped:
            raise
        why = "stopped by Ctrl-C or SIGTERM" if is_stopped else f"{name}: a process died while it made a table"
        way = "" if is_stopped else "; --jobs 1 makes all tables in this process"
        saved = "" if kept is None or not kept.save() else f"; the same command continues from {kept.path}"
        raise click.ClickException(f"{why}{way}{saved}") from None


def _write_witnesses(made: TableProof, job: Job, folder: Path) -> list[Path]:
    """Write a case for the worst value of each judged budget, and return the files."""
    files = []
    for worst in made.worst().values():
        if worst.verdict.passed or worst.verdict.broken:
            covered, run = worst.part.covered, worst.run()
            end = Fraction(run.until, covered.phases.ticks_per_second)
            inputs = (covered.phases.inputs_at(run.starts, run.rounds), end, covered.case.seed)
            changes = (*job.changes, *run.changes)
            files.append(witness_file(covered, worst.verdict, inputs, Path(job.file), changes, folder))
    return files


def _show(made: TableProof, files: Sequence[Path]) -> None:
    covered, words, worst = made.covered, made.words(), made.worst()
    moved, per_second = made.moved, covered.phases.ticks_per_second
    starts = "meetings of rounds and frames" if moved == BOTH else "starts"
    tables = "table of" if len(made.parts) == 1 else f"{len(made.parts)} tables with"
    last = made.parts[-1]
    failed = ", ".join(sorted(last.table.outcomes[-1].failures))
    state = "closed" if not made.has_failed else f"not closed: {failed} failed"
    say(
        f"{covered.case.name}: {tables} {made.entry_count:,} {starts}, {made.entries:,} of them run: {state}",
        style="bold",
    )
    rows = []
    for name, word in words.items():
        verdict = worst[name].verdict if name in worst else None
        shown = (
            ("-", "-")
            if verdict is None
            else (figure(verdict.worst, verdict.unit), limit(verdict.limit, verdict.unit, verdict.which))
        )
        rows.append(((name, *shown, word), "red" if word == BROKEN else ""))
    print_table(("budget", "worst", "limit", ""), rows, right=(1, 2), whole=(1, 2, 3))
    for reason in last.table.outcomes[-1].reasons.values():
        say(f"for example: {reason}")
    if made.has_failed and not files:
        _say("--witness FOLDER writes cases that show the worst values")
    if made.has_failed and last.changes:
        say(f"broken: with {', '.join(last.changes)}, the first of these clocks that breaks a budget")
    if PROVEN in words.values():
        _say(f"proven: for {starts_text(moved, milliseconds(made.apart, per_second), made.any_tick)}")
        if made.within is not None:
            _say(f"proven: for all clocks of the controller within {float(made.within):.15g} ppm of that in the case")
        if made.rates is not None:
            _say(f"proven: for all bit rates of the host within {float(made.rates):.15g} ppm of that in the case")
        if made.data_use == "":
            _say(f"proven: for any data of the frames{except_for(made.following_data())}")
        when = "after" if made.rests_first else "exactly at"
        firsts = {moved: made.first} if made.rests_first else covered.phases.first_starts()
        time = milliseconds if made.rests_first else _exact
        each = [f"first {one.removesuffix('s')} {when} {time(at, per_second)}" for one, at in firsts.items()]
        _say(f"assumed: {_assumed(made)} as in the case, and the {' and the '.join(each)}")
        _say("assumed: the answers of the case to open questions; --questions varies them")
    if made.again:
        what = "meeting" if moved == BOTH else "start"
        _say(f"compared: {counted(made.again, what)} run again after other {moved}; none differed")
    if made.data_use:
        _say(f"not proven for other data of the frames: {made.data_use}")
    for name, reason in made.not_proven().items():
        _say(f"not proven: {name}: {reason}")
    for name, reason in _left_out(covered).items():
        _say(f"not judged here, so run the case, too: {name}: {reason}")
    for file in files:
        say(f"written: {file}")


def _say(text: str) -> None:
    for line in paragraph(text):
        say(line)


def _exact(ticks: int, per_second: int) -> str:
    """Return ticks as text in ms, with four digits after the point, or more if they are not zero."""
    whole, _, digits = f"{1000 * ticks / per_second:.9f}".partition(".")
    return f"{whole}.{digits[:4]}{digits[4:].rstrip('0')} ms"


def _assumed(made: TableProof) -> str:
    """Return the inputs that must be as in the case, such as "clocks, rates and data"."""
    if made.rates is not None:
        inputs = [] if made.within is not None else ["the clock of the controller"]
    else:
        inputs = ["rates"] if made.within is not None else ["clocks", "rates"]
    if made.data_use != "":
        inputs.append("data")
    elif made.covered.case.controller is not None:
        inputs.append("requests")
    return ", ".join(inputs[:-1]) + " and " * (len(inputs) > 1) + inputs[-1]


def _object(made: TableProof, files: Sequence[Path]) -> dict[str, object]:
    covered, worst = made.covered, made.worst()
    return {
        "case": covered.case.name,
        "table": {
            "moved": made.moved,
            "tables": len(made.parts),
            "within_ppm": None if made.within is None else float(made.within),
            "any_tick": made.any_tick,
            "host_within_ppm": None if made.rates is None else float(made.rates),
            "data_use": made.data_use,
            "orbits": [orbit for part in made.parts for orbit in part.table.orbits],
            "entries": made.entries,
            "again": made.again,
            "apart_s": made.apart / covered.phases.ticks_per_second,
            "closed": not made.has_failed,
        },
        "runs": sum(len(part.table.outcomes) for part in made.parts),
        "budgets": {name: _budget(worst.get(name), word) for name, word in made.words().items()},
        "not_proven": made.not_proven(),
        "not_covered": _left_out(covered),
        "reasons": made.parts[-1].table.outcomes[-1].reasons,
        "written": [str(file) for file in files],
    }


def _left_out(covered: CoveredCase) -> dict[str, str]:
    """Return the reason for each budget and input of the case that the table does not cover, by its name.

    Jitter is covered, because the table has starts at all times.
    """
    return {name: reason for name, reason in covered.left_out.items() if not name.endswith(".jitter")}


def _budget(worst: WorstInProof | None, word: str) -> dict[str, object]:
    if worst is None:
        return {"verdict": word}
    return {"verdict": word, **{key: getattr(worst.verdict, key) for key in ("worst", "unit", "limit", "margin")}}
