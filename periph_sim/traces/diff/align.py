"""Alignment of two sequences of numbers: what they have in common, as runs in order.

    1 2 3 4 5 6
    1 2 9 4 5 5 6   -->  Run(0, 0, 2) Run(3, 3, 2) Run(5, 6, 1)

The greedy algorithm of Myers (An O(ND) difference algorithm and its variations, 1986) finds the fewest insertions and
deletions, in time that grows with length times differences: a long capture with few differences is quick, also where
it repeats one transfer endlessly, as a polling loop does (difflib's SequenceMatcher is quadratic there). Items that
occur on one side only are removed first. Beyond `MOST_EDITS` differences in one piece the furthest path is kept, and
the search restarts from there: no longer always the fewest, but never quadratic.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

MOST_EDITS = 200
STRIDE = 16  # items that are compared before larger arrays are


class Run(NamedTuple):
    """`length` equal items, from `a` in the first sequence and from `b` in the second."""

    a: int
    b: int
    length: int


def align(a: Sequence[int] | NDArray[np.int64], b: Sequence[int] | NDArray[np.int64]) -> list[Run]:
    """Return the runs that both sequences have in common, in order, none empty, neighbours joined."""
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
    """Align piece by piece, each up to MOST_EDITS differences long."""
    found: list[Run] = []
    x = y = 0
    while x < len(a) and y < len(b):
        runs, to_x, to_y = _piece(a[x:], b[y:])
        found.extend(Run(x + run.a, y + run.b, run.length) for run in runs)
        x, y = x + to_x, y + to_y
    return found


def _piece(a: NDArray[np.int64], b: NDArray[np.int64]) -> tuple[list[Run], int, int]:
    """Return (runs, their extent in a, and in b): to the end, or as far as MOST_EDITS differences lead."""
    reach = {1: 0}  # diagonal x - y -> furthest x on it
    history: list[dict[int, int]] = []
    for edits in range(MOST_EDITS + 1):
        history.append(dict(reach))
        for k in range(-edits, edits + 1, 2):
            x = _step(reach, k, edits)
            y = x - k
            if x > len(a) or y > len(b) or y < 0:
                reach[k] = x  # outside: never continued
                continue
            x += equal_from_start(a[x:], b[y:])
            reach[k] = x
            if x == len(a) and x - k == len(b):
                return _way_back(history, x, x - k), x, x - k
    inside = [(2 * x - k, x, x - k) for k, x in reach.items() if x <= len(a) and 0 <= x - k <= len(b)]
    _, x, y = max(at for at in inside if (at[1] - at[2] - MOST_EDITS) % 2 == 0)
    return _way_back(history, x, y), x, y


def _step(reach: dict[int, int], k: int, edits: int) -> int:
    """Return x where diagonal k is entered: down from k + 1 (an insertion) or right from k - 1 (a deletion)."""
    if k == -edits or (k != edits and reach[k - 1] < reach[k + 1]):
        return reach[k + 1]
    return reach[k - 1] + 1


def _way_back(history: list[dict[int, int]], x: int, y: int) -> list[Run]:
    found: list[Run] = []
    for edits in range(len(history) - 1, -1, -1):
        reach = history[edits]
        k = x - y
        entered = _step(reach, k, edits)
        if x > entered:
            found.append(Run(entered, entered - k, x - entered))
        down = k == -edits or (k != edits and reach[k - 1] < reach[k + 1])
        x = entered if down else entered - 1
        y = x - (k + 1 if down else k - 1)
    return found[::-1]


def equal_from_start(a: NDArray[np.int64], b: NDArray[np.int64]) -> int:
    """Return the number of equal items from the start on."""
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
