"""Checks that are inserted into the C code from Cython: array indices must be in range, and setters reject None.

    __pyx_v_cpu->xar[__pyx_v_f->n]  -->  __pyx_v_cpu->xar[PERIPH_SIM_INDEX(__pyx_v_f->n, 8, "xar")]

Cython checks the indices of lists but not those of C arrays. With the check, an index out of range ends the process
with a message instead of changing other memory. The C compiler removes the check where the index is always in range,
for example after a mask or in a loop with a constant bound.

    cdef public Kernel kernel    -->  `wire.kernel = None` and `del wire.kernel` are TypeErrors
    cdef public Event following  -->  unchanged, because the source declares `Event | None`

By itself, Cython accepts None for any attribute whose type is a compiled class. Modules that are compiled without
checks for None rely on these setters; mypy checks that the package's own code never assigns None.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from .sources import Source

ARRAY = re.compile(r"^    cdef (?:public )?[\w ]+\[(\d+)\] (\w+)$", re.MULTILINE)
CHECK = """\
#ifndef PERIPH_SIM_INDEX
#include <stdio.h>
static void __attribute__((cold, noreturn, noinline, unused)) periph_sim_bad_index(
    long long index, long long length, const char *name) {
  char text[160];
  snprintf(text, sizeof text, "index %lld is outside of the C array %s[%lld] of the compiled core", index, name, length);
  Py_FatalError(text);
}
static inline long long __attribute__((unused)) periph_sim_index(long long index, long long length, const char *name) {
  if (unlikely((unsigned long long)index >= (unsigned long long)length)) periph_sim_bad_index(index, length, name);
  return index;
}
#define PERIPH_SIM_INDEX(index, length, name) periph_sim_index((long long)(index), length, name)
#endif
"""  # noqa: E501
BEGIN = "/* Module declarations from "  # Cython writes this comment before the functions of the module


def arrays_of(pxds: Iterable[str]) -> dict[str, int]:
    """Return the arrays that these .pxd files declare, as a dictionary from names to lengths.

    Raise ValueError if two arrays with the same name have different lengths.
    """
    found: dict[str, int] = {}
    for length, name in (one for pxd in pxds for one in ARRAY.findall(pxd)):
        if found.setdefault(name, int(length)) != int(length):
            raise ValueError(f"two arrays are called {name!r}, of different lengths; rename one of them")
    return found


def with_index_checks(c_text: str, lengths: Mapping[str, int]) -> str:
    """Return the C code with range checks for the indices of these arrays. Literal numbers are not checked."""
    if not lengths:
        return c_text
    used = re.compile(rf"->(?:__pyx_base\.)*({'|'.join(map(re.escape, lengths))})\[")
    text = _checked(c_text, used, lengths)
    return text.replace(BEGIN, CHECK + BEGIN, 1) if text != c_text else text


def _checked(text: str, used: re.Pattern[str], lengths: Mapping[str, int]) -> str:
    parts: list[str] = []
    at = 0
    while found := used.search(text, at):
        end = _closing(text, found.end())
        index = _checked(text[found.end() : end], used, lengths)
        name = found[1]
        checked = index if index.isdecimal() else f'PERIPH_SIM_INDEX({index}, {lengths[name]}, "{name}")'
        parts += [text[at : found.end()], checked]
        at = end
    return "".join([*parts, text[at:]])


def _closing(text: str, at: int) -> int:
    """Return the index of the closing bracket that matches the opening bracket just before index `at`."""
    depth = 1
    while depth:
        depth += {"[": 1, "]": -1}.get(text[at], 0)
        at += 1
    return at - 1


REFUSAL = """\
  if (unlikely(!v || v == Py_None)) {{
    PyErr_SetString(PyExc_TypeError, "{name} cannot be None, nor be deleted");
    return -1;
  }}
"""


def never_none(source: Source) -> list[tuple[str, str]]:
    """Return pairs (class, attribute) of the attributes that must refuse None.

    Their type is a compiled class, and their annotation does not allow None.
    """
    typed = [(one.name, name, of) for one in source.classes.values() for name, of in one.attributes.items()]
    return [(owner, name) for owner, name, of in typed if of.kind and not of.optional]


def with_none_refused(c_text: str, attributes: Iterable[tuple[str, str]]) -> str:
    """Return the C code with setters that reject None for these attributes, given as pairs (class, attribute).

    Raise ValueError if an attribute does not have exactly one setter in the C code.
    """
    for kind, name in attributes:
        setter = rf"static int __pyx_setprop_\w*?\d{kind}_{name}\(PyObject \*o, PyObject \*v, [\w ]+\*x\) {{\n"
        c_text, found = re.subn(setter, rf"\g<0>{REFUSAL.format(name=f'{kind}.{name}')}", c_text)
        if found != 1:
            raise ValueError(f"{kind}.{name} has {found} setters in C; expected one")
    return c_text
