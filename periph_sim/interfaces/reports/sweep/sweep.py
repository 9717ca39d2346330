"""Run a case many times with changes and return the figures of all runs as arrays.

    runs --some at a time--> Executor --> Rows, in the order of the runs --> Sweep

Any `concurrent.futures.Executor` works: threads, processes, a cluster; by default our own processes.
"""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, fields
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.settings import duration
from ....scene.case.load import UnknownKey, load
from ....scene.case.model import BadCase, Case
from ....scene.firmware_loader import Firmware
from ....timing.verdict import Verdict
from ..processes import DIED, processes
from .one_run import ERROR, Job, Row, rows_of
from .plan import Changes, runs_of, texts_of

Column = NDArray[Any]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class BudgetColumns:
    """A budget's figures, one entry per run, as in a `Verdict`. If a run has none: NaN, "", and -1 for the count.

    unit: of worst, limit and margin: "us", "%", "LSB", or what is counted. verdict: "pass", "broken", "not judged".
    """

    measure: str
    unit: str
    worst: Floats
    limit: Floats
    margin: Floats
    at_s: Floats
    count: NDArray[np.int64]
    verdict: NDArray[np.str_]


@dataclass(frozen=True)
class Sweep:
    """The result of a sweep: arrays with one entry per run, in the order of the changes.

    changes: by key, the value set in each run; "" if unchanged. verdict: "pass", "fail", "not judged", or
    "error" if a run failed, with the reason in `error`.
    wire_bytes: on the I2C bus. sci_bytes: sent to SCIs of units; sci_bytes_sent: sent by them.
    budgets: by name. counts: by name, -1 in runs without it.
    """

    case: str
    changes: Mapping[str, Column]
    verdict: NDArray[np.str_]
    error: NDArray[np.str_]
    simulated_s: Floats
    wire_bytes: NDArray[np.int64]
    sci_bytes: NDArray[np.int64]
    sci_bytes_sent: NDArray[np.int64]
    events: NDArray[np.int64]
    budgets: Mapping[str, BudgetColumns]
    counts: Mapping[str, NDArray[np.int64]]

    def __len__(self) -> int:
        return len(self.verdict)

    @property
    def worst(self) -> dict[str, Floats]:
        """The worst value of each budget, by its name."""
        return {name: budget.worst for name, budget in self.budgets.items()}

    def columns(self) -> dict[str, Column]:
        """Return one table by column name, for example for pandas.DataFrame or a CSV file."""
        table: dict[str, Column] = {**self.changes, "verdict": self.verdict, "error": self.error}
        for name, budget in self.budgets.items():
            figures = {one.name: getattr(budget, one.name) for one in fields(budget)[2:]}
            table |= {f"{name}: {figure}": column for figure, column in figures.items()}
        table |= {"I2C bytes": self.wire_bytes, "SCI bytes": self.sci_bytes}
        table["SCI bytes from units"] = self.sci_bytes_sent
        return table | dict(self.counts)


def sweep_of(case: str, runs: Sequence[Mapping[str, object]], rows: Sequence[Row]) -> Sweep:
    """Build the columns from the rows of these runs."""
    keys = dict.fromkeys(key for run in runs for key in run)
    names = dict.fromkeys(verdict.name for row in rows for verdict in row.budgets)
    counts = dict.fromkeys(name for row in rows for name in row.counts)
    by_name = [{verdict.name: verdict for verdict in row.budgets} for row in rows]
    return Sweep(
        case=case,
        changes={key: _numbers_or_texts([run.get(key, "") for run in runs]) for key in keys},
        verdict=_texts(row.verdict for row in rows),
        error=_texts(row.error for row in rows),
        simulated_s=np.array([row.simulated_s for row in rows], dtype=np.float64),
        wire_bytes=_whole(row.wire_bytes for row in rows),
        sci_bytes=_whole(row.sci_bytes for row in rows),
        sci_bytes_sent=_whole(row.sci_bytes_sent for row in rows),
        events=_whole(row.events for row in rows),
        budgets={name: _budget([verdicts.get(name) for verdicts in by_name]) for name in names},
        counts={name: _whole(row.counts.get(name, -1) for row in rows) for name in counts},
    )


def _budget(verdicts: Sequence[Verdict | None]) -> BudgetColumns:
    first = next(verdict for verdict in verdicts if verdict is not None)

    def figures(of: Callable[[Verdict], float | int | None]) -> Floats:
        found = [None if verdict is None else of(verdict) for verdict in verdicts]
        return np.array([np.nan if value is None else value for value in found], dtype=np.float64)

    return BudgetColumns(
        measure=first.measure,
        unit=first.unit,
        worst=figures(lambda verdict: verdict.worst),
        limit=figures(lambda verdict: verdict.limit),
        margin=figures(lambda verdict: verdict.margin),
        at_s=figures(lambda verdict: verdict.at_s),
        count=_whole(-1 if verdict is None else verdict.count for verdict in verdicts),
        verdict=_texts("" if verdict is None else _word(verdict) for verdict in verdicts),
    )


def _word(verdict: Verdict) -> str:
    return verdict.verdict if verdict.passed else verdict.word


def _texts(values: Any) -> NDArray[np.str_]:
    return np.array(list(values), dtype=np.str_)


def _whole(values: Any) -> NDArray[np.int64]:
    return np.array(list(values), dtype=np.int64)


def _numbers_or_texts(values: list[object]) -> Column:
    """Return numbers if all values are numbers, else texts."""
    plain = [value.item() if hasattr(value, "item") else value for value in values]
    kinds = {type(value) for value in plain}
    if kinds <= {int, float} or kinds == {bool}:
        return np.array(plain)
    return _texts(str(value) for value in plain)


AT_A_TIME = 8  # runs sent to a worker together: sending costs as much as a short run
FEW = 64  # up to this many runs are sent one by one, so all workers get some

Program = Callable[[Any, Any], None]


class SweepStopped(KeyboardInterrupt):
    """A sweep was stopped by Ctrl-C or SIGTERM. finished: the completed runs, of `runs` in all."""

    def __init__(self, finished: Sweep, runs: int) -> None:
        super().__init__(f"the sweep was stopped after {len(finished)} of {runs} runs")
        self.finished = finished
        self.runs = runs


Texts = list[list[str]]


def sweep(
    case: str | Path,
    changes: Changes,
    *,
    seconds: str | Fraction | None = None,
    programs: Mapping[str, Program | Firmware] | None = None,
    jobs: int | None = None,
    executor: Executor | None = None,
    on_progress: Callable[[float], None] | None = None,
) -> Sweep:
    """Run a case once for each change. Return one column per figure, one entry per run.

    case: its file. changes: `{key: values}` for every combination, or a list of runs: `{key: value}` or "key=value"
    texts as for `--set`. seconds: instead of the case's own duration. programs: firmware given as functions, by
    unit; workers import them by name, so they must be in a module.

    jobs: processes of our own, one per core if None; 1: all in this process. executor: any of
    `concurrent.futures` instead, which stays open; its workers see the case under the same path. Rows, their order and
    their figures are the same for any choice. on_progress: called with the part done, 0 to 1, in this thread.

    Raise BadCase for a change that names no key, and if no run succeeded; else the row of a failed run says
    why. SweepStopped, a KeyboardInterrupt, has the runs completed before Ctrl-C or SIGTERM. A script
    that calls this with more than one process needs the usual `if __name__ == "__main__":`.
    """
    if isinstance(case, Case):
        raise BadCase("a sweep changes keys of a file; give the path of the case, or write one")
    if executor is not None and jobs is not None:
        raise BadCase(f"jobs={jobs} with an executor, which has its own workers; give only one of them")
    if jobs is not None and jobs < 1:
        raise BadCase(f"jobs={jobs}: expected 1 or more")
    try:
        length = None if seconds is None else duration(seconds)
    except ValueError as error:
        raise BadCase(f"seconds={seconds!r}: {error}") from None
    runs = runs_of(changes)
    texts = [texts_of(run) for run in runs]
    name = _check(Path(case), texts, programs or {})
    firmware = {unit: p if isinstance(p, Firmware) else Firmware(unit, p, None) for unit, p in (programs or {}).items()}
    job = Job(str(Path(case).absolute()), str(case), length, firmware)
    workers = min(jobs or os.cpu_count() or 1, len(runs))
    if executor is None and workers > 1:
        _check_sent(firmware)
    rows: list[Row] = []
    try:
        for some in _made(job, texts, executor, workers):
            rows += some
            if on_progress is not None:
                on_progress(len(rows) / len(runs))
    except KeyboardInterrupt:
        if not rows:
            raise
        raise SweepStopped(sweep_of(name, runs[: len(rows)], rows), len(runs)) from None
    if all(row.verdict == ERROR for row in rows):
        raise BadCase(rows[0].error)
    return sweep_of(name, runs, rows)


def _check(file: Path, texts: Texts, programs: Iterable[str]) -> str:
    """Return the case's name. Raise BadCase for an unknown key or unit; a wrong value is reported in its row."""
    case = load(file)
    for unit in programs:
        if unit not in case.unit:
            raise BadCase(f"programs: case {case.name} has no unit {unit!r}; it has {', '.join(case.unit) or 'none'}")
    seen: set[tuple[str, ...]] = set()
    for changes in texts:
        keys = tuple(change.partition("=")[0] for change in changes)
        if keys not in seen:
            seen.add(keys)
            try:
                load(file, changes)
            except UnknownKey:
                raise
            except BadCase:
                pass
    return case.name


def _check_sent(firmware: Mapping[str, Firmware]) -> None:
    """Raise BadCase for functions that other processes cannot import by name."""
    for unit, program in firmware.items():
        try:
            pickle.dumps(program)
        except Exception as error:
            what = "define it in a module, not in another function, or give jobs=1"
            raise BadCase(f"programs: {unit!r} cannot be sent to another process; {what} ({error})") from None


def _made(job: Job, texts: Texts, executor: Executor | None, jobs: int) -> Iterator[list[Row]]:
    """Yield the rows, several at a time, in the order of the texts."""
    size = AT_A_TIME if len(texts) > FEW else 1
    parts = [texts[first : first + size] for first in range(0, len(texts), size)]
    if executor is not None:
        yield from _by(executor, job, parts)
    elif jobs == 1:
        for part in parts:
            yield rows_of(job, part)
    else:
        yield from _by_processes(job, parts, jobs)


def _by(executor: Executor, job: Job, parts: Sequence[Texts]) -> Iterator[list[Row]]:
    waiting = [executor.submit(rows_of, job, part) for part in parts]
    try:
        for future in waiting:
            yield future.result()
    except BaseException:  # Ctrl-C, or a worker that died: cancel the rest
        for future in waiting:
            future.cancel()
        raise


def _by_processes(job: Job, parts: Sequence[Texts], jobs: int) -> Iterator[list[Row]]:
    """Like `_by`, in processes of this package. If a process dies, its unfinished runs are repeated one by one."""
    done = 0
    while done < len(parts):
        with processes(jobs) as pool:
            try:
                for rows in _by(pool, job, parts[done:]):
                    yield rows
                    done += 1
                return
            except BrokenProcessPool:
                if not _begins():
                    raise BadCase(NO_WORKER) from None
        yield [row for text in parts[done] for row in _apart(job, text)]
        done += 1


def _apart(job: Job, text: list[str]) -> list[Row]:
    with processes(1) as pool:
        try:
            return pool.submit(rows_of, job, [text]).result()
        except BrokenProcessPool:
            return [Row(ERROR, DIED)]


def _begins() -> bool:
    """Return True if a process can start: it imports the running script, which may start itself again."""
    with processes(1) as pool:
        try:
            return pool.submit(os.getpid).result() > 0
        except BrokenProcessPool:
            return False


NO_WORKER = (
    "no process can be started for the runs: a script that calls sweep needs `if __name__ == '__main__':` around what "
    "it does, since each process imports it; or give jobs=1"
)
