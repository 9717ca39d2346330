"""Replacement of uppercase names of integers in a source by their values.

    state.str |= STR_XRDY          state.str |= 16
    if offset == at.DRR:           if offset == 6:

A compiled module would look the names up at each use and calculate with objects. Line numbers do not change.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from types import ModuleType

LITERAL = 2**31 - 1  # larger values become objects in C unless their width is declared
WORD = 64  # bits of a C integer; larger values stay names and objects


def wide_name(value: int) -> str:
    """Return the name of a constant that is larger than LITERAL."""
    return f"PERIPH_SIM_{value}"


def declared(source: str, pxd: str) -> str:
    """Return the .pxd file with a declaration of each wide constant in the folded source."""
    found = sorted(set(re.findall(r"\bPERIPH_SIM_(\d+)\b", source)))
    if not found:
        return pxd
    defines = "\n".join(f"    #define PERIPH_SIM_{value} {value}LL" for value in found)
    names = "\n".join(f"    const long long PERIPH_SIM_{value}" for value in found)
    return f'{pxd}\n\ncdef extern from *:\n    """\n{defines}\n    """\n{names}\n'


def folded(source: str, names: Mapping[str, object]) -> str:
    """Return the source with integer constants replaced by literals. names: the module's globals after its import."""
    lines = source.split("\n")
    tree = ast.parse(source)
    for node, value in sorted(_constants(tree, names), key=lambda one: _place(one[0]), reverse=True):
        row, start, end = _place(node)
        text = lines[row].encode()
        literal = wide_name(value) if value > LITERAL else f"({value})" if value < 0 else f"{value}"
        lines[row] = (text[:start] + literal.encode() + text[end:]).decode()
    return "\n".join(lines)


def _place(node: ast.expr) -> tuple[int, int, int]:
    assert node.end_col_offset is not None and node.end_lineno == node.lineno
    return node.lineno - 1, node.col_offset, node.end_col_offset


def _constants(tree: ast.Module, names: Mapping[str, object]) -> Iterator[tuple[ast.expr, int]]:
    """Yield each use, inside functions and classes, of an uppercase name of an integer, with its value."""
    outer = [one for one in tree.body if isinstance(one, ast.ClassDef | ast.FunctionDef)]
    for node in (node for one in outer for node in ast.walk(one)):
        value: object = None
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id.isupper():
            value = names.get(node.id)
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.attr.isupper():
            module = names.get(node.value.id)
            value = getattr(module, node.attr, None) if isinstance(module, ModuleType) else None
        if type(value) is int and value.bit_length() < WORD and isinstance(node, ast.expr):
            yield node, value
