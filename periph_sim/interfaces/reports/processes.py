"""Pools of worker processes that have run no case, but have already imported the package.

    first pool --> server, which imports the package and runs no case --fork--> new worker

For many cases, importing the package takes as long as the run. This process cannot be forked, because it may have run
cases and started threads. Windows has no such server, so each worker imports the package there.

No worker outlives its pool. If the `with` block of a pool raises an error or receives Ctrl-C, the workers of the pool
are ended at once. `end_workers` ends the workers of all pools. A worker ends itself when its parent process ends, and
the server ends with the last worker.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_all_start_methods, get_context, parent_process
from signal import SIG_DFL, SIGINT, signal
from threading import Thread

SERVER = "forkserver"
IMPORTED = [
    *("periph_sim.interfaces.reports.baselines.outcome", "periph_sim.interfaces.reports.sweep.runs"),
    "periph_sim.proof.cover",
]
DIED = "its process died before it finished; periph-sim run shows how far it gets"
_pools: set[ProcessPoolExecutor] = set()


@contextmanager
def processes(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Yield a pool of `workers` processes, which have the current environment variables of this process."""
    context = get_context(SERVER if SERVER in get_all_start_methods() else "spawn")
    if context.get_start_method() == SERVER:
        context.set_forkserver_preload(IMPORTED)
    pool = ProcessPoolExecutor(workers, context, initializer=_begin, initargs=(dict(os.environ),))
    _pools.add(pool)
    try:
        yield pool
    except BaseException:
        _end(pool)
        raise
    finally:
        _pools.discard(pool)
        pool.shutdown(cancel_futures=True)


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
    signal(SIGINT, SIG_DFL)
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
