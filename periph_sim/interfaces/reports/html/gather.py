"""Collect a case's report from a run's Result and Values, and one more run for the worst occurrences.

case, Result, typical --explain--> timelines, explanations        --> CaseReport
Result, Values --------------------> distributions, limits, facts --^
"""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from ....core.phrases import counted
from ....scene.case.load import load
from ....scene.case.model import Case
from ....scene.case.unit_table import Unit
from ....scene.result import SKIPPED, Result
from ....timing.budget_schema import Budget, Condition
from ....timing.budgets import Values
from ....timing.verdict import Verdict, figure, percentile
from ..explain.chain import Chain
from ..explain.explain import Explained, explain
from ..explain.window import Window
from .distribution import Distribution, distribution
from .failure import Failure, failure
from .over_time import OverTime, over_time, shown_violations
from .timeline import MOST, Lanes, Timeline, only_chosen

if TYPE_CHECKING:
    from ..coverage_line import PhasesReport

Standing = Literal["good", "known", "bad"]


@dataclass(frozen=True)
class BudgetReport:
    """The report of one budget.

    limits: key and text of each limit.
    source: the source of the limit, as the case states it.
    must_break: True if the case says that the budget breaks.
    distribution, over_time: None if no values were kept, for example if the budget has a single number per run.
    timeline: the timeline around the worst value; None if the worst value has no instant.
    explanation: the explanation of the worst value; None if the worst value has no instant, and for a replay.
    failure: a description of the failure, also of one that the case expects; None if the budget holds as it should.
    per_second: the number of ticks per second.
    others: more occurrences beyond a limit, in order of time: for each, its instant in ticks from the start of the run,
        and its timeline.
    at_phases: the worst value at the phases of the coverage file, and its phase as text; None if no file matches.
    """

    verdict: Verdict
    limits: tuple[tuple[str, str], ...]
    source: str
    must_break: bool
    distribution: Distribution | None
    timeline: Timeline | None
    explanation: Chain | None
    failure: Failure | None = None
    over_time: OverTime | None = None
    per_second: int = 10**9
    others: tuple[tuple[int, Timeline], ...] = ()
    at_phases: tuple[Verdict, str] | None = None

    @property
    def as_it_should_be(self) -> bool:
        return self.verdict.broken if self.must_break else self.verdict.passed

    @property
    def failed_at(self) -> float:
        """The time of the first value beyond a limit, in seconds from the start of the run; infinite if unknown."""
        if self.over_time is not None and self.over_time.violations:
            return self.over_time.violations[0][0] / self.per_second
        return inf if self.verdict.at_s is None else self.verdict.at_s


@dataclass(frozen=True)
class CaseReport:
    """The report of one case.

    verdict: "pass" or "fail".
    standing: "good" if the case passes, "known" if exactly the budgets in its `breaks` fail, else "bad".
    commit: the commit of the case's repository; "" if there is none.
    clocks: each unit and its SYSCLKOUT as text.
    findings: errors that are not described in the `failure` of a budget.
    options: the options for undocumented behaviour that the run used, as UNIT.GROUP.NAME or CHIP.NAME.
    changes: the "key=value" texts with which the case was read.
    counts: a dictionary from names to counts of the run, such as bytes on the bus.
    coverage: what the coverage file of the case says; None if there is no file.
    proof: what the proof file of the case says; "" if there is no file.
    """

    name: str
    about: str
    verdict: str
    standing: Standing
    simulated_s: float
    wall_s: float
    clocks: tuple[tuple[str, str], ...]
    options: tuple[str, ...]
    changes: tuple[str, ...]
    counts: dict[str, int]
    findings: tuple[str, ...]
    notes: tuple[str, ...]
    budgets: tuple[BudgetReport, ...]
    commit: str = ""
    coverage: PhasesReport | None = None
    proof: str = ""


MOST_OF_PASSED = 3_000  # maximum number of events in the timeline of a budget without failure
GIT_SECONDS = 5  # maximum time in seconds that git may take
MOST_OF_OTHERS = 1_500  # maximum number of events in the timeline of a further occurrence beyond a limit


def case_report(
    case: Case,
    result: Result,
    values: Sequence[Values | None],
    typical: Sequence[Verdict],
    per_second: int,
    length: Fraction | None = None,
    changes: Sequence[str] = (),
    findings: Sequence[str] | None = None,
    coverage: PhasesReport | None = None,
    proof: str = "",
) -> CaseReport:
    """Return the report of a case that has been run.

    result: the result of the run.
    values: the values of each budget, in the order of the budgets.
    typical: the least critical occurrence of each budget that has several, as verdicts (see `Scene.typical`).
    per_second: the number of ticks per second.
    length: the duration of the run in seconds; None for the duration that the case states.
    changes: the "key=value" texts with which the case was read.
    findings: the findings of `periph-sim check`; the case passes if the list is empty. None without a check; the case
        then passes if the run passes.
    coverage: what the coverage file of the case says; None if there is no file.
    proof: what the proof file of the case says; "" if there is no file.

    Raise the errors of a Scene and its run.
    """
    judged = result.verdict if findings is None else "fail" if findings else "pass"
    end = _ticks(result.simulated_s, per_second)
    overs = [
        None if kept is None else over_time(kept, verdict, end)
        for verdict, kept in zip(result.budgets, values, strict=True)
    ]
    found = explain(case, [*result.budgets, *_others(case, per_second, result.budgets, overs)], typical, length)
    at_phases = {} if coverage is None else coverage.worst
    budgets = [
        replace(_budget(case, per_second, budget, verdict, kept, over, found), at_phases=at_phases.get(verdict.name))
        for budget, verdict, kept, over in zip(case.budget, result.budgets, values, overs, strict=True)
    ]
    failed = {verdict.name for verdict in result.budgets if not verdict.passed}
    over = {verdict.name for verdict in result.budgets if verdict.broken}
    as_said = bool(case.breaks) and failed == over == set(case.breaks) and not result.stuck
    devices = tuple(f"{name}, " for name in (*case.chip, *case.device))  # notes that begin with these names come first
    return CaseReport(
        name=case.name,
        about=case.about,
        verdict=judged,
        standing="good" if judged == "pass" else "known" if findings is None and as_said else "bad",
        simulated_s=result.simulated_s,
        wall_s=result.wall_s,
        clocks=tuple((name, f"{float(sysclk(unit) / 1_000_000):.9g} MHz") for name, unit in case.unit.items()),
        options=tuple(result.unknowns),
        changes=tuple(changes),
        counts={name.replace("_", " "): count for name, count in result.counts.items() if count and name != SKIPPED}
        | {"I2C bytes": result.wire_bytes, "SCI bytes": result.sci_bytes}
        | ({"SCI bytes from units": result.sci_bytes_sent} if result.sci_bytes_sent else {})
        | {f"SCI {error}s": count for error, count in result.sci_errors.items()},
        findings=tuple(_beside_failures(_found(result) if findings is None else findings, budgets)),
        notes=tuple(sorted(result.notes, key=lambda note: not note.startswith(devices))),
        budgets=tuple(budgets),
        commit=commit_of(case.folder),
        coverage=coverage,
        proof=proof,
    )


def report_of_file(
    path: Path,
    changes: tuple[str, ...],
    result: Result,
    values: Sequence[Values | None],
    typical: Sequence[Verdict],
    per_second: int,
    findings: Sequence[str],
    coverage: PhasesReport | None = None,
    proof: str = "",
) -> CaseReport:
    """Return the report of a case file that was run for the duration that it states. Worker processes can call this."""
    case = load(path, list(changes))
    return case_report(case, result, values, typical, per_second, None, changes, findings, coverage, proof)


def _others(
    case: Case, per_second: int, verdicts: Sequence[Verdict], overs: Sequence[OverTime | None]
) -> list[Verdict]:
    """Return the further occurrences beyond the limits of broken budgets that get a timeline, as verdicts.

    The worst value and the instant of such a verdict are those of the occurrence. Budgets that the case expects to
    break are left out.
    """
    found = []
    for verdict, over in zip(verdicts, overs, strict=True):
        if over is None or not verdict.broken or verdict.name in case.breaks or verdict.at_s is None:
            continue
        size = {"us": 1_000_000 / per_second, "LSB": 1e-6}.get(verdict.unit, 1)  # converts values to verdict.unit
        shown = shown_violations(over, _ticks(verdict.at_s, per_second))
        found += [replace(verdict, worst=value * size, at_s=at / per_second) for at, value in shown]
    return found


def _budget(
    case: Case,
    per_second: int,
    budget: Budget,
    verdict: Verdict,
    values: Values | None,
    over: OverTime | None,
    found: Sequence[Explained],
) -> BudgetReport:
    """Return the report of a budget. found: the explanations of all budgets; those of worst occurrences come first."""
    must_break = verdict.name in case.breaks
    own = [one for one in found if one.window.verdict.name == verdict.name]
    worst, others = (own[0] if own else None), own[1:]
    wrong = failure(verdict, must_break, None if worst is None else worst.chain, over, per_second)
    most = MOST_OF_PASSED if wrong is None else MOST
    return BudgetReport(
        verdict=verdict,
        limits=tuple(_limits(budget, verdict)),
        source=budget.source,
        must_break=must_break,
        distribution=None if values is None else distribution(values, per_second // 10**9),
        timeline=None if worst is None else lanes_of(case, worst.window, most).timeline(),
        explanation=None if worst is None else worst.chain,
        failure=wrong,
        over_time=over,
        per_second=per_second,
        others=tuple(
            (
                _ticks(one.window.verdict.at_s, per_second),
                only_chosen(lanes_of(case, one.window, MOST_OF_OTHERS).timeline()),
            )
            for one in others
        ),
    )


def lanes_of(case: Case, window: Window, most: int = MOST) -> Lanes:
    """Return the builder of the timeline of a window, which shows at most `most` records."""
    per_second = window.timebase.per_second
    return Lanes(window, {name: float(per_second / sysclk(unit)) for name, unit in case.unit.items()}, most)


def _ticks(seconds: float | None, per_second: int) -> int:
    return round((seconds or 0) * per_second)


def _limits(budget: Budget, verdict: Verdict) -> list[tuple[str, str]]:
    """Return the key and the text of each limit.

    For the limit that the verdict names, the text is the number with which the worst value was compared. For other
    limits, it is the limit as the case states it. If the budget has further conditions (key `and`), each key begins
    with the measure to which its limit applies.
    """
    found = []
    parts: list[Budget | Condition] = [budget, *budget.also]
    for part in parts:
        of = f"{part.measure} " if budget.also else ""
        for key, given in part.limits().items():
            nearest = (part.measure, key) == (verdict.measure, verdict.which)
            text = figure(verdict.limit, verdict.unit) if nearest else f"{given}"
            found.append((f"{of}{percentile(key)}", text))
    return found


def _found(result: Result) -> list[str]:
    found = [f"{verdict.name}: {verdict.found}" for verdict in result.budgets if verdict.found]
    found += [f"first wrong: {result.first_wrong}"] if result.first_wrong else []
    found += [f"wrong: {place}, {counted(times, 'time')}" for place, times in result.wrong.items()]
    return found + [f"stuck: {line}" for line in result.stuck]


def _beside_failures(findings: Sequence[str], budgets: Sequence[BudgetReport]) -> list[str]:
    """Return the findings that the `failure` of a budget does not describe."""
    names = [one.verdict.name for one in budgets if one.failure is not None]
    known = tuple(f"{name}{rest}" for name in names for rest in (" breaks: ", " is not judged: ", " holds, but ", ": "))
    return [text for text in findings if not text.startswith(known)]


def sysclk(unit: Unit) -> Fraction:
    return Fraction(unit.oscclk) * unit.pll / 2 * (1 + Fraction(unit.ppm) / 10**6)


def commit_of(folder: Path) -> str:
    """Return the commit of a folder, such as "1a2b3c4d5e6f"; "" if there is no repository, commit or git.

    If tracked files differ from the commit, the text ends in ", and uncommitted changes".
    """
    commit = _git(folder, "rev-parse", "--short=12", "HEAD")
    if not commit:
        return ""
    return (
        f"{commit}, and uncommitted changes"
        if _git(folder, "status", "--porcelain", "--untracked-files=no")
        else commit
    )


def _git(folder: Path, *command: str) -> str:
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *command],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=GIT_SECONDS,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip()
