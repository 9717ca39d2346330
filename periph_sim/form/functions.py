"""C functions as Python uses its own: a source and its .pxd file go in; a source that C functions allow comes out.

    from .accumulator import add, M32      from .accumulator import M32       where the .pxd file cimports add
    f.execute = globals()[name]            if name == "ADD_ACC_loc16": f.execute = ADD_ACC_loc16
                                           elif ...
                                           else: raise KeyError(name)

A function that a .pxd file declares is no object that a module has by name. Lines keep their numbers: what is found by
name is found in the last line of a module.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection

CIMPORTED = re.compile(r"^from [\w.]+ cimport (.+)$", re.MULTILINE)
BY_NAME = re.compile(r"^( *)(\S+ = )globals\(\)\[(\w+)\]\n*\Z", re.MULTILINE)
FORM = re.compile(r"^cdef void ([A-Z]\w*)\(", re.MULTILINE)


def cimported(pxd: str) -> set[str]:
    """What a .pxd file takes from others, but for classes."""
    names = {name.strip() for found in CIMPORTED.findall(pxd) for name in found.split(",")}
    return {name for name in names if not name[0].isupper()}


def without_imports(source: str, names: Collection[str]) -> str:
    """The source without the imports of these names."""
    lines = source.split("\n")
    for one in ast.parse(source).body:
        if isinstance(one, ast.ImportFrom) and any(alias.name in names for alias in one.names):
            assert one.end_lineno is not None
            kept = ", ".join(alias.name for alias in one.names if alias.name not in names)
            rows = one.end_lineno - one.lineno + 1
            line = f"from {'.' * one.level}{one.module or ''} import {kept}" if kept else ""
            lines[one.lineno - 1 : one.end_lineno] = [line] + [""] * (rows - 1)
    return "\n".join(lines)


def by_name(source: str, pxd: str) -> str:
    """The source with its last line, a look-up by name, spelled out for the functions of the .pxd file in capitals."""
    found = BY_NAME.search(source)
    if not found:
        return source
    indent, target, key = found.groups()
    lines = [
        f'{indent}{"el" * bool(n)}if {key} == "{name}": {target}{name}' for n, name in enumerate(FORM.findall(pxd))
    ]
    return source[: found.start()] + "\n".join([*lines, f"{indent}else: raise KeyError({key})"]) + "\n"
