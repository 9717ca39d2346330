"""Number of objects and bytes that an object keeps alive."""

from __future__ import annotations

import gc
from array import array
from types import ModuleType


def held(root: object, but: tuple[type, ...] = ()) -> int:
    """Count the objects reachable from `root`, and the elements of compact ones. Types in `but` are not searched.

    Parts of the program, not of a run, are not counted: classes, modules and their globals.
    """
    seen: dict[int, object] = {}
    todo = [root]
    count = 0
    while todo:
        one = todo.pop()
        if id(one) in seen or isinstance(one, (ModuleType, type)):
            continue
        seen[id(one)] = one  # kept alive, so that no other object gets its id
        if isinstance(one, but) or (type(one) is dict and "__builtins__" in one):
            continue
        count += 1
        if isinstance(one, (array, bytes, bytearray, str)):
            count += len(one)
        todo += gc.get_referents(one)
    return count
