"""One piece of work goes in; how long it took, by the clock on the wall and by the processor's, comes out."""

from __future__ import annotations

import gc
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import perf_counter, process_time
from typing import TypeVar

T = TypeVar("T")


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
