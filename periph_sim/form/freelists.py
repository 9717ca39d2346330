"""Classes that keep objects for the next one: a source and its .pxd file go in; a source that says so goes to Cython.

    class Event:      --and @cython.freelist(16) in the .pxd file-->  @cython.freelist(16)
                                                                      @cython.cclass
                                                                      class Event:

Cython heeds that directive at the class itself and passes over it in a .pxd file. Lines keep their numbers: the new
ones take the place of the two empty ones above a class.
"""

from __future__ import annotations

import re

KEPT = re.compile(r"^(@cython\.freelist\(\d+\))\n(?:@.*\n)*cdef class (\w+)", re.MULTILINE)
FUTURE = "from __future__ import annotations\n"


def with_freelists(source: str, pxd: str) -> str:
    """The source as Cython heeds the free lists of its .pxd file."""
    kept = KEPT.findall(pxd)
    for directive, name in kept:
        source = re.sub(rf"\n\n\nclass {name}\b", f"\n{directive}\n@cython.cclass\nclass {name}", source, count=1)
    return source.replace(FUTURE, f"{FUTURE.rstrip()}; import cython\n", 1) if kept else source
