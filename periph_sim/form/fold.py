"""Constants in a source: names of whole numbers in capitals go in; the same source with their values comes out.

    state.str |= STR_XRDY          state.str |= 16
    if offset == at.DRR:           if offset == 6:

A compiled module would look them up anew each time, and calculate with objects. Lines keep their numbers.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from types import ModuleType

LITERAL = 2**31 - 1  # what is more becomes an object in C, unless a declaration says how wide it is
WORD = 64  # bits of a C integer; what needs more stays a name, and an object


def wide_name(value: int) -> str:
    """What a constant that is more is called."""
    return f"PERIPH_SIM_{value}"


def declared(source: str, pxd: str) -> str:
    """The .pxd file with a declaration of each wide constant that the folded source names."""
    found = sorted(set(re.findall(r"\bPERIPH_SIM_(\d+)\b", source)))
    if not found:
        return pxd
    defines = "\n".join(f"    #define PERIPH_SIM_{value} {value}LL" for value in found)
    names = "\n".join(f"    const long long PERIPH_SIM_{value}" for value in found)
    return f'{pxd}\n\ncdef extern from *:\n    """\n{defines}\n    """\n{names}\n'


def folded(source: str, names: Mapping[str, object]) -> str:
    """names: the module's globals, as they are after its import."""
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
    """Each use, inside functions and classes, of a name in capitals that stands for a whole number."""
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
