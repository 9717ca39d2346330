"""Shortest ways from one orbit of states of rest to another. The glossary in `periph_sim.proof` has the terms.

A way is a sequence of steps, each of which leads from one orbit to another. A step is an entry of the table, given by
its tick in `closed_table`, and by its group in `pair_run`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import TypeVar

T = TypeVar("T")


def first_step(ways: Mapping[int, Mapping[int, T]], here: int, is_wanted: Callable[[int], bool]) -> T | None:
    """Return the first step of a shortest way from orbit `here` to another, wanted one; None if there is no way.

    ways: `ways[orbit][after]` is the step that leads from `orbit` directly to `after`.
    is_wanted: a function that returns True for the number of a wanted orbit.
    """
    first: dict[int, T] = {}
    waiting = deque([here])
    while waiting:
        orbit = waiting.popleft()
        for after, step in ways.get(orbit, {}).items():
            if after not in first and after != here:
                first[after] = first.get(orbit, step)
                if is_wanted(after):
                    return first[after]
                waiting.append(after)
    return None
