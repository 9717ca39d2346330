"""Wall time and CPU time of a piece of work."""

from __future__ import annotations

import gc
import resource
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import Any, TypeVar

T = TypeVar("T")

STATUS = Path("/proc/self/status")


@dataclass(frozen=True)
class Seconds:
    """wall: the time a user waits. cpu: the time this process used; far less than wall if other processes ran, too."""

    wall: float
    cpu: float


def timed(work: Callable[[], T]) -> tuple[T, Seconds]:
    """Return the result of `work` and its duration. Garbage of earlier work is collected before."""
    gc.collect()
    wall, cpu = perf_counter(), process_time()
    result = work()
    return result, Seconds(perf_counter() - wall, process_time() - cpu)


def middle(times: list[Seconds]) -> Seconds:
    """Return the median of each clock separately."""
    return Seconds(median(t.wall for t in times), median(t.cpu for t in times))


def median_of(count: int, work: Callable[[], T]) -> tuple[T, Seconds]:
    """Return the last result and the median time of `count` runs of `work`."""
    results, times = zip(*(timed(work) for _ in range(count)), strict=True)
    return results[-1], middle(list(times))


def spent(command: Sequence[str], **how: Any) -> Seconds:
    """Return the duration of one process, whose output is discarded. `how` is for `subprocess.run`."""
    before, wall = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True, **how)
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter() - wall
    return Seconds(wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def peak_mib() -> float:
    """Return the peak memory of this process. The value of getrusage includes that of the parent before the fork."""
    lines = STATUS.read_text("ascii").splitlines() if STATUS.exists() else []
    peak = [line.split()[1] for line in lines if line.startswith("VmHWM")]
    return int(peak[0] if peak else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss) / 1024
