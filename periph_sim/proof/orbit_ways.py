"""Shortest ways from one orbit of states of rest to another. `closed_table` defines these terms.

A way is a sequence of steps, each of which leads from one orbit to another. The module `closed_table` uses the ticks of
entries as steps. The module `pair_run` uses groups (`pair_groups.Group`) as steps.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import TypeVar

T = TypeVar("T")


def first_step(ways: Mapping[int, Mapping[int, T]], here: int, is_wanted: Callable[[int], bool]) -> T | None:
    """Return the first step of a shortest way from an orbit to a wanted one; None if there is no way.

    ways: `ways[orbit][after]` is the step that leads from `orbit` directly to `after`.
    here: the orbit at which the way begins. It does not count as a wanted orbit.
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
