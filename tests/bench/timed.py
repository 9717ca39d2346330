"""One piece of work goes in; how long it took, by the clock on the wall and by the processor's, comes out."""

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
    """wall: what a user waits. cpu: what this process used of it; far less than wall says that others ran, too."""

    wall: float
    cpu: float


def timed(work: Callable[[], T]) -> tuple[T, Seconds]:
    """What `work` returned, and how long it took. Rubbish of earlier work is cleared away first."""
    gc.collect()
    wall, cpu = perf_counter(), process_time()
    result = work()
    return result, Seconds(perf_counter() - wall, process_time() - cpu)


def middle(times: list[Seconds]) -> Seconds:
    """The median of each clock by itself."""
    return Seconds(median(t.wall for t in times), median(t.cpu for t in times))


def median_of(count: int, work: Callable[[], T]) -> tuple[T, Seconds]:
    """The last result and the median time of `count` runs of `work`."""
    results, times = zip(*(timed(work) for _ in range(count)), strict=True)
    return results[-1], middle(list(times))


def spent(command: Sequence[str], **how: Any) -> Seconds:
    """Return the duration of one process, whose output is discarded. how: further arguments of `subprocess.run`."""
    before, wall = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True, **how)
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter() - wall
    return Seconds(wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def peak_mib() -> float:
    """The most memory that this process had: what getrusage says of it begins with what its parent had."""
    lines = STATUS.read_text("ascii").splitlines() if STATUS.exists() else []
    told = [line.split()[1] for line in lines if line.startswith("VmHWM")]
    return int(told[0] if told else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss) / 1024
