"""A block without garbage collection, for code that makes many lasting objects.

With garbage collection, Python would search the new objects for garbage again and again, and find none.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def uncollected() -> Iterator[None]:
    """Switch garbage collection off in a block or in a decorated function; afterwards its old state is restored."""
    if not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
