"""Sources for Cython: the same lines with Cython's decorators and types.

    @final                                                      @cython.final is in the .pxd file
    class Event:  # core: freelist 16                           @cython.freelist(16)
                                                                @cython.cclass
                                                                class Event:
    from .accumulator import add, M32                           from .accumulator import M32      (add is cimported)
    f.execute = globals()[name]                                 if name == "NOT_ACC": f.execute = NOT_ACC
                                                                elif ...
    return          in a function without a result              return False
    event: Event    a type without a value                      pass

Cython obeys `freelist` at the class itself and ignores it in a .pxd file. A C function without a result returns whether
it raised, so its bare `return` needs a value.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable, Iterator

from .compiled_class import VOID
from .sources import Source
from .syntax import walked

BY_NAME = re.compile(r"^( *)(\S+ = )globals\(\)\[(\w+)\]\n*\Z", re.MULTILINE)
FUTURE = "from __future__ import annotations\n"


def prepared(source: Source) -> str:
    """Return the source, ready for Cython."""
    lines = source.text.split("\n")
    for node in walked(source.tree):
        if isinstance(node, ast.FunctionDef):
            _replace_bare_annotations(node.body, lines)
    for kind in source.classes.values():
        _replace_bare_annotations(kind.node.body, lines)
        for one in kind.node.decorator_list:
            lines[one.lineno - 1] = ""
        for mark in kind.marks:
            row = kind.node.lineno - 1
            lines[row - 2 : row] = [f"@cython.{mark.replace(' ', '(')})", "@cython.cclass"]
    for row, end in sorted(_bare_returns(source), reverse=True):
        line = lines[row].encode()
        lines[row] = (line[:end] + b" False" + line[end:]).decode()
    for statement in source.tree.body:
        if isinstance(statement, ast.ImportFrom) and statement.module != "__future__":
            _remove_names(statement, source.cimported, lines)
        elif isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) in {
            **source.fused,
            **source.pointers,
        }:
            lines[statement.lineno - 1] = ""  # the .pxd file declares it
    text = _look_up_spelled_out(source, "\n".join(lines))
    keeps = any(kind.marks for kind in source.classes.values())
    return text.replace(FUTURE, f"{FUTURE.rstrip()}; import cython\n", 1) if keeps else text


def _replace_bare_annotations(body: list[ast.stmt], lines: list[str]) -> None:
    """Put `pass` where a type is declared without a value: Cython would look the variable up."""
    for statement in body:
        for node in [statement] if isinstance(statement, ast.ClassDef | ast.FunctionDef) else ast.walk(statement):
            if isinstance(node, ast.AnnAssign) and node.value is None:
                rows = range(node.lineno - 1, node.end_lineno or node.lineno)
                for row in rows:
                    lines[row] = ""
                lines[rows[0]] = f"{' ' * node.col_offset}pass"


def _bare_returns(source: Source) -> Iterator[tuple[int, int]]:
    """Row and column behind each `return` without a value in C functions without a result."""
    kinds = source.classes.values()
    owners = [({one.name: one for one in source.tree.body if isinstance(one, ast.FunctionDef)}, source.functions)]
    owners += [(kind.defined, kind.methods) for kind in kinds]
    for nodes, functions in owners:
        for name, function in functions.items():
            if function.kind != "def" and function.result.c == VOID:
                yield from ((one.lineno - 1, one.end_col_offset or 0) for one in _returns(nodes[name].body))


def _returns(body: Iterable[ast.AST]) -> Iterator[ast.Return]:
    """Yield each `return` without a value, except in inner functions."""
    for node in body:
        if isinstance(node, ast.Return) and node.value is None:
            yield node
        elif not isinstance(node, ast.FunctionDef | ast.Lambda):
            yield from _returns(ast.iter_child_nodes(node))


def _remove_names(statement: ast.ImportFrom, names: Collection[str], lines: list[str]) -> None:
    """Take names out of an import; the statement keeps its number of lines."""
    if not any(alias.name in names for alias in statement.names):
        return
    assert statement.end_lineno is not None
    kept = ", ".join(alias.name for alias in statement.names if alias.name not in names)
    rows = statement.end_lineno - statement.lineno + 1
    line = f"from {'.' * statement.level}{statement.module or ''} import {kept}" if kept else ""
    lines[statement.lineno - 1 : statement.end_lineno] = [line] + [""] * (rows - 1)


def _look_up_spelled_out(source: Source, text: str) -> str:
    """Replace the last line of the text, which looks a function up by its name, by a comparison for each function.

    A C function is no object that a module has by name. `name` may be that of any function without a result that takes
    an operation.
    """
    found = BY_NAME.search(text)
    if not found:
        return text
    indent, target, key = found.groups()
    names = [name for name, one in source.functions.items() if one.kind == "cdef" and name[0].isupper()]
    lines = [f'{indent}{"el" * bool(n)}if {key} == "{name}": {target}{name}' for n, name in enumerate(names)]
    return text[: found.start()] + "\n".join([*lines, f"{indent}else: raise KeyError({key})"]) + "\n"
