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
from fractions import Fraction
from pathlib import Path
from typing import Any

from ....core.settings import duration
from ....scene.case.load import UnknownKey, load
from ....scene.case.model import BadCase, Case
from ....scene.firmware_loader import Firmware
from ..processes import processes
from .columns import Sweep, sweep_of
from .one_run import ERROR, Job, Row, rows_of
from .plan import Changes, runs_of, texts_of

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


DIED = "its process died before it finished; periph-sim run shows how far it gets"
NO_WORKER = (
    "no process can be started for the runs: a script that calls sweep needs `if __name__ == '__main__':` around what "
    "it does, since each process imports it; or give jobs=1"
)
