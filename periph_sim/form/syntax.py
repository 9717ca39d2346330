"""Queries on the syntax tree of a source: nodes, names that are read, and assigned values."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Iterator, Mapping
from functools import cache

CLOSURES = (ast.FunctionDef, ast.Lambda, ast.GeneratorExp)
OPERATORS: Mapping[type[ast.operator], Callable[[int, int], int]] = {
    ast.Add: operator.add,
    ast.LShift: operator.lshift,
    ast.Mult: operator.mul,
    ast.Sub: operator.sub,
    ast.FloorDiv: operator.floordiv,
    ast.RShift: operator.rshift,
}


@cache
def walked(node: ast.AST) -> tuple[ast.AST, ...]:
    """Return the node and all its descendants."""
    return tuple(ast.walk(node))


def is_own(target: ast.expr) -> bool:
    return isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name) and target.value.id == "self"


def read_names(tree: ast.AST, owner: str) -> set[str]:
    """Return the names of variables, or of the attributes of one variable, that are read but not called.

    owner: the name of the variable with the attributes; "" to search for variables.
    """
    called = {id(node.func) for node in walked(tree) if isinstance(node, ast.Call)}
    read = [one for one in walked(tree) if isinstance(getattr(one, "ctx", None), ast.Load) and id(one) not in called]
    if owner:
        return {one.attr for one in read if isinstance(one, ast.Attribute) and ast.unparse(one.value) == owner}
    return {one.id for one in read if isinstance(one, ast.Name)}


def pairs(node: ast.Assign) -> Iterator[tuple[ast.expr, ast.expr | None]]:
    """Yield (target, value) for each target of an assignment.

    The value is None if the target is one of several for the result of one expression, as in `a, b = f()`.
    """
    for target in node.targets:
        if not isinstance(target, ast.Tuple):
            yield target, node.value
        elif isinstance(node.value, ast.Tuple) and len(node.value.elts) == len(target.elts):
            yield from zip(target.elts, node.value.elts, strict=True)
        else:
            yield from ((one, None) for one in target.elts)


def own_assignments(method: ast.FunctionDef) -> Iterator[tuple[str, ast.expr | None, int]]:
    """Yield (name, value, line) for each assignment to an attribute of `self`, by `=` or as the target of a `for` loop.

    Assignments with an annotation, and augmented ones such as `+=`, are left out. The value is None if the attribute is
    one of several targets of one expression, as in `self.a, self.b = f()`, or the target of a `for` loop.
    """
    for node in walked(method):
        if isinstance(node, ast.Assign):
            found = list(pairs(node))
        elif isinstance(node, ast.For):
            found = [(node.target, None)]
        else:
            continue
        for target, value in found:
            for one in walked(target):
                if isinstance(one, ast.Attribute) and is_own(one) and isinstance(one.ctx, ast.Store):
                    yield one.attr, value if one is target else None, node.lineno


def is_typable(node: ast.FunctionDef, kind: str) -> bool:
    """Return True if Cython can compile this function as a C function.

    Such a function has no decorator, `yield` or `super`, and no keyword-only, positional-only or variable arguments. A
    function of kind "cpdef" also has no closure.
    """
    if node.decorator_list or node.args.kwonlyargs or node.args.vararg or node.args.kwarg or node.args.posonlyargs:
        return False
    closures = CLOSURES if kind == "cpdef" else ()
    nodes = [one for one in walked(node) if one is not node]
    if any(isinstance(one, (ast.Yield, ast.YieldFrom, *closures)) for one in nodes):
        return False
    return not any(isinstance(one, ast.Name) and one.id == "super" for one in nodes)
