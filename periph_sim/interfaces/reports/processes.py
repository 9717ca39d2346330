"""Pools of worker processes that have run no case, but have already imported the package.

    first pool --> server, which imports the package and runs no case --fork--> new worker

For many cases, importing the package takes as long as the run. The process that uses the pool cannot be forked,
because it may have run cases and started threads. Windows has no such server, so each worker imports the package there.

No worker outlives its pool. If the `with` block of a pool raises an error or receives Ctrl-C, the workers of the pool
are ended at once. `end_workers` ends the workers of all pools. A worker ends itself when its parent process ends, and
the server ends with the last worker.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_all_start_methods, get_context, parent_process
from threading import Thread
from typing import Any, TypeVar, TypeVarTuple

from ...supervisor import STOPPING

T = TypeVar("T")
Ts = TypeVarTuple("Ts")

SERVER = "forkserver"
IMPORTED = [
    *("periph_sim.interfaces.reports.baselines.outcome", "periph_sim.interfaces.reports.sweep.runs"),
    "periph_sim.proof.cover",
]
DIED = "its process died before it finished; periph-sim run shows how far it gets"
CAN_BLOCK = hasattr(signal, "pthread_sigmask")  # Windows has no such function
_pools: set[ProcessPoolExecutor] = set()


class Pool(ProcessPoolExecutor):
    """A pool whose calls start workers while the signals of STOPPING are blocked.

    So the pool knows each of its workers when a signal raises KeyboardInterrupt. The server and the workers inherit the
    block, so Ctrl-C does not end them with a traceback while they start.
    """

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        if not CAN_BLOCK:
            return super().submit(fn, *args, **kwargs)
        before = signal.pthread_sigmask(signal.SIG_BLOCK, _stopping())
        try:
            return super().submit(fn, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _stopping() -> list[signal.Signals]:
    return [signal.Signals[name] for name in STOPPING]


@contextmanager
def processes(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Yield a pool of `workers` processes, which have the current environment variables of this process."""
    context = get_context(SERVER if SERVER in get_all_start_methods() else "spawn")
    if context.get_start_method() == SERVER:
        context.set_forkserver_preload(IMPORTED)
    pool = Pool(workers, context, initializer=_begin, initargs=(dict(os.environ),))
    _pools.add(pool)
    try:
        yield pool
    except BaseException:
        _end(pool)
        raise
    finally:
        _pools.discard(pool)
        pool.shutdown(cancel_futures=True)


def call_alone(work: Callable[[*Ts], T], *arguments: *Ts) -> T:
    """Make a call in a new process, in which nothing was run before. Raise BrokenProcessPool if the process dies."""
    with processes(1) as pool:
        return pool.submit(work, *arguments).result()


def results_of(executor: Executor, work: Callable[[*Ts], T], calls: Iterable[tuple[*Ts]]) -> Iterator[T]:
    """Make calls on an executor, and yield their results in order. calls: the arguments of each call.

    After an error, such as Ctrl-C or the death of a worker, the other calls are cancelled.
    """
    waiting = [executor.submit(work, *call) for call in calls]
    try:
        for future in waiting:
            yield future.result()
    except BaseException:
        for future in waiting:
            future.cancel()
        raise


def end_workers() -> None:
    """End the workers of all pools. A caller that waits for a worker receives BrokenProcessPool."""
    for pool in list(_pools):
        _end(pool)


def _end(pool: ProcessPoolExecutor) -> None:
    for worker in list((pool._processes or {}).values()):
        worker.kill()


def _begin(environment: Mapping[str, str]) -> None:
    """Set up a worker process.

    Ctrl-C ends the worker without a traceback, and garbage collection ignores the imported objects. The output of user
    code goes to standard error, because standard output is reserved for the output of the command.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if CAN_BLOCK:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _stopping())
    sys.stdout = sys.stderr
    Thread(target=_end_with_parent, name="periph-sim parent watch", daemon=True).start()
    gc.freeze()
    os.environ.clear()
    os.environ.update(environment)


def _end_with_parent() -> None:
    """End this worker as soon as the process that uses the worker has ended, even if it was ended by SIGKILL."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
