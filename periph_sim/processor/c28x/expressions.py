"""Integer expressions of assembly source, with symbols.

0x7900 + 2     1F2h     'A'     (table + 4) & 0x3F     $ - 2     ~1
"""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable, Mapping

HERE = "_here_"
MOST_BITS = 64  # a longer shift is a mistake

_BINARY: Mapping[type[ast.operator], Callable[[int, int], int]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
    ast.LShift: operator.lshift,
    ast.RShift: operator.rshift,
}
_UNARY: Mapping[type[ast.unaryop], Callable[[int], int]] = {
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Invert: operator.invert,
}


class BadExpression(ValueError):
    """Text is not a number; the message is one sentence."""


class Undefined(BadExpression):
    """A symbol is unknown, or not yet defined."""


def evaluate(text: str, symbols: Mapping[str, int], here: int) -> int:
    """Evaluate an expression. here: the value of `$`. Raise BadExpression or Undefined."""
    source = re.sub(r"'(.)'", lambda found: str(ord(found[1])), text.strip())
    source = re.sub(r"\b(\d[0-9A-Fa-f]*)h\b", r"0x\1", source).replace("/", "//")
    source = re.sub(r"(?<!\w)[A-Za-z_.$][\w.$]*", lambda found: HERE if found[0] == "$" else _quoted(found[0]), source)
    try:
        tree = ast.parse(source, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise BadExpression(f"{text.strip()!r} is not a number or an expression") from None
    try:
        return _value(tree, symbols, here)
    except ZeroDivisionError:
        raise BadExpression(f"{text.strip()!r} divides by 0") from None


def _quoted(name: str) -> str:
    """Encode a symbol as a Python identifier; symbols of this assembler may contain `.` and `$`."""
    return "s_" + name.encode().hex()


def _value(node: ast.expr, symbols: Mapping[str, int], here: int) -> int:
    match node:
        case ast.Constant(int(number)) if not isinstance(number, bool):
            return number
        case ast.Name(id=name) if name == HERE:
            return here
        case ast.Name(id=name) if name.startswith("s_"):
            symbol = bytes.fromhex(name[2:]).decode()
            if symbol not in symbols:
                raise Undefined(f"{symbol!r} is not defined")
            return symbols[symbol]
        case ast.BinOp(left, how, right) if type(how) in _BINARY:
            first, second = _value(left, symbols, here), _value(right, symbols, here)
            if isinstance(how, ast.LShift | ast.RShift) and not 0 <= second <= MOST_BITS:
                raise BadExpression(f"a shift by {second} bits is not possible")
            return _BINARY[type(how)](first, second)
        case ast.UnaryOp(how, operand) if type(how) in _UNARY:
            return _UNARY[type(how)](_value(operand, symbols, here))
    raise BadExpression("an expression has only numbers, symbols, + - * / % & | ^ ~ << >> and brackets")
