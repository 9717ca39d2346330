"""Calls for case files, each in a process of its own if there are several, and several at a time.

call --> thread, if one of `jobs` is free --> new process --> result, or BadCheck if the process died
"""

from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol, TypeVar, TypeVarTuple

from ..cluster import ClusterExecutor, worker_pool
from ..processes import DIED, call_alone, end_workers
from .files import BadCheck

T = TypeVar("T")
Ts = TypeVarTuple("Ts")


class Start(Protocol):
    """A function that starts a call, possibly in another process. It returns a function that waits for the result."""

    def __call__(self, work: Callable[[Path, *Ts], T], path: Path, *rest: *Ts) -> Callable[[], T]: ...


@contextmanager
def workers(jobs: int | None, calls: int, cluster: ClusterExecutor | None = None) -> Iterator[Start]:
    """Yield a function that starts calls, each in a process of its own.

    jobs: the maximum number of calls at a time; None for one per core. With one job, or at most one call, the calls run
        in this process, when their results are requested.
    cluster: the cluster that makes the calls instead; None for processes of this computer.
    """
    if cluster is not None:

        def afar(work: Callable[[Path, *Ts], T], path: Path, *rest: *Ts) -> Callable[[], T]:
            future = cluster.submit_alone(work, path, *rest)
            return lambda: _unless_died(path, future.result)

        with worker_pool(1, cluster):
            yield afar
        return
    if jobs == 1 or calls <= 1:

        def here(work: Callable[[Path, *Ts], T], path: Path, *rest: *Ts) -> Callable[[], T]:
            return lambda: work(path, *rest)

        yield here
        return
    gc.collect()  # deletes earlier scenes now, because a thread of the pool must not stop their firmware
    with ThreadPoolExecutor(min(jobs or os.cpu_count() or 1, calls)) as threads:

        def there(work: Callable[[Path, *Ts], T], path: Path, *rest: *Ts) -> Callable[[], T]:
            return threads.submit(lambda: _unless_died(path, lambda: call_alone(work, path, *rest))).result

        try:
            yield there
        except BaseException:  # if a case cannot be run, or after Ctrl-C, the other calls are cancelled
            threads.shutdown(wait=False, cancel_futures=True)
            end_workers()
            raise


def _unless_died(path: Path, result: Callable[[], T]) -> T:
    """Return the result of a call for a case. Raise BadCheck if the process of the call died."""
    try:
        return result()
    except BrokenProcessPool:
        raise BadCheck(f"{path}: {DIED}") from None
