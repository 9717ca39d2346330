"""Preparation of a source for Cython: a copy in which lines keep their numbers, and some lines are changed.

    line in the source                                          line in the copy

    @final                                                      empty (@cython.final is in the .pxd file)
    class Event:  # core: freelist 16                           @cython.freelist(16)
                                                                @cython.cclass
                                                                class Event:
    from .accumulator import add, M32                           from .accumulator import M32      (add is cimported)
    f.execute = globals()[name]  (last line of the source)      if name == "NOT_ACC": f.execute = NOT_ACC
                                                                elif ...
    return          (in a function without a result)            return False
    event: Event    (a type without a value)                    pass
    state.str |= STR_XRDY                                       state.str |= 16
    from ..core.records import Kind                             from ..core.records import Kind; Kind_FLAG = Kind.FLAG
    recorder.wants(Kind.FLAG)                                   recorder.wants(Kind_FLAG)

Cython obeys `freelist` at the class itself and ignores it in a .pxd file. C functions are not in the module's
`globals()`, so a look-up by name becomes `if` statements that compare the key with the names of C functions. A function
without a result becomes a C function that returns False, or -1 after an exception, so a bare `return` becomes
`return False`. Constants would be looked up at each use. So integers with uppercase names become literals, and members
of imported enumerations become global names that are bound once.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from enum import EnumMeta
from types import ModuleType

from .compiled_class import VOID
from .sources import Source
from .syntax import walked

BY_NAME = re.compile(r"^( *)(\S+ = )globals\(\)\[(\w+)\]\n*\Z", re.MULTILINE)
FUTURE = "from __future__ import annotations\n"


def prepared(source: Source) -> str:
    """Return the source with the changes that the module's docstring lists. Constants are not replaced here."""
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
        elif isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) in source.pointers:
            lines[statement.lineno - 1] = ""  # the .pxd file declares this type
    text = _look_up_spelled_out(source, "\n".join(lines))
    keeps = any(kind.marks for kind in source.classes.values())
    return text.replace(FUTURE, f"{FUTURE.rstrip()}; import cython\n", 1) if keeps else text


def _replace_bare_annotations(body: list[ast.stmt], lines: list[str]) -> None:
    """Replace each annotation without a value by `pass`, because Cython would generate code that reads the variable."""
    for statement in body:
        for node in [statement] if isinstance(statement, ast.ClassDef | ast.FunctionDef) else ast.walk(statement):
            if isinstance(node, ast.AnnAssign) and node.value is None:
                rows = range(node.lineno - 1, node.end_lineno or node.lineno)
                for row in rows:
                    lines[row] = ""
                lines[rows[0]] = f"{' ' * node.col_offset}pass"


def _bare_returns(source: Source) -> Iterator[tuple[int, int]]:
    """Yield the place of each `return` without a value in C functions without a result: (row, end column), from 0."""
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
    """Remove names from an import statement in `lines`. The statement keeps its number of lines."""
    if not any(alias.name in names for alias in statement.names):
        return
    assert statement.end_lineno is not None
    kept = ", ".join(alias.name for alias in statement.names if alias.name not in names)
    rows = statement.end_lineno - statement.lineno + 1
    line = f"from {'.' * statement.level}{statement.module or ''} import {kept}" if kept else ""
    lines[statement.lineno - 1 : statement.end_lineno] = [line] + [""] * (rows - 1)


def _look_up_spelled_out(source: Source, text: str) -> str:
    """If the last line of the text is `target = globals()[key]`, replace it by `if` statements that compare the key.

    The key can be the name of any C function of the module that begins with an uppercase letter. A text with another
    last line is returned unchanged.
    """
    found = BY_NAME.search(text)
    if not found:
        return text
    indent, target, key = found.groups()
    names = [name for name, one in source.functions.items() if one.kind == "cdef" and name[0].isupper()]
    lines = [f'{indent}{"el" * bool(n)}if {key} == "{name}": {target}{name}' for n, name in enumerate(names)]
    return text[: found.start()] + "\n".join([*lines, f"{indent}else: raise KeyError({key})"]) + "\n"


LITERAL = 2**31 - 1  # the largest integer that is written as a literal; larger constants need a declared C type
WORD = 64  # number of bits of a C integer, sign included; constants that need more bits are not replaced


def declared(source: str, pxd: str) -> str:
    """Return the .pxd text with declarations of the names PERIPH_SIM_n, which are used for integers above LITERAL."""
    found = sorted(set(re.findall(r"\bPERIPH_SIM_(\d+)\b", source)))
    if not found:
        return pxd
    defines = "\n".join(f"    #define PERIPH_SIM_{value} {value}LL" for value in found)
    names = "\n".join(f"    const long long PERIPH_SIM_{value}" for value in found)
    return f'{pxd}\n\ncdef extern from *:\n    """\n{defines}\n    """\n{names}\n'


def with_constants(source: str, names: Mapping[str, object]) -> str:
    """Return the source with its constants replaced. names: the values of the module's global names."""
    tree = ast.parse(source)
    lines = [line.encode() for line in source.split("\n")]  # as bytes, because `ast` counts columns in bytes
    imported = {
        alias.asname or alias.name: one
        for one in tree.body
        if isinstance(one, ast.ImportFrom)
        for alias in one.names
        if isinstance(names.get(alias.asname or alias.name), EnumMeta)
    }
    bound: dict[str, ast.ImportFrom] = {}  # for each text to insert, the import statement that precedes it
    for node in sorted(_names(tree), key=lambda one: (one.lineno, one.col_offset), reverse=True):
        value = _integer(node, names)
        if value is not None:
            text = f"PERIPH_SIM_{value}" if value > LITERAL else f"({value})" if value < 0 else f"{value}"
        elif (kind := _enumeration(node, names)) in imported and isinstance(node, ast.Attribute):
            text = f"{kind}_{node.attr}"
            bound[f"; {text} = {kind}.{node.attr}"] = imported[kind]
        else:
            continue
        assert node.end_col_offset is not None and node.end_lineno == node.lineno
        line = lines[node.lineno - 1]
        lines[node.lineno - 1] = line[: node.col_offset] + text.encode() + line[node.end_col_offset :]
    for text, statement in bound.items():
        assert statement.end_lineno is not None
        lines[statement.end_lineno - 1] += text.encode()
    return b"\n".join(lines).decode()


def _names(tree: ast.Module) -> Iterator[ast.Name | ast.Attribute]:
    """Yield each name, and each attribute of a name such as `Kind.FLAG`, that is inside a function or class."""
    outer = [one for one in tree.body if isinstance(one, ast.ClassDef | ast.FunctionDef)]
    for node in (node for one in outer for node in ast.walk(one)):
        if isinstance(node, ast.Name) or (isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)):
            yield node


def _integer(node: ast.Name | ast.Attribute, names: Mapping[str, object]) -> int | None:
    """Return the value if the node is an uppercase integer constant of this or of an imported module; else None.

    Return None also for a constant that does not fit a C integer (see WORD).
    """
    value: object = None
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id.isupper():
        value = names.get(node.id)
    elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.attr.isupper():
        module = names.get(node.value.id)
        value = getattr(module, node.attr, None) if isinstance(module, ModuleType) else None
    return value if type(value) is int and value.bit_length() < WORD else None


def _enumeration(node: ast.Name | ast.Attribute, names: Mapping[str, object]) -> str:
    """Return the name of the enumeration if the node is one of its members; else ""."""
    if not isinstance(node, ast.Attribute) or not isinstance(node.value, ast.Name):
        return ""
    kind = names.get(node.value.id)
    return node.value.id if isinstance(kind, EnumMeta) and node.attr in kind.__members__ else ""
