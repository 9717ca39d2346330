"""Check that the C code that Cython writes obeys the directives of its .pxd file, and the directive `trashcan`.

    @cython.final            no class can be derived from this class
    @cython.freelist(16)     the deallocator keeps up to 16 deleted objects for reuse
    @cython.locals(at=...)   the function declares this variable with this C type
    trashcan (every class)   a deallocator that releases other objects uses Python's trashcan, so it does not recurse

Cython silently ignores a directive in an unexpected place. `declarations` writes the first three into the .pxd file and
no others. Cython obeys `freelist` only in the source, so `source_copy` writes it there, too. `build` passes `trashcan`
to Cython as an option, for all classes.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

FINAL = "@cython.final"
CLASS = re.compile(r"cdef class (\w+)")
FUNCTION = re.compile(r" *cp?def .*?(\w+)\([^()]*\)")
# LOCALS maps the type of a local variable to its spelling in C. Python's own types and compiled classes are left out.
LOCALS = {
    "cython.bint": "int ",
    "cython.int": "int ",
    "cython.longlong": "PY_LONG_LONG ",
    "cython.uint": "unsigned int ",
}
PYTHONS_OWN = ("bytearray", "bytes", "dict", "list", "object", "set", "str", "tuple")  # all are `PyObject *` in C


def disobeyed(pxd: str, c_text: str) -> Iterator[str]:
    """Yield a sentence for each directive without effect in the C code. pxd: the text of the .pxd file."""
    inside = ""  # the class that contains the present line; "" outside of classes
    decorators: list[str] = []
    for line in pxd.split("\n"):
        if line.lstrip().startswith("@"):
            decorators.append(line.strip())
            continue
        if found := CLASS.match(line):
            inside = found[1]
            for text in decorators:
                count = text.removeprefix("@cython.freelist(").removesuffix(")")
                if not (_is_final(c_text, inside) if text == FINAL else _keeps(c_text, inside, count)):
                    yield f"{text} of class {inside} has no effect in the C code"
            if not _is_released_in_a_loop(c_text, inside):
                what = f"the deallocator of class {inside} releases other objects by recursion"
                yield f"{what}: the directive trashcan is lost"
        elif function := FUNCTION.match(line):
            inside = inside if line.startswith(" ") else ""
            given = [one for text in decorators for one in text.removeprefix("@cython.locals(")[:-1].split(", ")]
            for variable, kind in (one.split("=") for one in given):
                if not _declares(c_text, inside, function[1], variable, kind):
                    what = f"@cython.locals({variable}={kind}) of {function[1]}"
                    yield f"{what} declares no such variable in the C code"
        decorators.clear()


def _slot(c_text: str, name: str, slot: str) -> str:
    """Return the C body of a class's slot function, such as its deallocator; "" if the class has none."""
    found = re.search(rf"^static \w+ \*?__pyx_{slot}_\w*?\d{name}\(PyObject \*o\) {{\n(.*?)^}}", c_text, _WHOLE)
    found = found or re.search(rf"^static [\w ]+\*?__pyx_{slot}_\w*_{name}\([^\n]*\) {{\n(.*?)^}}", c_text, _WHOLE)
    return found[1] if found else ""


_WHOLE = re.MULTILINE | re.DOTALL


def _is_final(c_text: str, name: str) -> bool:
    flags = re.findall(
        rf"^static PyTypeObject __pyx_type_\w*_{name} = {{.*?^ *(Py_TPFLAGS_DEFAULT[^,]*),", c_text, _WHOLE
    )
    return bool(flags) and all("Py_TPFLAGS_BASETYPE" not in one for one in flags)


def _keeps(c_text: str, name: str, count: str) -> bool:
    return re.search(rf"__pyx_freecount_\w*_{name} < {count}\b", _slot(c_text, name, "tp_dealloc")) is not None


def _is_released_in_a_loop(c_text: str, name: str) -> bool:
    body = _slot(c_text, name, "tp_dealloc")
    return "PyObject_GC_UnTrack(o)" not in body or "Py_CLEAR(p->" not in body or "__Pyx_TRASHCAN_BEGIN(o, " in body


def _declares(c_text: str, inside: str, function: str, variable: str, kind: str) -> bool:
    """Return True if the C function has a local variable or an argument with this name and type."""
    prefix = rf"{len(inside)}{inside}_" if inside else ""
    bodies = re.findall(rf"^static [^\n]*?__pyx_f_\w*?{prefix}{function}(\([^\n]*\) {{\n.*?^}})", c_text, _WHOLE)
    if kind in LOCALS:
        wanted = re.escape(LOCALS[kind])
    elif kind in PYTHONS_OWN:
        wanted = r"PyObject \*"
    else:
        wanted = rf"struct __pyx_obj_\w*_{kind} \*"
    return any(re.search(rf"(?<!\w){wanted}__pyx_(?:\w*genexpr__pyx_)?v_{variable}\b", body) for body in bodies)
