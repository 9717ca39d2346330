"""What makes many objects that all stay: a function goes in; the same comes out, without the garbage collector in it.

Such a pass begins at each 700th new object, and looks at all of them for garbage that there is not yet.
"""

from __future__ import annotations

import gc
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


def uncollected(build: Callable[P, T]) -> Callable[P, T]:
    """`build`, during which the collector is off; afterwards it is as it was."""

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
