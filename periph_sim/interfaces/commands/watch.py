"""`periph-sim watch CASE`: run a case again when one of its files changes, and show the differences."""

from __future__ import annotations

import time
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ...core.input_files import note_inputs_of
from ...proof.saved_paths import coverage_path, proof_path, unfinished_path
from ...scene.case.load import CaseFile, apply
from ...scene.case.model import BadCase
from ...scene.case.origin import named_files, texts_in
from ...scene.case.toml_file import read
from ...scene.project import baseline_path
from ...timing.verdict import title
from .command_frame import command, say
from .result_text import HEADLINES, broken_lines, budget_table
from .shared_options import CHANGES

if TYPE_CHECKING:
    from ..reports.baselines.outcome import Outcome, RejectedCase

PAUSE = 0.3  # seconds between checks of the files; polling needs no library and works on any file system


@command("run", "periph-sim watch timing/imu_hil.toml", "periph-sim watch case.toml --set controller.period='5 ms'")
@click.argument("case", type=click.Path(path_type=Path))
@CHANGES
def watch(case: Path, changes: tuple[str, ...]) -> int:
    """Run CASE again whenever one of its files changes, until Ctrl-C.

    Its files are the case, every file that the case or --set names, the files beside these that they
    may import or include, and its baseline. After the first run, the figures that changed since the run
    before are printed in place of the table of budgets.
    """
    from ..reports.baselines.outcome import run_case

    try:
        _check_command_line(case, changes)
        before: Outcome | None = None
        while True:
            seen = stamps(case, changes)
            before = _print_run(run_case(case, changes), before)
            while stamps(case, changes) == seen:
                time.sleep(PAUSE)
    except KeyboardInterrupt:
        click.echo()
    return 0


def _check_command_line(case: Path, changes: tuple[str, ...]) -> None:
    """Raise BadCase for mistakes that no edit of the case corrects: a missing file, and an invalid --set.

    If the case is not valid without --set, --set is not checked.
    """
    file = CaseFile(case)
    try:
        _ = file.case
    except BadCase:
        return
    file.changed(changes)


def _print_run(came: Outcome | RejectedCase, before: Outcome | None) -> Outcome | None:
    """Print the outcome of a run. Return the outcome with which the next run is compared.

    came: the outcome to print.
    before: the last outcome that was not rejected; None if there is none.
    """
    from ..reports.baselines.compare import compare
    from ..reports.baselines.files import BadCheck
    from ..reports.baselines.files import read as read_baseline
    from ..reports.baselines.outcome import RejectedCase

    if isinstance(came, RejectedCase):
        say(f"Error: {came.why}")
        return before
    result = came.result
    say(f"{came.figures.case}: {title(result.verdict, result.budgets)}", style=HEADLINES[result.verdict])
    if before is None:
        budget_table(came.verdicts)
    say(*(f"  {line}" for line in (*broken_lines(came.verdicts), *came.trouble)))
    if before is not None:
        changed = [f"  {change}" for change in compare(before.figures, came.figures) if not change.note]
        say(*(changed or ["  no figure changed"]))
    try:
        baseline = read_baseline(baseline_path(came.path))
    except BadCheck as error:
        say(f"  {error}")
        return came
    if baseline is not None:
        count = sum(not change.note for change in compare(baseline, came.figures))
        say(f"  baseline: {f'{count} figures differ' if count else 'equal'}")
    return came


Stamps = dict[Path, tuple[int, int]]


def stamps(case: Path, changes: Iterable[str] = ()) -> Stamps:
    """Return a dictionary from each existing file of a changed case to its time of last change, in ns, and its size."""
    found: Stamps = {}
    for file in {baseline_path(case), *files_of(case, changes)}:
        with suppress(OSError, ValueError):
            status = file.stat()
            found[file] = (status.st_mtime_ns, status.st_size)
    return found


def note_inputs(cases: Iterable[Path], changes: Sequence[str] = (), written: Collection[Path] = ()) -> None:
    """Register the files of these cases as inputs of the command. A command must not write to its inputs.

    Commands whose worker processes read the files call this function, because files are otherwise registered only
    in the process that reads them.

    changes: the "key=value" texts that the command applies to the cases, together or in different runs.
    written: saved results of the cases that the command writes, which are left out.
    """
    for case in cases:
        note_inputs_of(files_of(case, changes))
        note_saved_results(case, written)


def note_saved_results(case: Path, written: Collection[Path] = ()) -> None:
    """Register the saved results of a case as inputs, so that no output replaces them.

    These are the baseline, the coverage file, the proof file, and the results of an unfinished table.

    written: those of these files that the command writes, which are left out.
    """
    saved = (baseline_path(case), coverage_path(case), proof_path(case), unfinished_path(case))
    note_inputs_of(file for file in saved if file not in written)


def files_of(case: Path, changes: Iterable[str] = ()) -> Iterator[Path]:
    """Yield the paths of the case file, of files that the case names, and of files beside its sources.

    The files beside sources are those that the sources may import or include. A path need not exist.

    changes: "key=value" texts. The files that their values name are files of the case, too.
    """
    yield case
    trees: list[dict[str, object]] = []
    with suppress(BadCase):
        trees.append(read(case, "case")[1])
    for change in changes:
        trees.append({})
        with suppress(BadCase):
            apply(trees[-1], change)
    yield from named_files(case.parent, texts_in(trees))
