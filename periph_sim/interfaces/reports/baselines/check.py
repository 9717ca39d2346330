"""Run case files, each in a process of its own, and compare them with their baselines.

    paths --> cases --> processes --> outcomes --> compared, explained, judged --> CaseCheck
                                                   or written as new baselines

Results are in the order of the files' names, for any number of processes.
"""

from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from difflib import unified_diff
from pathlib import Path
from typing import Protocol, TypeVar, TypeVarTuple

from ....scene.case.discover import cases_below
from ..processes import end_workers, processes
from .compare import Change, compare, explain, moved_accesses
from .event_chain import EventLine, Wanted
from .files import BadCheck, Baseline, Figures, path_for, read, text_of, write_all
from .judge import CaseCheck, State, judge
from .outcome import Chains, Outcome, RejectedCase, occurrence, run_case, run_chains, run_explained

T = TypeVar("T")
Ts = TypeVarTuple("Ts")

STOPPED = "it was not run to its end, because the check was stopped"


def case_files(paths: Iterable[Path | str]) -> list[Path]:
    """Return the case files of paths; for a folder all below it; each once. Raise BadCheck if there are none."""
    found: dict[Path, None] = {}
    for path in map(Path, paths):
        if path.is_dir():
            inside = list(cases_below(path))
            if not inside:
                expected = "expected .toml files with a [unit.NAME], [controller] or [[budget]] table"
                raise BadCheck(f"{path}: it contains no case; {expected}")
            found |= dict.fromkeys(inside)
        elif path.exists():
            found[path] = None
        else:
            raise BadCheck(f"{path}: there is no such file or folder; give case files, or folders of them")
    return list(found)


def check(
    paths: Iterable[Path | str],
    *,
    jobs: int | None = None,
    tolerance: int = 0,
    update: bool = False,
    changes: Sequence[str] = (),
    keep_values: bool = False,
    on_progress: Callable[[float], None] | None = None,
    on_refused: Callable[[RejectedCase], None] | None = None,
) -> list[CaseCheck]:
    """Run cases and compare them. jobs: processes, one per core if None; 1 runs all in this process.

    tolerance: cycles by which times may differ. update: write the figures as new baselines, all or none.
    changes: "key=value" texts applied to every case, to see their effect. keep_values: keep values in the outcomes.
    on_progress: called with the part done, 0 to 1. on_refused: called with each case that cannot be run or compared, or
    needs an outside party; the others continue.
    Raise BadCheck for such cases if on_refused is None, and always if baselines are to be written: all or none. A
    script that calls this with more than one process needs the usual `if __name__ == "__main__":`.
    """
    files = case_files(paths)
    refused: list[RejectedCase] = []
    before = {} if update else _baselines(files, refused)
    ran, stopped = _run_each(
        files, jobs, changes, keep_values, on_progress, keep_finished=on_refused is not None and not update
    )
    refused += [one for one in ran if isinstance(one, RejectedCase)]
    outcomes = [one for one in ran if isinstance(one, Outcome) and (update or one.path in before)]
    wrong = [one for one in refused if on_refused is None or not one.outside]
    if wrong and (update or on_refused is None):
        raise BadCheck("\n".join(one.why for one in wrong))
    if on_refused is not None:
        for one in refused:
            on_refused(one)
    checks = [] if update else [_compared(outcome, before[outcome.path], tolerance) for outcome in outcomes]
    if not stopped:
        with workers(jobs, len(files)) as start:
            if update:
                checks = _updated(outcomes, start)
                _find_causes(checks, start)
                return checks
            _explain(checks, before, start, tolerance)
            _find_causes(checks, start)
    for one_check in checks:
        one_check.findings = judge(one_check)
    return checks


def _run_each(
    files: Sequence[Path],
    jobs: int | None,
    changes: Sequence[str],
    keep_values: bool,
    on_progress: Callable[[float], None] | None,
    *,
    keep_finished: bool,
) -> tuple[list[Outcome | RejectedCase], bool]:
    """Run each case. Return the results and whether Ctrl-C or SIGTERM stopped it; unfinished cases are rejected.

    keep_finished: False raises KeyboardInterrupt instead.
    """
    came: dict[Path, Outcome | RejectedCase] = {}
    try:
        with workers(jobs, len(files)) as start:
            waiting = [(path, start(run_case, path, tuple(changes), keep_values)) for path in files]
            for done, (path, result) in enumerate(waiting, 1):
                try:
                    came[path] = result()
                except BadCheck as error:
                    came[path] = RejectedCase(path, str(error))
                if on_progress is not None:
                    on_progress(done / len(files))
    except KeyboardInterrupt:
        if not keep_finished:
            raise
    stopped = [path for path in files if path not in came]
    return [*came.values(), *(RejectedCase(path, f"{path}: {STOPPED}") for path in stopped)], bool(stopped)


def _baselines(files: Iterable[Path], refused: list[RejectedCase]) -> dict[Path, Baseline | None]:
    """Read the baseline of each case; add cases whose baseline cannot be read to `refused`."""
    found: dict[Path, Baseline | None] = {}
    for path in files:
        try:
            found[path] = read(path_for(path))
        except BadCheck as error:
            refused.append(RejectedCase(path, str(error)))
    return found


def _compared(outcome: Outcome, baseline: Baseline | None, tolerance: int) -> CaseCheck:
    path = path_for(outcome.path)
    if baseline is None:
        return CaseCheck(outcome, path, "missing", [])
    changes = compare(baseline, outcome.figures, tolerance)
    return CaseCheck(outcome, path, _state(changes), changes)


def _state(changes: list[Change]) -> State:
    return "changed" if any(not change.note for change in changes) else "equal"


class Start(Protocol):
    """Starts a call, perhaps in another process; returns a function that waits for its result."""

    def __call__(self, work: Callable[[Path, *Ts], T], path: Path, *rest: *Ts) -> Callable[[], T]: ...


def _explain(checks: list[CaseCheck], before: dict[Path, Baseline | None], start: Start, tolerance: int) -> None:
    """Run cases again to explain changed figures, and to find accesses that moved without changing a figure.

    A run ends after the last occurrence whose chain is needed. If the figures and the digest of event times equal those
    of the baseline, nothing can have moved, and the run is skipped.
    """
    runs: list[Callable[[], Chains] | None] = []
    for one in checks:
        baseline = before[one.outcome.path]
        kept = None if baseline is None else one.outcome.figures.chains_of(baseline)
        if kept is not None:
            one.outcome.figures = one.outcome.figures.with_chains(kept)
            runs.append(None)
            continue
        known = set(baseline.budgets) & set(one.outcome.figures.budgets) if baseline is not None else set()
        wanted = _wanted(one.outcome, known)
        runs.append(start(run_chains, one.outcome.path, one.outcome.changes, wanted) if wanted else None)
    for one, run in zip(checks, runs, strict=True):
        baseline = before[one.outcome.path]
        if baseline is not None:
            now = one.outcome.figures.budgets
            worse = {c.budget for c in one.changes if c.budget is not None and _is_worst(c, now.get(c.budget))}
            if run is not None:
                chains = run().of
                one.outcome.figures = one.outcome.figures.with_chains(_lines(chains))
                others = {name: chain for name, chain in chains.items() if name not in worse}
                moved = [] if worse else moved_accesses(baseline, one.outcome.figures, others, tolerance)
                one.changes[:0] = moved
                one.state = _state(one.changes)
            explain(one.changes, baseline, one.outcome.figures, one.outcome.result.first_wrong)


def _find_causes(checks: list[CaseCheck], start: Start) -> None:
    """Run cases with unexpectedly broken budgets again, to find the causes."""
    runs = []
    for one in checks:
        outcome = one.outcome
        broken = one.broken
        runs.append(start(run_explained, outcome.path, outcome.changes, broken, outcome.typical) if broken else None)
    for one, run in zip(checks, runs, strict=True):
        one.causes = run() if run is not None else {}


def _is_worst(change: Change, figures: Figures | None) -> bool:
    return figures is not None and change.figure == figures.chain_of


def _updated(outcomes: list[Outcome], start: Start) -> list[CaseCheck]:
    """Write new baselines, once all are complete."""
    runs = []
    for outcome in outcomes:
        baseline = _old(path_for(outcome.path))
        kept = None if baseline is None else outcome.figures.chains_of(baseline)
        if kept is not None:
            outcome.figures = outcome.figures.with_chains(kept)
        wanted = _wanted(outcome, set(outcome.figures.budgets)) if kept is None else {}
        runs.append(start(run_chains, outcome.path, outcome.changes, wanted) if wanted else None)
    checks = []
    texts: dict[Path, str] = {}
    for outcome, run in zip(outcomes, runs, strict=True):
        if run is not None:
            outcome.figures = outcome.figures.with_chains(_lines(run().of))
        path = path_for(outcome.path)
        text = text_of(outcome.figures)
        old = path.read_bytes().decode("utf-8", "replace") if path.is_file() else ""
        one = CaseCheck(outcome, path, "equal" if text == old else "written", [])
        if text != old:
            texts[path] = text
            one.diff = _diff(path, old, text)
            one.changes = _changes_since(path, outcome)
        checks.append(one)
    write_all(texts)
    for one in checks:
        one.findings = judge(one)
    return checks


def _old(path: Path) -> Baseline | None:
    """Read the baseline to be replaced; None if it is missing, damaged or of another version."""
    try:
        return read(path)
    except BadCheck:
        return None


def _changes_since(path: Path, outcome: Outcome) -> list[Change]:
    baseline = _old(path)
    if baseline is None:
        return []
    changes = compare(baseline, outcome.figures)
    explain(changes, baseline, outcome.figures, outcome.result.first_wrong)
    return changes


def _diff(path: Path, old: str, new: str) -> str:
    name = path.as_posix()
    lines = unified_diff(old.splitlines(), new.splitlines(), name if old else "nothing", name, lineterm="", n=1)
    return "\n".join(lines)


def _wanted(outcome: Outcome, names: set[str]) -> dict[str, Wanted]:
    found = {name: occurrence(figures) for name, figures in outcome.figures.budgets.items() if name in names}
    return {name: one for name, one in found.items() if one is not None}


def _lines(chains: dict[str, EventLine]) -> dict[str, list[str]]:
    return {name: chain.lines for name, chain in chains.items()}


@contextmanager
def workers(jobs: int | None, calls: int) -> Iterator[Start]:
    """Yield a function that starts calls, `jobs` at a time (None: one per core), each in a process of its own.

    One job, or a single call: in this process.
    """
    if jobs == 1 or calls == 1:

        def here(work: Callable[[Path, *Ts], T], path: Path, *rest: *Ts) -> Callable[[], T]:
            return lambda: work(path, *rest)

        yield here
        return
    gc.collect()  # firmware of earlier runs must be stopped by the thread that ran it, not by one of these
    with ThreadPoolExecutor(min(jobs or os.cpu_count() or 1, calls)) as threads:

        def there(work: Callable[[Path, *Ts], T], path: Path, *rest: *Ts) -> Callable[[], T]:
            return threads.submit(lambda: _apart(work, path, *rest)).result

        try:
            yield there
        except BaseException:  # a case that cannot be run, or Ctrl-C: cancel the rest
            threads.shutdown(wait=False, cancel_futures=True)
            end_workers()
            raise


def _apart(work: Callable[[Path, *Ts], T], path: Path, *rest: *Ts) -> T:
    """Make the call in a fresh process, so that firmware of one case cannot affect another."""
    with processes(1) as process:
        try:
            return process.submit(work, path, *rest).result()
        except BrokenProcessPool:
            what = "its process died before it finished; periph-sim run shows how far it gets"
            raise BadCheck(f"{path}: {what}") from None
