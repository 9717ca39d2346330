"""Run case files, in worker processes if there are several jobs, and compare the results with the cases' baselines.

    paths --> cases --> processes --> outcomes --> compared, explained, judged --> CaseCheck
                                                   or written as new baselines
          cases with a coverage file --> processes --> runs of its worst values --> CoverageCheck --^
          proof files --> proven verdicts --^

The order of the results is that of the case files, and does not depend on the number of processes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from difflib import unified_diff
from fractions import Fraction
from pathlib import Path
from typing import Literal, TypeVar

from ....core.input_files import similar_file
from ....core.tolerance import Tolerance, in_cycles
from ....proof.saved_paths import coverage_path
from ....scene.case.discover import cases_below
from ....scene.project import baseline_path
from ....timing.verdict import broken
from ..cluster import ClusterError, ClusterExecutor
from ..coverage_check import CoverageCheck, check_coverage, without_runs
from ..explain.chain import Chain
from ..proofs import NO_PROOF, ProofReport, mark_proven
from .compare import Change, compare, explain, moved_accesses
from .event_chain import EventLine
from .files import BadCheck, Baseline, read, text_of, write_all
from .outcome import Outcome, RejectedCase, occurrence, run_again, run_case
from .workers import Start, workers

T = TypeVar("T")
State = Literal["equal", "changed", "missing", "written"]


@dataclass
class Finding:
    """A reason why `check` fails.

    budget: the name of the budget; None for a finding about the whole case.
    line: the line in the case file, from 1.
    """

    budget: str | None
    line: int
    text: str


@dataclass
class CaseCheck:
    """The result of checking a case.

    state: whether the run equals its baseline or differs from it, or the baseline is missing or has been written.
    changes: the differences between the baseline and the run.
    diff: the change of the baseline file by `--update-baseline` as a unified diff; "" if the file was not changed.
    causes: for each budget that broke unexpectedly, the explanation of its worst occurrence.
    findings: the reasons why the check fails.
    coverage: the result of checking the coverage file of the case; None if there is no such file.
    proof: what the proof file of the case says.
    """

    outcome: Outcome
    baseline: Path
    state: State
    changes: list[Change]
    diff: str = ""
    causes: dict[str, Chain] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    coverage: CoverageCheck | None = None
    proof: ProofReport = NO_PROOF

    @property
    def passed(self) -> bool:
        return not self.findings

    @property
    def proof_line(self) -> str:
        """A sentence about the proof file; "" if there is none, or a finding contains the sentence."""
        return self.proof.line_beside(finding.text for finding in self.findings)


def judge(check: CaseCheck, guaranteed: bool = False) -> list[Finding]:
    """Return all findings of a check. Findings about limits of budgets come first.

    guaranteed: True to add a finding for each budget that holds, but is not proven.
    """
    outcome = check.outcome
    top = outcome.name_line or 1
    findings = []
    for verdict in outcome.verdicts:
        line = outcome.lines[verdict.name] or top
        must = verdict.name in outcome.breaks
        if verdict.broken:
            if not must:
                findings.append(Finding(verdict.name, line, f"{verdict.name} breaks: {broken(verdict)}"))
        elif not verdict.passed:
            why = verdict.found or f"nothing was measured by {verdict.measure!r}"
            findings.append(Finding(verdict.name, line, f"{verdict.name} is not judged: {why}"))
        elif must:
            line = outcome.breaks_line or line
            text = f"{verdict.name} holds, but is listed in breaks; remove it there if the bug is fixed"
            findings.append(Finding(verdict.name, line, text))
    holding = [verdict for verdict in outcome.verdicts if verdict.passed and verdict.name not in outcome.breaks]
    others = check.proof.missing(holding) if guaranteed else []
    others += [(None, text) for text in outcome.trouble]
    if check.state == "missing":
        others.append((None, f"it has no baseline {check.baseline}; write one with --update-baseline"))
    elif check.state == "changed":
        others += [(change.budget, str(change)) for change in check.changes if not change.note]
    others += () if check.coverage is None else check.coverage.findings
    names = [verdict.name for verdict in outcome.verdicts]
    for name, text in others:
        findings.append(Finding(name if name in names else None, outcome.lines.get(name or "", 0) or top, text))
    return findings


STOPPED = "it was not run to its end, because the check was stopped"


def case_files(paths: Iterable[Path | str]) -> list[Path]:
    """Return the case files at these paths, each once, by its first path. A folder is replaced by all cases below it.

    A link to a case is a case of its own, because it has its own name and baseline.

    Raise BadCheck if a path does not exist or a folder contains no case.
    """
    found: dict[Path, Path] = {}  # from each case, as a path without links to folders, to its first path
    for path in map(Path, paths):
        if path.is_dir():
            inside = list(cases_below(path))
            if not inside:
                expected = "expected .toml files with a [unit.NAME], [controller] or [[budget]] table"
                raise BadCheck(f"{path}: it contains no case; {expected}")
        elif path.exists():
            inside = [path]
        else:
            hint = similar_file(path) or "give case files, or folders of them"
            raise BadCheck(f"{path}: there is no such file or folder; {hint}")
        for case in inside:
            found.setdefault(case.parent.resolve() / case.name, case)
    return [*found.values()]


def check(
    paths: Iterable[Path | str],
    *,
    jobs: int | None = None,
    tolerance: int | Tolerance = 0,
    update: bool = False,
    changes: Sequence[str] = (),
    keep_values: bool = False,
    on_progress: Callable[[float], None] | None = None,
    on_refused: Callable[[RejectedCase], None] | None = None,
    cluster: ClusterExecutor | None = None,
    guaranteed: bool = False,
) -> list[CaseCheck]:
    """Run cases and compare them with their baselines.

    jobs: the number of processes; None for one per core. With 1, all cases run in this process.
    tolerance: the largest allowed difference of times: an int or `Cycles` is a number of SYSCLKOUT cycles, a Fraction
        is in seconds.
    update: True to write the figures of all cases as new baselines. If one cannot be written, none is.
    changes: "key=value" texts that are applied to every case, to see their effect.
    keep_values: True to keep the values of budgets in the outcomes.
    on_progress: a function that is called with the completed share, 0 to 1.
    on_refused: a function that is called with each case that cannot be run or compared, or that needs an outside party.
        The other cases continue.
    cluster: the cluster that runs the cases; None for processes of this computer.
    guaranteed: True to require that each budget that holds is proven.

    Raise BadCheck if `on_refused` is None and a case cannot be run or compared or needs an outside party. If `update`
    is True, raise BadCheck if a case cannot be run. A script that calls this function with more than one process needs
    the usual `if __name__ == "__main__":`.
    """
    files = case_files(paths)
    refused: list[RejectedCase] = []
    lost: dict[Path, str] | None = {} if on_refused is not None and not update else None
    before = _baselines(files, None if update else refused)
    ran = _run_each(files, jobs, cluster, changes, keep_values, on_progress, lost)
    refused += [one for one in ran if isinstance(one, RejectedCase)]
    outcomes = [one for one in ran if isinstance(one, Outcome) and one.path in before]
    wrong = [one for one in refused if on_refused is None or not one.outside]
    if wrong and (update or on_refused is None):
        raise BadCheck("\n".join(one.why for one in wrong))
    if on_refused is not None:
        for one in refused:
            on_refused(one)
    checks = [_compared(outcome, before[outcome.path], 0 if update else tolerance) for outcome in outcomes]
    covered = [one for one in checks if coverage_path(one.outcome.path).exists()]
    if lost:
        for one_check in covered:
            file = coverage_path(one_check.outcome.path)
            one_check.coverage = without_runs(file, "not run", f"{file.as_posix()}: {STOPPED}")
    else:
        with workers(jobs, len(files), cluster) as start:
            coverages = [start(check_coverage, one.outcome.path, one.outcome.changes, tolerance) for one in covered]
            _explain(checks, before, start, None if update else tolerance, lost)
            if update:
                _write(checks)
            for one_check, run in zip(covered, coverages, strict=True):
                one_check.coverage = _covered(run, one_check, lost)
    if lost and on_refused is not None:
        for path, why in lost.items():
            on_refused(RejectedCase(path, f"{path}: {why}"))
        checks = [one for one in checks if one.outcome.path not in lost]
    for one_check in checks:
        one_check.proof = mark_proven(one_check.outcome.path, changes, one_check.outcome.verdicts)
        one_check.findings = judge(one_check, guaranteed)
    return checks


def _run_each(
    files: Sequence[Path],
    jobs: int | None,
    cluster: ClusterExecutor | None,
    changes: Sequence[str],
    keep_values: bool,
    on_progress: Callable[[float], None] | None,
    lost: dict[Path, str] | None,
) -> list[Outcome | RejectedCase]:
    """Run each case. Return the results of the finished cases.

    lost: receives each case that was stopped by Ctrl-C, SIGTERM or the loss of the cluster, with the reason; None to
        raise KeyboardInterrupt or ClusterError.
    """
    came: dict[Path, Outcome | RejectedCase] = {}
    try:
        with workers(jobs, len(files), cluster) as start:
            waiting = [(path, start(run_case, path, tuple(changes), keep_values)) for path in files]
            for done, (path, result) in enumerate(waiting, 1):
                try:
                    found = _result(result, path, lost)
                except BadCheck as error:
                    found = RejectedCase(path, str(error))
                if found is not None:
                    came[path] = found
                if on_progress is not None:
                    on_progress(done / len(files))
    except KeyboardInterrupt:
        if lost is None:
            raise
        lost |= {path: STOPPED for path in files if path not in came and path not in lost}
    return [*came.values()]


def _baselines(files: Iterable[Path], refused: list[RejectedCase] | None) -> dict[Path, Baseline | None]:
    """Return a dictionary from each case to its baseline, or to None if the case has no baseline.

    refused: receives each case with an unreadable baseline; None to regard such a baseline as missing.
    """
    found: dict[Path, Baseline | None] = {}
    for path in files:
        try:
            found[path] = read(baseline_path(path))
        except BadCheck as error:
            if refused is None:
                found[path] = None
            else:
                refused.append(RejectedCase(path, str(error)))
    return found


def _compared(outcome: Outcome, baseline: Baseline | None, tolerance: int | Tolerance) -> CaseCheck:
    path = baseline_path(outcome.path)
    if baseline is None:
        return CaseCheck(outcome, path, "missing", [])
    changes = compare(baseline, outcome.figures, _cycles(tolerance, outcome.figures))
    return CaseCheck(outcome, path, _state(changes), changes)


def _cycles(tolerance: int | Tolerance, figures: Baseline) -> Fraction | int:
    """Convert a tolerance to cycles. figures: the figures of the case, with the length of its cycle in ticks."""
    if isinstance(tolerance, int):
        return tolerance
    return in_cycles(tolerance, Fraction(figures.ticks_per_second, figures.ticks_per_cycle))


def _state(changes: list[Change]) -> State:
    return "changed" if any(not change.note for change in changes) else "equal"


def _explain(
    checks: list[CaseCheck],
    before: dict[Path, Baseline | None],
    start: Start,
    tolerance: int | Tolerance | None,
    lost: dict[Path, str] | None,
) -> None:
    """Run cases again, to explain changed figures and budgets that broke unexpectedly.

    The second run of a case also finds accesses that moved without changing a figure. It is skipped if it cannot find
    anything: if the figures and the digest of event times equal those of the baseline, nothing has moved, and if also
    no budget broke unexpectedly, there is nothing to explain.

    before: a dictionary from each case to its baseline, or to None if the case has no baseline.
    tolerance: the largest allowed difference of times (see `check`); None if new baselines are written, which need the
        chains of all budgets.
    lost: receives each case whose run was lost with the cluster, with the reason; None to raise ClusterError.
    """
    runs = [_run_again(one.outcome, before[one.outcome.path], start, tolerance is None) for one in checks]
    for one, run in zip(checks, runs, strict=True):
        baseline = before[one.outcome.path]
        chains, one.causes = (None if run is None else _result(run, one.outcome.path, lost)) or ({}, {})
        one.outcome.figures = one.outcome.figures.with_chains({name: chain.lines for name, chain in chains.items()})
        if chains and baseline is not None and tolerance is not None:
            now = one.outcome.figures.budgets
            worse = {c.budget for c in one.changes if c.budget in now and c.figure == now[c.budget].chain_of}
            allowed = _cycles(tolerance, one.outcome.figures)
            one.changes[:0] = [] if worse else moved_accesses(baseline, one.outcome.figures, chains, allowed)
            one.state = _state(one.changes)
        if baseline is not None:
            explain(one.changes, baseline, one.outcome.figures, one.outcome.result.first_wrong)


def _run_again(
    outcome: Outcome, baseline: Baseline | None, start: Start, every: bool
) -> Callable[[], tuple[dict[str, EventLine], dict[str, Chain]]] | None:
    """Start a run that finds the chains of the budgets in the baseline, and the causes of unexpectedly broken budgets.

    If the run of the outcome certainly has the chains of the baseline (see `Baseline.chains_of`), these chains are
    copied to the outcome. Return a function that waits for the chains and the causes; None if no run is needed.

    every: True to find the chains of all budgets of the case, in the baseline or not.
    """
    kept = None if baseline is None else outcome.figures.chains_of(baseline)
    known = outcome.figures.budgets if every else {} if baseline is None else baseline.budgets
    found = {name: occurrence(figures) for name, figures in outcome.figures.budgets.items() if name in known}
    wanted = {name: one for name, one in found.items() if one is not None}
    if kept is not None:
        outcome.figures, wanted = outcome.figures.with_chains(kept), {}
    broken = [one for one in outcome.verdicts if one.broken and one.name not in outcome.breaks]
    if not wanted and not broken:
        return None
    return start(run_again, outcome.path, outcome.changes, wanted, broken, outcome.typical)


def _covered(run: Callable[[], CoverageCheck], check: CaseCheck, lost: dict[Path, str] | None) -> CoverageCheck | None:
    """Return the result of checking a coverage file; None if the cluster is lost (see `_result`).

    If the process that makes the runs has died, the result has a finding that says so.
    """
    try:
        return _result(run, check.outcome.path, lost)
    except BadCheck as error:
        return without_runs(coverage_path(check.outcome.path), "changed", f"at a phase of its coverage: {error}")


def _result(run: Callable[[], T], case: Path, lost: dict[Path, str] | None) -> T | None:
    """Return the result of a call; None if the cluster that makes it is lost.

    lost: receives the case, with the reason, if the cluster is lost; None to raise ClusterError.
    """
    try:
        return run()
    except ClusterError as error:
        if lost is None:
            raise
        lost[case] = f"{STOPPED}: {error}"
        return None


def _write(checks: list[CaseCheck]) -> None:
    """Write all new baselines, or none if one cannot be written. Set the state and the diff of each check."""
    texts: dict[Path, str] = {}
    for one in checks:
        text = text_of(one.outcome.figures)
        before = one.baseline.read_bytes().decode("utf-8", "replace") if one.baseline.is_file() else ""
        one.state = "equal" if text == before else "written"
        if text != before:
            texts[one.baseline] = text
            name = one.baseline.as_posix()
            ours = before.splitlines(), text.splitlines(), name if before else "nothing", name
            one.diff = "\n".join(unified_diff(*ours, lineterm="", n=1))
    write_all(texts)
