"""Check of a coverage file: the runs with its worst values are repeated, and the values are compared.

    coverage file --phases, seed--> runs --> values now --compared with the saved ones--> state, findings

The runs are repeated even if the case or its firmware has changed. The other phases of the file are not run, so the
result says nothing about them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Literal

from msgspec.structs import replace

from ...core.phrases import counted
from ...core.tolerance import Cycles, Tolerance, in_seconds
from ...proof.coverage_file import CoverageFile
from ...proof.saved_file import BadSavedFile
from ...proof.saved_paths import coverage_path
from ...proof.stretch import STUCK, CoveredCase, Job
from ...scene.result import Result
from ...timing.verdict import FAIL, Verdict, broken, figure
from . import REFUSED
from .coverage_line import PhasesReport, phase_text, report_of

State = Literal["as saved", "changed", "out of date", "incomplete", "unreadable", "not run"]
RENEW = "prove --save renews it"


@dataclass(frozen=True)
class CoverageCheck:
    """The result of checking a coverage file.

    state: the first of these that applies:
        "unreadable": the file is no coverage, or was removed
        "not run": the check was stopped before its runs
        "changed": values or phases differ from those in the file, or the runs cannot be made
        "incomplete": phases are missing in the file
        "out of date": the case or its files have changed
        "as saved": none of these
    report: the summary of the file.
    findings: the differences as pairs of a name and a sentence. The name is that of the budget, or None for the whole
        case. First come the findings about the whole case and about budgets that are broken now.
    """

    file: Path
    state: State
    report: PhasesReport
    findings: tuple[tuple[str | None, str], ...] = ()


def without_runs(file: Path, state: State, text: str) -> CoverageCheck:
    """Return the result for a file whose runs cannot be made.

    text: the reason as a sentence. It becomes a finding, except for the state "not run".
    """
    findings = () if state == "not run" else ((None, text),)
    return CoverageCheck(file, state, PhasesReport(text, "", {}), findings)


def check_coverage(case: Path, changes: tuple[str, ...] = (), tolerance: int | Tolerance = 0) -> CoverageCheck:
    """Repeat the runs with the worst values of a case's coverage file, and compare the values.

    Worker processes can call this function.

    changes: the "key=value" texts with which the case is read.
    tolerance: the largest allowed difference of times; a number is in SYSCLKOUT cycles of the case's first unit.
    """
    path = coverage_path(case)
    try:
        found = CoverageFile.current(path, case)
    except BadSavedFile as error:
        return without_runs(path, "unreadable", str(error))
    if found is None:
        return without_runs(path, "unreadable", f"{path.as_posix()}: it has been removed during the check")
    file, differences = found
    differences = [f"{change} is set" for change in changes] + differences
    try:
        covered = CoveredCase(Job(str(case), changes, rounds=file.choice.rounds))
    except REFUSED as error:
        return without_runs(path, "changed", f"{path.as_posix()}: its runs cannot be made again: {error}; {RENEW}")
    other = _other_phases(file, covered)
    if other:
        text = f"{path.as_posix()}: its phases are not those of the case now: {other}; {RENEW}"
        return without_runs(path, "changed", text)
    findings = list(_findings(file, covered, path, tolerance))
    findings.sort(key=lambda one: one[0] is not None and not one[1].startswith(f"{one[0]} breaks"))
    report = report_of(path, file, differences)
    state: State = "as saved"
    if findings:
        state = "changed"
        report = PhasesReport(f"{path.as_posix()}: {counted(len(findings), 'difference')} from its values", "", {})
    elif not file.is_complete:
        state = "incomplete"
    elif differences:
        state = "out of date"
        values = counted(len(file.found.worst), "worst value")
        report = replace(report, line=f"{report.line}; its {values} are as saved")
    return CoverageCheck(path, state, report, tuple(findings))


def _other_phases(file: CoverageFile, covered: CoveredCase) -> str:
    """Return how the phases of the case differ from those of the file; "" if they are the same."""
    choice, phases = file.choice, covered.phases
    if choice.moved != phases.moved:
        return f"the starts of {phases.moved} move, and moved those of {choice.moved}"
    cycle = float(phases.seconds(1) * 10**12)
    if choice.cycle_ps != cycle:
        return f"a cycle was {choice.cycle_ps:g} ps, and is {cycle:g} ps"
    return "" if choice.count == phases.count else f"there were {choice.count:,}, and are {phases.count:,}"


def _findings(
    file: CoverageFile, covered: CoveredCase, path: Path, tolerance: int | Tolerance
) -> Iterable[tuple[str | None, str]]:
    """Repeat the runs, and yield the findings. A run that has the worst values of several budgets is repeated once."""
    runs: dict[tuple[tuple[int, ...], int], list[Verdict]] = {}
    for worst in file.found.worst.values():
        runs.setdefault((worst.phases, worst.seed), []).append(worst.verdict)
    allowed = _ticks(covered, tolerance)
    for (phases, seed), saved in runs.items():
        at = phase_text(phases, file.choice)
        try:
            result = covered.scene_of(*covered.phases.inputs(phases), seed).run()
        except REFUSED as error:
            yield None, f"at {at} of {path.as_posix()}, the run is ended: {error}; {RENEW}"
            continue
        if result.stuck and result.verdict == FAIL and not _was_stuck(file, phases):
            yield None, f"at {at} of {path.as_posix()}: {result.stuck[0]}; {RENEW}"
        yield from ((one.name, text) for one in saved if (text := _difference(one, result, at, path, allowed, covered)))


def _was_stuck(file: CoverageFile, phases: Sequence[int]) -> bool:
    """Return True if firmware already hung in the run with these phases when the coverage was saved."""
    alone = file.found.failed.get(phases[0], frozenset()) if len(phases) == 1 else frozenset()
    drifting = (one.names for one in file.found.drifting if (one.first, one.last) == (phases[0], phases[-1]))
    return STUCK in alone.union(*drifting)


def _difference(saved: Verdict, result: Result, at: str, path: Path, allowed: Fraction, covered: CoveredCase) -> str:
    """Return a sentence if a budget is missing, or its measure or value differs, or its verdict is worse; else "".

    allowed: the number of ticks by which times may differ. Other values must be equal.
    """
    now = next((one for one in result.budgets if one.name == saved.name), None)
    if now is None:
        return f"{saved.name}: it is in {path.as_posix()}, but no budget that can be covered; {RENEW}"
    if (saved.measure, saved.unit) != (now.measure, now.unit):
        return f"{saved.name}: {path.as_posix()} has the measure {saved.measure!r}, not {now.measure!r}; {RENEW}"
    fails = (now.broken and not saved.broken) or (saved.passed and not now.passed)
    if not fails and _is_same(saved, now, allowed, covered):
        return ""
    was, came = figure(saved.worst, saved.unit), figure(now.worst, now.unit)
    if was == came and saved.worst != now.worst:
        was, came = f"{saved.worst} {saved.unit}", f"{now.worst} {now.unit}"
    if now.broken:
        return f"{saved.name} breaks at {at}: {broken(now)}; it was {was} in {path.as_posix()}; {RENEW}"
    judged = "" if now.passed else ", which is not judged"
    return f"{saved.name} at {at}: {was} in {path.as_posix()} -> {came}{judged}; {RENEW}"


def _is_same(saved: Verdict, now: Verdict, allowed: Fraction, covered: CoveredCase) -> bool:
    """Return True if two values are equal, or times that differ by at most `allowed` ticks."""
    if saved.worst == now.worst:
        return True
    if saved.worst is None or now.worst is None or now.unit != "us":
        return False
    per_us = Fraction(covered.phases.ticks_per_second, 10**6)
    return abs(round(saved.worst * per_us) - round(now.worst * per_us)) <= allowed


def _ticks(covered: CoveredCase, tolerance: int | Tolerance) -> Fraction:
    """Convert a tolerance to ticks. Cycles are SYSCLKOUT cycles of the case's first unit, as for a baseline."""
    unit = next(iter(covered.case.unit.values()))
    given = Cycles(Fraction(tolerance)) if isinstance(tolerance, int) else tolerance
    return in_seconds(given, Fraction(unit.oscclk) * unit.pll / 2) * covered.phases.ticks_per_second
