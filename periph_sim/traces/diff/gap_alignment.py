"""Selection, by time, of the missing item among several with equal words.

    A   poll 0  poll 10  poll 20  poll 30      by words alone: the last one is missing, two are 10 late
    B   poll 0           poll 20  poll 30      by time: the second is missing, nothing is late

A gap between two runs can be at any place as long as the items between are repetitions. It is placed where
lateness changes least from item to item. A gap of several equal items is several gaps, each with its own place.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .align import Run, equal_from_start

Numbers = NDArray[np.int64]
Times = NDArray[np.float64]  # only for the choice; reported times are exact


def place_by_time(runs: Sequence[Run], a: Numbers, b: Numbers, time_a: Times, time_b: Times) -> list[Run]:
    """Return the runs with their gaps moved to where times fit best. Times of each item, in one unit."""
    edges = _split([Run(0, 0, 0), *runs, Run(len(a), len(b), 0)], a, b)
    for before, behind in pairwise(edges):
        gap_a = behind[0] - before[0] - before[2]
        gap_b = behind[1] - before[1] - before[2]
        if not gap_a and gap_b:
            moved = _moved(before, behind, gap_b, 1, b, time_a, time_b)
        elif gap_a and not gap_b:
            moved = _moved(before, behind, gap_a, 0, a, time_b, time_a)
        else:
            continue
        before[2] += moved
        behind[0] += moved
        behind[1] += moved
        behind[2] -= moved
    return [Run(*run) for run in edges if run[2]]


def _split(runs: list[Run], a: Numbers, b: Numbers) -> list[list[int]]:
    """Return the runs as lists, with an empty one wherever a gap repeats itself."""
    found: list[list[int]] = []
    for before, behind in pairwise(runs):
        found.append(list(before))
        end_a, end_b = before.a + before.length, before.b + before.length
        if end_a == behind.a:
            step = _period(b[end_b : behind.b])
            found.extend([end_a, at, 0] for at in range(end_b + step, behind.b, step))
        elif end_b == behind.b:
            step = _period(a[end_a : behind.a])
            found.extend([at, end_b, 0] for at in range(end_a + step, behind.a, step))
    return [*found, list(runs[-1])]


def _period(items: Numbers) -> int:
    """Return the shortest length, a divisor of the whole, after which the items repeat."""
    size = len(items)
    return next((n for n in range(1, size) if not size % n and np.array_equal(items[n:], items[:-n])), max(size, 1))


def _moved(
    before: list[int], behind: list[int], gap: int, long: int, items: Numbers, time_short: Times, time_long: Times
) -> int:
    """Return the items by which the gap moves right (or left). long: 1 if B has the gap's items, 0 if A has."""
    end = before[long] + before[2]  # first item of the gap
    left = equal_from_start(items[end - before[2] : end][::-1], items[end - before[2] + gap : end + gap][::-1])
    right = equal_from_start(items[end : end + behind[2]], items[end + gap : end + gap + behind[2]])
    if not left and not right:
        return 0
    # One more item on each side, if there is one: its lateness is known.
    first, last = min(left + 1, before[2]), min(right + 1, behind[2])
    place = np.arange(-first, last)
    short = time_short[before[1 - long] + before[2] + place]
    early = time_long[end + place] - short  # paired as before the gap
    late = time_long[end + gap + place] - short  # and as after it
    nothing = np.zeros(1)
    until = np.concatenate((nothing, nothing, np.cumsum(np.abs(np.diff(early)))))[: len(place) + 1]
    since = np.concatenate((np.cumsum(np.abs(np.diff(late))[::-1])[::-1], nothing, nothing))[: len(place) + 1]
    across = np.concatenate((nothing, np.abs(late[1:] - early[:-1]), nothing))
    cost = until + since + across
    allowed = cost[first - left : first + right + 1]
    best = len(allowed) - 1 - int(allowed[::-1].argmin())  # the last of equal ones
    return best - left
