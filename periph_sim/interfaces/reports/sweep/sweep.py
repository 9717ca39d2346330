"""Run a case many times with changes and return the figures of all runs as arrays.

    runs --some at a time--> Executor --> Rows, in the order of the runs --> Sweep

Any `concurrent.futures.Executor` can be used: threads, processes, a cluster. The default is a pool of worker processes
(see `processes`).
"""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, fields
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....scene.case.load import UnknownKey, load
from ....scene.case.model import BadCase, Case
from ....scene.firmware_loader import Firmware
from ....scene.prepared import Program, length_and_firmware
from ....scene.result import Result
from ....timing.verdict import FAIL, Verdict
from ..cluster import ClusterError, ClusterExecutor, worker_pool
from ..processes import DIED, call_alone, results_of
from .runs import Changes, Job, Row, rows_of, runs_of, texts_of

NO_RESULT = Result("", "error", 0.0, 0.0, 0, 0, 0, [], {}, [], [], [])  # the result of a run that could not be made
Column = NDArray[Any]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class BudgetColumns:
    """The figures of a budget as in a `Verdict`, in arrays with one entry per run.

    If a run has no figure, the entry is NaN for a float, -1 for the count, and "" for the verdict.

    unit: the unit of worst, limit and margin: "us", "%", "LSB", or the name of what is counted.
    verdict: "pass", "broken" or "not judged".
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

    changes: a dictionary from changed keys to their values in all runs; "" for a run that does not change the key.
    verdict: "pass", "fail", "not judged", or "error" if the run could not be made.
    error: the reason why the run could not be made, or "stuck: " and the reason why a failed run got stuck; or "".
    wire_bytes: the number of bytes on the I2C bus, as `Result.wire_bytes`.
    sci_bytes: the number of bytes that the SCIs of units received.
    sci_bytes_sent: the number of bytes that the SCIs of units sent.
    budgets: a dictionary from the names of budgets to their figures.
    counts: a dictionary from names to other counts; -1 for a run without this count.
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
        """A dictionary from the names of budgets to their worst values."""
        return {name: budget.worst for name, budget in self.budgets.items()}

    def columns(self) -> dict[str, Column]:
        """Return a dictionary from names to columns, for example for pandas.DataFrame or a CSV file.

        It has all columns except `simulated_s` and `events`.
        """
        table: dict[str, Column] = {**self.changes, "verdict": self.verdict, "error": self.error}
        for name, budget in self.budgets.items():
            figures = {one.name: getattr(budget, one.name) for one in fields(budget)[2:]}
            table |= {f"{name}: {figure}": column for figure, column in figures.items()}
        table |= {"I2C bytes": self.wire_bytes, "SCI bytes": self.sci_bytes}
        table["SCI bytes from units"] = self.sci_bytes_sent
        return table | dict(self.counts)


def sweep_of(case: str, runs: Sequence[Mapping[str, object]], rows: Sequence[Row]) -> Sweep:
    """Build the columns of a sweep. runs: a dictionary from keys to values for each run. rows: the row of each run."""
    keys = dict.fromkeys(key for run in runs for key in run)
    results = [row if isinstance(row, Result) else NO_RESULT for row in rows]
    names = dict.fromkeys(verdict.name for one in results for verdict in one.budgets)
    counts = dict.fromkeys(name for one in results for name in one.counts)
    by_name = [{verdict.name: verdict for verdict in one.budgets} for one in results]
    return Sweep(
        case=case,
        changes={key: _numbers_or_texts([run.get(key, "") for run in runs]) for key in keys},
        verdict=_texts(one.verdict for one in results),
        error=_texts(_error(row) for row in rows),
        simulated_s=np.array([one.simulated_s for one in results], dtype=np.float64),
        wire_bytes=_whole(one.wire_bytes for one in results),
        sci_bytes=_whole(one.sci_bytes for one in results),
        sci_bytes_sent=_whole(one.sci_bytes_sent for one in results),
        events=_whole(one.events for one in results),
        budgets={name: _budget([verdicts.get(name) for verdicts in by_name]) for name in names},
        counts={name: _whole(one.counts.get(name, -1) for one in results) for name in counts},
    )


def _error(row: Row) -> str:
    if isinstance(row, str):
        return row
    return f"stuck: {'; '.join(row.stuck)}" if row.stuck and row.verdict == FAIL else ""


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
        verdict=_texts("" if one is None else one.verdict if one.passed else one.word for one in verdicts),
    )


def _texts(values: Any) -> NDArray[np.str_]:
    return np.array(list(values), dtype=np.str_)


def _whole(values: Any) -> NDArray[np.int64]:
    return np.array(list(values), dtype=np.int64)


def _numbers_or_texts(values: list[object]) -> Column:
    """Return a column of numbers or booleans if all values are of this kind; otherwise a column of texts."""
    plain = [value.item() if hasattr(value, "item") else value for value in values]
    kinds = {type(value) for value in plain}
    if kinds <= {int, float} or kinds == {bool}:
        return np.array(plain)
    return _texts(str(value) for value in plain)


AT_A_TIME = 8  # number of runs that are sent to a worker together, because sending takes as long as a short run
FEW = 64  # if a sweep has at most this number of runs, they are sent one by one, so that all workers receive some


class SweepStopped(KeyboardInterrupt):
    """Raised after Ctrl-C or SIGTERM, or if a cluster is lost.

    finished: the figures of the completed runs. runs: the number of all runs. The message has the argument `reason`,
        which is "" after Ctrl-C or SIGTERM.
    """

    def __init__(self, finished: Sweep, runs: int, reason: str = "") -> None:
        text = f"the sweep was stopped after {len(finished)} of {runs} runs"
        super().__init__(f"{text}: {reason}" if reason else text)
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
    """Run a case once for each change. Return a column for each figure, with one entry per run.

    case: the case file.
    changes: `{key: values}` for all combinations, or a list of runs. A run is `{key: value}`, or "key=value" texts as
        for `--set`.
    seconds: the duration of each run; None for the duration that the case states.
    programs: a dictionary from units to firmware that is given as functions. Worker processes import the functions by
        name, so the functions must be defined in a module.
    jobs: the number of worker processes; None for one per core. With 1, all runs are made in this process.
    executor: an executor of `concurrent.futures` to use in place of these processes. It is not closed. Its workers must
        find the case under the same path. The result does not depend on `jobs` and `executor`.
    on_progress: a function that is called with the completed share, 0 to 1, in this thread.

    Raise BadCase if a change names no key of the case, or if no run could be made. If only some runs could not be made,
    the result has the reasons. After Ctrl-C, SIGTERM or the loss of a cluster, raise SweepStopped, a KeyboardInterrupt,
    with the completed runs; if there is none, raise KeyboardInterrupt or ClusterError. A script that calls this
    function with more than one process needs the usual `if __name__ == "__main__":`.
    """
    if isinstance(case, Case):
        raise BadCase("a sweep changes keys of a file; give the path of the case, or write one")
    if executor is not None and jobs is not None:
        raise BadCase(f"jobs={jobs} with an executor, which has its own workers; give only one of them")
    if jobs is not None and jobs < 1:
        raise BadCase(f"jobs={jobs}: expected 1 or more")
    runs = runs_of(changes)
    texts = [texts_of(run) for run in runs]
    loaded = _loaded(Path(case), texts)
    length, firmware = length_and_firmware(loaded, seconds, programs)
    job = Job(str(Path(case).absolute()), str(case), length, firmware)
    workers = min(jobs or os.cpu_count() or 1, len(runs))
    if executor is None and workers > 1:
        _check_sent(firmware)
    rows: list[Row] = []
    try:
        for some in row_batches(job, texts, executor, workers):
            rows += some
            if on_progress is not None:
                on_progress(len(rows) / len(runs))
    except (KeyboardInterrupt, ClusterError) as error:
        if not rows:
            raise
        reason = str(error) if isinstance(error, ClusterError) else ""
        raise SweepStopped(sweep_of(loaded.name, runs[: len(rows)], rows), len(runs), reason) from None
    if isinstance(rows[0], str) and not any(isinstance(row, Result) for row in rows):
        raise BadCase(rows[0])
    return sweep_of(loaded.name, runs, rows)


def _loaded(file: Path, texts: Texts) -> Case:
    """Return the case. Raise BadCase for an unknown key, or if the case without changes is invalid.

    A wrong value is not reported here, but in the row of its run.
    """
    case = load(file)
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
    return case


def _check_sent(firmware: Mapping[str, Firmware]) -> None:
    """Raise BadCase for functions that other processes cannot import by name."""
    for unit, program in firmware.items():
        try:
            pickle.dumps(program)
        except Exception as error:
            what = "define it in a module, not in another function, or give jobs=1"
            raise BadCase(f"programs: {unit!r} cannot be sent to another process; {what} ({error})") from None


def row_batches(job: Job, texts: Texts, executor: Executor | None, jobs: int) -> Iterator[list[Row]]:
    """Execute the runs. Yield lists of rows, in the order of the runs.

    jobs: the number of worker processes if `executor` is None. With 1, all runs are made in this process.
    """
    size = AT_A_TIME if len(texts) > FEW else 1
    parts = [texts[first : first + size] for first in range(0, len(texts), size)]
    if executor is None and jobs == 1:
        yield from (rows_of(job, part) for part in parts)
    elif executor is None or isinstance(executor, ClusterExecutor):
        yield from _by_processes(job, parts, jobs, executor)
    else:
        yield from results_of(executor, rows_of, [(job, part) for part in parts])


def _by_processes(job: Job, parts: Sequence[Texts], jobs: int, cluster: ClusterExecutor | None) -> Iterator[list[Row]]:
    """Execute the parts in worker processes, or on a cluster. Yield the rows of each part, in the order of the parts.

    If a process dies, the runs of the first unfinished part are repeated one by one, so that only a run that ends its
    process is lost.
    """
    done = 0
    while done < len(parts):
        with worker_pool(jobs, cluster) as pool:
            try:
                for rows in results_of(pool, rows_of, [(job, part) for part in parts[done:]]):
                    yield rows
                    done += 1
                return
            except BrokenProcessPool:
                if cluster is None and not _begins():
                    raise BadCase(NO_WORKER) from None
        yield [row for text in parts[done] for row in _apart(job, text, cluster)]
        done += 1


def _apart(job: Job, text: list[str], cluster: ClusterExecutor | None) -> list[Row]:
    with worker_pool(1, cluster) as pool:
        try:
            return pool.submit(rows_of, job, [text]).result()
        except BrokenProcessPool:
            return [DIED]


def _begins() -> bool:
    """Return True if a worker process can start.

    A worker imports the running script. If the import itself starts workers, the worker cannot start.
    """
    try:
        return call_alone(os.getpid) > 0
    except BrokenProcessPool:
        return False


NO_WORKER = (
    "no process can be started for the runs: a script that calls sweep needs `if __name__ == '__main__':` around what "
    "it does, since each process imports it; or give jobs=1"
)
