"""Summary of a case's coverage file, for the output of `run`, of `check` and of the HTML report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from msgspec import Struct

from ...proof.coverage_file import Choice, CoverageFile
from ...proof.saved_file import BadSavedFile
from ...proof.saved_paths import coverage_path
from ...timing.verdict import Verdict


class PhasesReport(Struct, frozen=True):
    """Summary of a coverage file.

    line: a sentence about the file, such as "coverage/slave.json: 3 budgets held at 929 of 3,000,000 phases".
    count: how many phases of a period were run, such as "929 of 3,000,000 phases".
    worst: the worst value of each budget, and its phase as text, by the name of the budget. It is empty if the file is
        out of date or not complete.
    """

    line: str
    count: str
    worst: dict[str, tuple[Verdict, str]]


def phases_report(case: Path) -> PhasesReport | None:
    """Return the summary of a case's coverage file; None if there is no file.

    If the file cannot be read, `line` is the reason.
    """
    path = coverage_path(case)
    try:
        found = CoverageFile.current(path, case)
    except BadSavedFile as error:
        return PhasesReport(str(error), "", {})
    return None if found is None else report_of(path, *found)


def report_of(path: Path, file: CoverageFile, differences: Sequence[str]) -> PhasesReport:
    """Return the summary of a coverage file. differences: a phrase for each dependency that has changed."""
    count = f"{file.run_count:,} of {file.choice.count:,} phases"
    if differences:
        more = f" and {len(differences) - 1} more" if len(differences) > 1 else ""
        return PhasesReport(f"{path.as_posix()} is out of date: {differences[0]}{more}", count, {})
    if not file.is_complete:
        parts = f"{file.finished} of {file.parts} parts"
        return PhasesReport(f"{path.as_posix()} is not complete: {parts}; prove --save continues it", count, {})
    worst = {name: (one.verdict, phase_text(one.phases, file.choice)) for name, one in file.found.worst.items()}
    return PhasesReport(f"{path.as_posix()}: {_summary(file, count)}", count, worst)


def phase_text(phases: Sequence[int], choice: Choice) -> str:
    """Return the phases of a run as times, such as "phase 1.5700000 ms"."""
    first, last = (choice.time(phase) for phase in (phases[0], phases[-1]))
    return f"phase {last}" if first == last else f"phases {first.removesuffix(' ms')} to {last}"


def _summary(file: CoverageFile, count: str) -> str:
    """Return a phrase that says at how many phases budgets held, or which budgets broke."""
    broken = {window.name for window in file.windows or ()}
    broken |= {name for one in file.found.drifting for name in one.names}
    if broken:
        return f"{count} run; broken at some of them: {', '.join(sorted(broken))}"
    judged = sum(1 for runs in file.found.judged.values() if runs)
    return f"{judged} budgets held at {count}"
