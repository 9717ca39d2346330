"""Replacement of constants in a source, which a compiled module would look up at each use.

    state.str |= STR_XRDY            state.str |= 16
    if offset == at.DRR:             if offset == 6:
    from ..core.records import Kind  from ..core.records import Kind; Kind_FLAG = Kind.FLAG
    recorder.wants(Kind.FLAG)        recorder.wants(Kind_FLAG)

Integers of uppercase names become literals, and members of enumerations global names that are bound once. Line numbers
do not change.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from enum import EnumMeta
from types import ModuleType

LITERAL = 2**31 - 1  # larger values become objects in C unless their width is declared
WORD = 64  # bits of a C integer; larger values stay names and objects


def declared(source: str, pxd: str) -> str:
    """Return the .pxd file with a declaration of each integer in the source that is larger than LITERAL."""
    found = sorted(set(re.findall(r"\bPERIPH_SIM_(\d+)\b", source)))
    if not found:
        return pxd
    defines = "\n".join(f"    #define PERIPH_SIM_{value} {value}LL" for value in found)
    names = "\n".join(f"    const long long PERIPH_SIM_{value}" for value in found)
    return f'{pxd}\n\ncdef extern from *:\n    """\n{defines}\n    """\n{names}\n'


def with_constants(source: str, names: Mapping[str, object]) -> str:
    """Return the source with its constants replaced. names: the module's globals after its import."""
    tree = ast.parse(source)
    lines = [line.encode() for line in source.split("\n")]  # columns are in bytes
    imported = {
        alias.asname or alias.name: one
        for one in tree.body
        if isinstance(one, ast.ImportFrom)
        for alias in one.names
        if isinstance(names.get(alias.asname or alias.name), EnumMeta)
    }
    bound: dict[str, ast.ImportFrom] = {}  # the import that each binding follows, by its text
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
    """Yield the names inside functions and classes, those of attributes of a name included."""
    outer = [one for one in tree.body if isinstance(one, ast.ClassDef | ast.FunctionDef)]
    for node in (node for one in outer for node in ast.walk(one)):
        if isinstance(node, ast.Name) or (isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)):
            yield node


def _integer(node: ast.Name | ast.Attribute, names: Mapping[str, object]) -> int | None:
    """Return the integer of an uppercase name in this module, or in one that it imports; None if it is none."""
    value: object = None
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id.isupper():
        value = names.get(node.id)
    elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.attr.isupper():
        module = names.get(node.value.id)
        value = getattr(module, node.attr, None) if isinstance(module, ModuleType) else None
    return value if type(value) is int and value.bit_length() < WORD else None


def _enumeration(node: ast.Name | ast.Attribute, names: Mapping[str, object]) -> str:
    """Return the name of the enumeration of which this is a member; "" if it is none."""
    if not isinstance(node, ast.Attribute) or not isinstance(node.value, ast.Name):
        return ""
    kind = names.get(node.value.id)
    return node.value.id if isinstance(kind, EnumMeta) and node.attr in kind.__members__ else ""
