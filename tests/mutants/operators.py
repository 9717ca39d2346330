"""One-line changes of Python source: `changes` returns every `Change` of a text.

    ast --> comparisons, constants, and/or, signs, operators, conditions, min and max, statements, returns --> Change

A change replaces a few bytes of one line. Annotations, docstrings, decorators, messages, `assert`, protocols and code
for type checkers are not changed, because no test can detect that.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass

COMPARISONS = {
    ast.Lt: (r"<(?!=)", "<="),
    ast.LtE: (r"<=", "<"),
    ast.Gt: (r">(?!=)", ">="),
    ast.GtE: (r">=", ">"),
    ast.Eq: (r"==", "!="),
    ast.NotEq: (r"!=", "=="),
    ast.Is: (r"\bis\b", "is not"),
    ast.IsNot: (r"\bis\s+not\b", "is"),
    ast.In: (r"\bin\b", "not in"),
    ast.NotIn: (r"\bnot\s+in\b", "in"),
}
OPERATORS = {
    ast.BitAnd: (r"&", "|"),
    ast.BitOr: (r"\|", "&"),
    ast.BitXor: (r"\^", "&"),
    ast.LShift: (r"<<", ">>"),
    ast.RShift: (r">>", "<<"),
    ast.Add: (r"\+", "-"),
    ast.Sub: (r"-", "+"),
    ast.Mult: (r"(?<!\*)\*(?!\*)", "+"),
    ast.FloorDiv: (r"//", "*"),
    ast.Div: (r"(?<!/)/(?!/)", "*"),
    ast.Mod: (r"%", "//"),
}
SWAPPED = {"min": "max", "max": "min", "any": "all", "all": "any"}
LEFT_ALONE = (ast.JoinedStr, ast.Assert, ast.Raise, ast.Import, ast.ImportFrom, ast.Global, ast.Nonlocal)


@dataclass(frozen=True)
class Change:
    """A replacement of bytes `begin` to `end` of a line, whose number counts from 1. `kind` is for the report."""

    line: int
    begin: int
    end: int
    after: str
    kind: str

    def applied(self, line: bytes) -> bytes:
        return line[: self.begin] + self.after.encode() + line[self.end :]


def changes(source: str) -> list[Change]:
    """Return every change once, in the order of lines."""
    found = _Walk(source.encode().splitlines(keepends=True)).of(ast.parse(source))
    return sorted(set(found), key=lambda change: (change.line, change.begin, change.end, change.after))


class _Walk:
    def __init__(self, lines: list[bytes]) -> None:
        self._lines = lines

    def of(self, node: ast.AST) -> Iterator[Change]:
        for child in _children(node):
            yield from self._at(child)
            yield from self.of(child)

    def _at(self, node: ast.AST) -> Iterator[Change]:
        match node:
            case ast.Compare():
                for left, op, right in zip([node.left, *node.comparators], node.ops, node.comparators, strict=False):
                    yield from self._between(left, right, *COMPARISONS[type(op)], "comparison")
            case ast.BoolOp():
                word, other = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
                for left, right in zip(node.values, node.values[1:], strict=False):
                    yield from self._between(left, right, rf"\b{word}\b", other, "and/or")
            case ast.BinOp() if type(node.op) in OPERATORS:
                yield from self._between(node.left, node.right, *OPERATORS[type(node.op)], "operator")
            case ast.AugAssign() if type(node.op) in OPERATORS:
                pattern, other = OPERATORS[type(node.op)]
                yield from self._between(node.target, node.value, f"{pattern}(?==)", other, "operator")
                yield from self._whole(node, "pass", "deleted statement")
            case ast.UnaryOp(op=ast.Not()) | ast.UnaryOp(op=ast.Invert()) | ast.UnaryOp(op=ast.USub()):
                yield from self._whole(node, self._text(node.operand), "negation left out")
            case ast.Constant(value=bool()):
                yield from self._whole(node, str(not node.value), "constant")
            case ast.Constant(value=int()):
                yield from self._whole(node, str(node.value + 1), "constant")
                yield from self._whole(node, str(node.value - 1) if node.value else "1", "constant")
            case ast.Constant(value=float()) if node.value + 1 != node.value:
                yield from self._whole(node, repr(node.value + 1), "constant")
            case ast.Call(func=ast.Name(id=name)) if name in SWAPPED:
                yield from self._whole(node.func, SWAPPED[name], "swapped function")
            case ast.comprehension():
                for condition in node.ifs:
                    yield from self._whole(condition, f"not ({self._text(condition)})", "negated condition")
            case ast.If() | ast.While() | ast.IfExp():
                yield from self._whole(node.test, f"not ({self._text(node.test)})", "negated condition")
            case ast.Return(value=ast.expr()):
                yield from self._returned(node.value)
        if isinstance(node, ast.Expr | ast.Assign | ast.Continue | ast.Break | ast.Delete):
            named = isinstance(node, ast.Assign) and any(isinstance(t, ast.Name | ast.Tuple) for t in node.targets)
            if not named:  # without the name every test fails with NameError
                yield from self._whole(node, "pass", "deleted statement")

    def _returned(self, value: ast.expr) -> Iterator[Change]:
        if isinstance(value, ast.Compare | ast.BoolOp) or (
            isinstance(value, ast.UnaryOp) and isinstance(value.op, ast.Not)
        ):
            yield from self._whole(value, "True", "returned constant")
            yield from self._whole(value, "False", "returned constant")
        elif not isinstance(value, ast.Constant):
            yield from self._whole(value, "None", "returned constant")

    def _between(self, left: ast.expr, right: ast.expr, pattern: str, after: str, kind: str) -> Iterator[Change]:
        """Yield the change of the operator between two operands, if it is on one line with the adjacent ends."""
        if left.end_lineno != right.lineno or left.end_col_offset is None:
            return
        space = self._lines[right.lineno - 1][left.end_col_offset : right.col_offset].decode()
        found = re.search(pattern, space)
        if found is not None:
            begin = left.end_col_offset
            yield Change(right.lineno, begin + found.start(), begin + found.end(), after, kind)

    def _whole(self, node: ast.expr | ast.stmt, after: str, kind: str) -> Iterator[Change]:
        if node.lineno == node.end_lineno and node.end_col_offset is not None and self._text(node) != after:
            yield Change(node.lineno, node.col_offset, node.end_col_offset, after, kind)

    def _text(self, node: ast.expr | ast.stmt) -> str:
        return self._lines[node.lineno - 1][node.col_offset : node.end_col_offset].decode()


def _children(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the child nodes that are executed and can be tested."""
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "type_params", "bases", "keywords") and not isinstance(
            node, ast.Call
        ):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not _left_alone(child):
                yield child


def _left_alone(node: ast.AST) -> bool:
    if isinstance(node, LEFT_ALONE) or (isinstance(node, ast.keyword) and node.arg == "strict"):
        return True  # zip(strict=...) is an assertion
    if isinstance(node, ast.Expr):  # a docstring, or an ellipsis
        return isinstance(node.value, ast.Constant)
    if isinstance(node, ast.ClassDef):
        return any("Protocol" in ast.dump(base) for base in node.bases)
    if isinstance(node, ast.If):
        return "TYPE_CHECKING" in ast.dump(node.test)
    if isinstance(node, ast.Assign):
        return any(isinstance(t, ast.Name) and t.id in ("__slots__", "__all__") for t in node.targets)
    return isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and node.value.id == "Literal"
