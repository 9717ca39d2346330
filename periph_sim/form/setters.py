"""Setters that reject None, inserted into the C code from Cython for public attributes of compiled classes.

    cdef public Kernel kernel    -->  `wire.kernel = None` and `del wire.kernel` are TypeErrors
    cdef public Event following  -->  unchanged, since the source assigns None to it or declares `Event | None`

Cython lets None into an attribute of any compiled class. Modules that are compiled without checks for None rely on
these setters, and mypy holds the package's own code to the same.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator

from .sources import Source

REFUSAL = """\
  if (unlikely(!v || v == Py_None)) {{
    PyErr_SetString(PyExc_TypeError, "{name} cannot be None, nor be deleted");
    return -1;
  }}
"""


def never_none(source: Source) -> list[tuple[str, str]]:
    """Return (class, name) of each attribute whose type is a compiled class and that is never set to None."""
    optional = set(_optional(source.tree))
    typed = [(one.name, name, of) for one in source.classes.values() for name, of in one.attributes.items()]
    return [(owner, name) for owner, name, of in typed if of.kind and name not in optional]


def with_none_refused(c_text: str, attributes: Iterable[tuple[str, str]]) -> str:
    """Return the C code whose setters of these attributes refuse None. ValueError if one has no setter."""
    for kind, name in attributes:
        setter = rf"static int __pyx_setprop_\w*?\d{kind}_{name}\(PyObject \*o, PyObject \*v, [\w ]+\*x\) {{\n"
        c_text, found = re.subn(setter, rf"\g<0>{REFUSAL.format(name=f'{kind}.{name}')}", c_text)
        if found != 1:
            raise ValueError(f"{kind}.{name} has {found} setters in C; expected one")
    return c_text


def _optional(tree: ast.Module) -> Iterator[str]:
    """Yield the names of attributes that may be None, whatever their class."""
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef):
            arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
            given = {one.arg for one in arguments if one.annotation is not None and _says_none(one.annotation)}
            for node in ast.walk(function):
                if isinstance(node, ast.Assign):
                    yield from _assigned(node, given)
    for node in ast.walk(tree):
        if isinstance(node, ast.AnnAssign) and _says_none(node.annotation):
            yield node.target.attr if isinstance(node.target, ast.Attribute) else ast.unparse(node.target)


def _assigned(node: ast.Assign, given: set[str]) -> Iterator[str]:
    for target in node.targets:
        pairs = [(target, node.value)]
        if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
            pairs = list(zip(target.elts, node.value.elts, strict=True))
        for to, value in pairs:
            may_be = (isinstance(value, ast.Name) and value.id in given) or _says_none(value)
            if isinstance(to, ast.Attribute) and may_be:
                yield to.attr


def _says_none(node: ast.expr) -> bool:
    return any(isinstance(one, ast.Constant) and one.value is None for one in ast.walk(node))
