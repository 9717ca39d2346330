"""Replacement of enumeration members in a source, such as `Kind.FLAG`, by global names that are bound once.

    from ..core.records import Kind      from ..core.records import Kind; Kind_FLAG = Kind.FLAG
    recorder.wants(Kind.FLAG)            recorder.wants(Kind_FLAG)

Access to a member calls a Python function, which a compiled module would do at each use.
Lines keep their numbers.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from enum import EnumMeta


def with_members_bound(source: str, names: Mapping[str, object]) -> str:
    """names: the module's globals, as they are after its import."""
    tree = ast.parse(source)
    lines = [line.encode() for line in source.split("\n")]  # columns are in bytes
    imported = {
        alias.asname or alias.name: one
        for one in tree.body
        if isinstance(one, ast.ImportFrom)
        for alias in one.names
        if isinstance(names.get(alias.asname or alias.name), EnumMeta)
    }
    bound: dict[str, ast.ImportFrom] = {}  # what binds each, by the line to add
    for node, kind in sorted(_members(tree, names), key=lambda one: (one[0].lineno, one[0].col_offset), reverse=True):
        if kind in imported:
            name, row = f"{kind}_{node.attr}", node.lineno - 1
            assert node.end_col_offset is not None and node.end_lineno == node.lineno
            lines[row] = lines[row][: node.col_offset] + name.encode() + lines[row][node.end_col_offset :]
            bound[f"; {name} = {kind}.{node.attr}"] = imported[kind]
    for text, statement in bound.items():
        assert statement.end_lineno is not None
        lines[statement.end_lineno - 1] += text.encode()
    return b"\n".join(lines).decode()


def _members(tree: ast.Module, names: Mapping[str, object]) -> Iterator[tuple[ast.Attribute, str]]:
    """Yield each use of a member by the name of its class, inside functions and classes, with that name."""
    outer = [one for one in tree.body if isinstance(one, ast.ClassDef | ast.FunctionDef)]
    for node in (node for one in outer for node in ast.walk(one)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            kind = names.get(node.value.id)
            if isinstance(kind, EnumMeta) and node.attr in kind.__members__:
                yield node, node.value.id
