"""How much an object holds on to: it goes in, a count comes out of all objects and bytes that are reached from it."""

from __future__ import annotations

import gc
from array import array
from types import ModuleType


def held(root: object, but: tuple[type, ...] = ()) -> int:
    """Objects, and elements of those that keep values without one. but: types of what is not looked into.

    What belongs to the program and not to a run is left out: classes, modules and their globals.
    """
    seen: dict[int, object] = {}
    todo = [root]
    count = 0
    while todo:
        one = todo.pop()
        if id(one) in seen or isinstance(one, (ModuleType, type)):
            continue
        seen[id(one)] = one  # held, so that no other object gets its id
        if isinstance(one, but) or (type(one) is dict and "__builtins__" in one):
            continue
        count += 1
        if isinstance(one, (array, bytes, bytearray, str)):
            count += len(one)
        todo += gc.get_referents(one)
    return count
