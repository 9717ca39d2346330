"""Decorator that switches the garbage collector off in a function that makes many lasting objects.

A collection starts after every 700 new objects and would search them for garbage that does not exist yet.
"""

from __future__ import annotations

import gc
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


def uncollected(build: Callable[P, T]) -> Callable[P, T]:
    """Return `build` with the collector off while it runs; its previous state is restored afterwards."""

    @wraps(build)
    def built(*args: P.args, **kwargs: P.kwargs) -> T:
        if not gc.isenabled():
            return build(*args, **kwargs)
        gc.disable()
        try:
            return build(*args, **kwargs)
        finally:
            gc.enable()

    return built
