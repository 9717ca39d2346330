"""Processes that begin as fresh ones, but with the package imported: a number of workers goes in, a pool comes out.

    first pool --> server, which imports the package and runs no case --fork--> worker, as if just started

Importing takes as long as many a case. A fork of this process would not do: it has run cases, and may have threads.
Where there is no such server, on Windows, workers import what they need.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_all_start_methods, get_context
from signal import SIG_DFL, SIGINT, signal

SERVER = "forkserver"
IMPORTED = ["periph_sim.reports.baselines.outcome", "periph_sim.reports.sweep.one_run"]


def processes(workers: int) -> ProcessPoolExecutor:
    """So many processes, with this one's environment as it is now."""
    context = get_context(SERVER if SERVER in get_all_start_methods() else "spawn")
    if context.get_start_method() == SERVER:
        context.set_forkserver_preload(IMPORTED)
    return ProcessPoolExecutor(workers, context, initializer=_begin, initargs=(dict(os.environ),))


def _begin(environment: Mapping[str, str]) -> None:
    """In a worker: Ctrl-C ends it without a traceback; what it has imported is never looked through for garbage.

    What user code prints goes to standard error: standard output is the command's.
    """
    signal(SIGINT, SIG_DFL)
    sys.stdout = sys.stderr
    gc.freeze()
    os.environ.clear()
    os.environ.update(environment)
