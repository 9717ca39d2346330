"""Whether a C function raised: sources and .pxd files go in; in what comes out, its result says so.

    cpdef void act(self, long long tag)      cpdef bint act(self, long long tag) except -1
    return                                   return False
    cdef bint quiet(self)                    cdef bint quiet(self) except -1
    cpdef long long tick(self)               cpdef long long tick(self) except? PERIPH_SIM_RAISED

Behind a call of another function Python would have to be asked each time whether there is an exception. Whoever
overrides a method without a result in Python returns None as ever, which is no truth either.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable, Iterator

VOID = re.compile(r"^( *)(cp?def) void (\w+)\(([^()]*)\) *$", re.MULTILINE)
TRUTH = re.compile(r"^ *cp?def bint \w+\([^()]*\)(?= *$)", re.MULTILINE)
NUMBER = re.compile(r"^ *cp?def long long \w+\([^()]*\)(?= *$)", re.MULTILINE)

# A number that no function gives, or hardly: then Python is asked.
RAISED = '''\
cdef extern from *:
    """
    #define PERIPH_SIM_RAISED (-0x7EDCBA9876543210LL)
    """
    const long long PERIPH_SIM_RAISED

'''


def resultless(pxds: Iterable[str]) -> set[str]:
    """The names of functions that these .pxd files declare without a result."""
    return {found[3] for pxd in pxds for found in VOID.finditer(pxd)}


def telling(pxd: str) -> str:
    """The .pxd file with a result of each function that is a truth or a number, or that says whether it raised."""
    telling_truths = TRUTH.sub(r"\g<0> except -1", VOID.sub(r"\1\2 bint \3(\4)", pxd))
    text, numbers = NUMBER.subn(r"\g<0> except? PERIPH_SIM_RAISED", telling_truths)
    return RAISED + text if numbers else text


def returning(source: str, names: Collection[str]) -> str:
    """The source with a result behind each bare `return` of functions of these names."""
    lines = source.split("\n")
    functions = [one for one in ast.walk(ast.parse(source)) if isinstance(one, ast.FunctionDef) and one.name in names]
    places = {(node.lineno - 1, node.end_col_offset or 0) for function in functions for node in _bare(function.body)}
    for row, end in sorted(places, reverse=True):
        text = lines[row].encode()
        lines[row] = (text[:end] + b" False" + text[end:]).decode()
    return "\n".join(lines)


def _bare(body: Iterable[ast.AST]) -> Iterator[ast.Return]:
    """Each `return` without a value, those of functions inside left out."""
    for node in body:
        if isinstance(node, ast.Return) and node.value is None:
            yield node
        elif not isinstance(node, ast.FunctionDef | ast.Lambda):
            yield from _bare(ast.iter_child_nodes(node))
