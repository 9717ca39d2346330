"""Index assertions for C arrays, inserted into the C code from Cython.

    __pyx_v_cpu->xar[__pyx_v_f->n]  -->  __pyx_v_cpu->xar[PERIPH_SIM_INDEX(__pyx_v_f->n, 8, "xar")]

Cython checks indices of lists and not those of arrays. An index outside of its array ends the process with a message
instead of changing other memory. The compiler leaves the check out where the index cannot be outside: after a mask,
or in a loop to a constant.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

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
BEGIN = "/* Module declarations from "  # behind what Cython defines for itself, before the module's own functions


def arrays_of(pxds: Iterable[str]) -> dict[str, int]:
    """Return the lengths of the arrays that these .pxd files declare, by name. ValueError if two of one name differ."""
    found: dict[str, int] = {}
    for length, name in (one for pxd in pxds for one in ARRAY.findall(pxd)):
        if found.setdefault(name, int(length)) != int(length):
            raise ValueError(f"two arrays are called {name!r}, of different lengths; rename one of them")
    return found


def with_index_checks(c_text: str, lengths: Mapping[str, int]) -> str:
    """Return the C code with a check of each index of these arrays that is not a number."""
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
    """Return the place of the bracket that closes the one before `at`."""
    depth = 1
    while depth:
        depth += {"[": 1, "]": -1}.get(text[at], 0)
        at += 1
    return at - 1
