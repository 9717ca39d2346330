"""`periph-sim prove CASE --table`: prove budgets for every start with a table, and show the result."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import click

from ...core.phrases import counted
from ...proof.closed_table import Contradiction, StartTable, TableMaker, WorstInRuns
from ...proof.dependencies import dependencies, files_read
from ...proof.free_run import NotClosed
from ...proof.proof_file import proof_of
from ...proof.saved_file import text_of
from ...proof.saved_paths import proof_path
from ...proof.stretch import CoveredCase, Job
from ...timing.verdict import BROKEN, NOT_JUDGED, PROVEN, figure, limit
from ..reports.baselines.files import write_all
from ..reports.witness import witness_file
from .command_frame import print_json, print_table, progress, running_user_code, say
from .watch import note_inputs

HELD = "held"  # the word for a budget that no run broke, and that the table does not prove


def prove_with_table(case: Path, changes: tuple[str, ...], folder: Path | None, save: bool, as_json: bool) -> int:
    """Make the table of a case, show it, and return the exit status: 0 if all budgets are proven, else 1.

    folder: where the witnesses are written; None to write none.
    save: True to write the proof file, if the table is closed.

    Raise ClickException if the case has no table.
    """
    with running_user_code():
        note_inputs([case])
        with files_read() as read:
            covered = CoveredCase(Job(str(case.absolute()), changes))
            made = _table(covered)
            proof = None
            if save and not made.has_failed:
                proof = proof_of(made, covered, dependencies(case.absolute().parent, [*read, *covered.case.files()]))
        files = [] if folder is None else _write_witnesses(made, covered, case, changes, folder)
        if proof is not None and proof.proven:
            write_all({proof_path(case): text_of(proof)})
            files.append(proof_path(case))
    if as_json:
        print_json("prove", _object(made, covered, files))
    else:
        _show(made, covered, files)
    if save and (proof is None or not proof.proven):
        click.echo(f"{proof_path(case)} is not written, because no budget is proven", err=True)
    return int(any(word != PROVEN for word in _words(made, covered).values()) or made.has_failed)


def _table(covered: CoveredCase) -> StartTable:
    """Return the table of a case. Raise ClickException if there is none."""

    def announce(starts: int, seconds: float) -> None:
        about = max(1, round(seconds))
        click.echo(f"{covered.case.name}: {starts:,} starts to run, about {about} s of CPU", err=True)

    try:
        with progress(covered.case.name) as on_progress:
            return TableMaker(covered, on_progress, announce).make()
    except NotClosed as error:
        otherwise = "without --table, prove runs its phases, which proves nothing"
        raise click.ClickException(f"{covered.case.name} has no closed table: {error}; {otherwise}") from None
    except Contradiction as error:
        raise click.ClickException(str(error)) from None


def _words(made: StartTable, covered: CoveredCase) -> dict[str, str]:
    """Return a dictionary from each covered budget to BROKEN, NOT_JUDGED, PROVEN or HELD."""
    worst, not_proven, words = made.worst(), made.not_proven(covered), {}
    for budget in covered.case.budget:
        found = worst.get(budget.name)
        if found is None or not (found.verdict.passed or found.verdict.broken):
            words[budget.name] = NOT_JUDGED
        elif found.verdict.broken:
            words[budget.name] = BROKEN
        else:
            words[budget.name] = HELD if made.has_failed or budget.name in not_proven else PROVEN
    return words


def _write_witnesses(
    made: StartTable, covered: CoveredCase, case: Path, changes: Sequence[str], folder: Path
) -> list[Path]:
    """Write a case for the worst value of each judged budget, and return the files."""
    files = []
    for worst in made.worst().values():
        if worst.verdict.passed or worst.verdict.broken:
            starts, until = made.run_of(worst, covered.phases.ticks_per_second)
            end = Fraction(until, covered.phases.ticks_per_second)
            run = (covered.phases.inputs_at(starts), end, covered.case.seed)
            files.append(witness_file(covered, worst.verdict, run, case, changes, folder))
    return files


def _show(made: StartTable, covered: CoveredCase, files: Sequence[Path]) -> None:
    words, worst, moved = _words(made, covered), made.worst(), covered.phases.moved
    of = sum(made.orbits)
    state = "closed" if not made.has_failed else "not closed, because a run failed"
    say(f"{covered.case.name}: table of {of:,} starts, {made.entries:,} of them run: {state}", style="bold")
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
    for reason in made.outcomes[-1].reasons.values():
        say(f"for example: {reason}")
    if PROVEN in words.values():
        apart = made.apart / covered.phases.ticks_per_second * 1000
        say(f"proven: for all sequences of {moved} that start at least {apart:.4f} ms apart")
        first, one = covered.phases.first_start() / covered.phases.ticks_per_second * 1000, moved.removesuffix("s")
        say(f"assumed: clocks, rates and data as in the case, and the first {one} exactly at {first:.4f} ms")
    if made.again:
        say(f"compared: {counted(made.again, 'start')} run again after other {moved}; none differed")
    for name, reason in made.not_proven(covered).items():
        say(f"not proven: {name}: {reason}")
    for name, reason in _left_out(covered).items():
        say(f"not judged here, so run the case, too: {name}: {reason}")
    for file in files:
        say(f"written: {file}")


def _object(made: StartTable, covered: CoveredCase, files: Sequence[Path]) -> dict[str, object]:
    words, worst = _words(made, covered), made.worst()
    return {
        "case": covered.case.name,
        "table": {
            "moved": covered.phases.moved,
            "orbits": made.orbits,
            "entries": made.entries,
            "again": made.again,
            "apart_s": made.apart / covered.phases.ticks_per_second,
            "closed": not made.has_failed,
        },
        "runs": len(made.outcomes),
        "budgets": {name: _budget(worst.get(name), word) for name, word in words.items()},
        "not_proven": made.not_proven(covered),
        "not_covered": _left_out(covered),
        "reasons": made.outcomes[-1].reasons,
        "written": [str(file) for file in files],
    }


def _left_out(covered: CoveredCase) -> dict[str, str]:
    """Return what the table does not cover. It covers jitter, because later starts may come at any time."""
    return {name: reason for name, reason in covered.left_out.items() if not name.endswith(".jitter")}


def _budget(worst: WorstInRuns | None, word: str) -> dict[str, object]:
    if worst is None:
        return {"verdict": word}
    return {"verdict": word, **{key: getattr(worst.verdict, key) for key in ("worst", "unit", "limit", "margin")}}
