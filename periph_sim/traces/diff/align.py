"""Alignment of two sequences of numbers. The result is the items that both have in common, as runs in order.

A run is a series of successive items that are equal in both sequences.

    1 2 3 4 5 6
    1 2 9 4 5 5 6   -->  Run(0, 0, 2) Run(3, 3, 2) Run(5, 6, 1)

The greedy algorithm of Myers (An O(ND) difference algorithm and its variations, 1986) finds the fewest insertions and
deletions. Its time grows with the product of the length and the number of differences, so long captures with few
differences are aligned quickly. This also holds if a polling loop repeats one transfer many times. The time of
difflib's SequenceMatcher would be quadratic then. Items that occur in only one sequence are removed first. After
`MOST_EDITS` differences, the path that reached furthest is kept, and the search restarts from the end of this path.
Then the number of differences is not always the smallest, but the time is never quadratic.

Among several equal items, times decide which item is missing:

    A   poll 0  poll 10  poll 20  poll 30      without times: the last poll is missing, and two polls are 10 late
    B   poll 0           poll 20  poll 30      with times: the second poll is missing, and no poll is late

A gap between two runs contains items of only one sequence, or of both. If items repeat, a gap in one sequence can be
moved without changing the number of equal items. The gap is placed where the lateness (the time in B minus the time
in A) changes least from item to item.
If a gap consists of repetitions of the same items, each repetition is a gap of its own, which is placed separately.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.int64]

MOST_EDITS = 200
STRIDE = 16  # number of items that `equal_from_start` compares at first; each later comparison has four times as many


class Run(NamedTuple):
    """Equal items: `length` items from index `a` in the first sequence and from index `b` in the second."""

    a: int
    b: int
    length: int


def numbered(a: Iterable[Hashable], b: Iterable[Hashable]) -> tuple[Numbers, Numbers]:
    """Return a number for each item of both sequences. Equal items have equal numbers."""
    numbers: dict[Hashable, int] = {}
    left = [numbers.setdefault(item, len(numbers)) for item in a]
    right = [numbers.setdefault(item, len(numbers)) for item in b]
    return np.array(left, np.int64), np.array(right, np.int64)


def align(a: Sequence[int] | NDArray[np.int64], b: Sequence[int] | NDArray[np.int64]) -> list[Run]:
    """Return the runs that both sequences have in common, in order. No run is empty, and adjacent runs are merged."""
    left, right = np.asarray(a, np.int64), np.asarray(b, np.int64)
    head = equal_from_start(left, right)
    tail = equal_from_start(left[head:][::-1], right[head:][::-1])
    mid_left, mid_right = left[head : len(left) - tail], right[head : len(right) - tail]
    kept_left = np.flatnonzero(np.isin(mid_left, mid_right))
    kept_right = np.flatnonzero(np.isin(mid_right, mid_left))
    runs = [Run(0, 0, head)]
    for run in _middle(mid_left[kept_left], mid_right[kept_right]):
        for at_a, at_b in zip(
            kept_left[run.a : run.a + run.length].tolist(),
            kept_right[run.b : run.b + run.length].tolist(),
            strict=True,
        ):
            runs.append(Run(head + at_a, head + at_b, 1))
    runs.append(Run(len(left) - tail, len(right) - tail, tail))
    return _joined(runs)


def _middle(a: NDArray[np.int64], b: NDArray[np.int64]) -> list[Run]:
    """Align two sequences piece by piece. Each piece has at most MOST_EDITS differences."""
    found: list[Run] = []
    x = y = 0
    while x < len(a) and y < len(b):
        runs, to_x, to_y = _piece(a[x:], b[y:])
        found.extend(Run(x + run.a, y + run.b, run.length) for run in runs)
        x, y = x + to_x, y + to_y
    return found


def _piece(a: NDArray[np.int64], b: NDArray[np.int64]) -> tuple[list[Run], int, int]:
    """Align the first piece of two sequences. Return its runs and the numbers of items of `a` and `b` that it covers.

    The piece covers all items, or as many as a path with MOST_EDITS differences can reach. A path at (x, y) has covered
    x items of `a` and y items of `b`, and is then on the diagonal x - y.
    """
    reach = {1: 0}  # a dictionary from each diagonal to the furthest x that was reached on this diagonal
    history: list[dict[int, int]] = []
    for edits in range(MOST_EDITS + 1):
        history.append(dict(reach))
        for k in range(-edits, edits + 1, 2):
            x, _ = _step(reach, k, edits)
            y = x - k
            if x > len(a) or y > len(b) or y < 0:
                reach[k] = x  # the end of a sequence is passed, so no path continues on this diagonal
                continue
            x += equal_from_start(a[x:], b[y:])
            reach[k] = x
            if x == len(a) and x - k == len(b):
                return _way_back(history, x, x - k), x, x - k
    inside = [(2 * x - k, x, x - k) for k, x in reach.items() if x <= len(a) and 0 <= x - k <= len(b)]
    _, x, y = max(at for at in inside if (at[1] - at[2] - MOST_EDITS) % 2 == 0)
    return _way_back(history, x, y), x, y


def _step(reach: dict[int, int], k: int, edits: int) -> tuple[int, int]:
    """Return the x at which a path with `edits` differences enters diagonal k, and the diagonal from which it comes.

    reach: the furthest x on each neighbouring diagonal with one difference less. Of two paths, the one that reaches
    further is chosen. A path comes from diagonal k + 1 by an insertion, or from diagonal k - 1 by a deletion.
    """
    if k == -edits or (k != edits and reach[k - 1] < reach[k + 1]):
        return reach[k + 1], k + 1
    return reach[k - 1] + 1, k - 1


def _way_back(history: list[dict[int, int]], x: int, y: int) -> list[Run]:
    found: list[Run] = []
    for edits in range(len(history) - 1, -1, -1):
        reach = history[edits]
        k = x - y
        entered, came = _step(reach, k, edits)
        if x > entered:
            found.append(Run(entered, entered - k, x - entered))
        x = entered if came > k else entered - 1
        y = x - came
    return found[::-1]


def equal_from_start(a: NDArray[np.int64], b: NDArray[np.int64]) -> int:
    """Return the number of equal items at the start of both arrays."""
    length = min(len(a), len(b))
    done, stride = 0, STRIDE
    while done < length:
        end = min(done + stride, length)
        differ = a[done:end] != b[done:end]
        if differ.any():
            return done + int(differ.argmax())
        done, stride = end, 4 * stride
    return length


def _joined(runs: list[Run]) -> list[Run]:
    found: list[Run] = []
    for run in runs:
        if not run.length:
            continue
        last = found[-1] if found else None
        if last is not None and last.a + last.length == run.a and last.b + last.length == run.b:
            found[-1] = Run(last.a, last.b, last.length + run.length)
        else:
            found.append(run)
    return found


Times = NDArray[np.float64]  # used only to choose between alignments; reported times are exact


def place_by_time(runs: Sequence[Run], a: Numbers, b: Numbers, time_a: Times, time_b: Times) -> list[Run]:
    """Return the runs after the gaps between them are moved to the places where times fit best.

    a, b: the items of both sequences.
    time_a, time_b: the time of each item of `a` and of `b`, in the same unit.
    """
    edges = _split([Run(0, 0, 0), *runs, Run(len(a), len(b), 0)], a, b)
    for before, after in pairwise(edges):
        gap_a = after[0] - before[0] - before[2]
        gap_b = after[1] - before[1] - before[2]
        if not gap_a and gap_b:
            moved = _moved(before, after, gap_b, 1, b, time_a, time_b)
        elif gap_a and not gap_b:
            moved = _moved(before, after, gap_a, 0, a, time_b, time_a)
        else:
            continue
        before[2] += moved
        after[0] += moved
        after[1] += moved
        after[2] -= moved
    return [Run(*run) for run in edges if run[2]]


def _split(runs: list[Run], a: Numbers, b: Numbers) -> list[list[int]]:
    """Return the runs, each as a list [a, b, length].

    If a gap consists of repetitions of the same items, empty runs are inserted, so that each repetition is a gap.
    """
    found: list[list[int]] = []
    for before, after in pairwise(runs):
        found.append(list(before))
        end_a, end_b = before.a + before.length, before.b + before.length
        if end_a == after.a:
            step = _period(b[end_b : after.b])
            found.extend([end_a, at, 0] for at in range(end_b + step, after.b, step))
        elif end_b == after.b:
            step = _period(a[end_a : after.a])
            found.extend([at, end_b, 0] for at in range(end_a + step, after.a, step))
    return [*found, list(runs[-1])]


def _period(items: Numbers) -> int:
    """Return the length of the shortest part whose repetition gives all items; 1 if there are no items."""
    size = len(items)
    return next((n for n in range(1, size) if not size % n and np.array_equal(items[n:], items[:-n])), max(size, 1))


def _moved(
    before: list[int], after: list[int], gap: int, long: int, items: Numbers, time_short: Times, time_long: Times
) -> int:
    """Return by how many items the gap between two runs moves towards later items; negative: towards earlier items.

    before, after: the runs before and after the gap, each as a list [a, b, length].
    gap: the number of items in the gap.
    long: 0 if the items of the gap are in A, 1 if they are in B.
    items, time_long: the items and times of the sequence that has the items of the gap.
    time_short: the times of the other sequence.
    """
    end = before[long] + before[2]  # index of the first item of the gap
    left = equal_from_start(items[end - before[2] : end][::-1], items[end - before[2] + gap : end + gap][::-1])
    right = equal_from_start(items[end : end + after[2]], items[end + gap : end + gap + after[2]])
    if not left and not right:
        return 0
    # If possible, one more item is included on each side. Its lateness does not depend on the place of the gap.
    first, last = min(left + 1, before[2]), min(right + 1, after[2])
    place = np.arange(-first, last)
    short = time_short[before[1 - long] + before[2] + place]
    early = time_long[end + place] - short  # lateness of each item if the gap is after this item
    late = time_long[end + gap + place] - short  # lateness of each item if the gap is before this item
    nothing = np.zeros(1)
    until = np.concatenate((nothing, nothing, np.cumsum(np.abs(np.diff(early)))))[: len(place) + 1]
    since = np.concatenate((np.cumsum(np.abs(np.diff(late))[::-1])[::-1], nothing, nothing))[: len(place) + 1]
    across = np.concatenate((nothing, np.abs(late[1:] - early[:-1]), nothing))
    cost = until + since + across
    allowed = cost[first - left : first + right + 1]
    best = len(allowed) - 1 - int(allowed[::-1].argmin())  # the last place with the lowest cost
    return best - left
