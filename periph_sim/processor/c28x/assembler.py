"""Assemble one line of source: find the form of the instruction and encode its words.

A form is one row of `encodings.toml`. Every syntax of that table is accepted; case and spaces do not matter. If several
forms fit, the one with the fewest words is used, as in TI's assembler: `MOV @AL,#0` has one word.
"""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from typing import NamedTuple

from ...core.phrases import did_you_mean
from .encodings import Encoding, encodings
from .operands import BadInstruction, Read, parts_of

HERE = "_here_"  # the Python identifier of `$`, the current address
MOST_BITS = 64  # a shift by more bits is rejected as a mistake

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


class Undefined(BadInstruction):
    """Raised if an expression contains a symbol that is not defined, or is defined only later in the source."""


def evaluate(text: str, symbols: Mapping[str, int], here: int) -> int:
    """Return the value of an expression. Raise BadInstruction if it is invalid, Undefined for an undefined symbol.

    here: the value of `$`.
    """
    source = re.sub(r"'(.)'", lambda found: str(ord(found[1])), text.strip())
    source = re.sub(r"\b(\d[0-9A-Fa-f]*)h\b", r"0x\1", source).replace("/", "//")
    source = re.sub(r"(?<!\w)[A-Za-z_.$][\w.$]*", _identifier, source)
    try:
        tree = ast.parse(source, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise BadInstruction(f"{text.strip()!r} is not a number or an expression") from None
    try:
        return _value(tree, symbols, here)
    except ZeroDivisionError:
        raise BadInstruction(f"{text.strip()!r} divides by 0") from None


def _identifier(symbol: re.Match[str]) -> str:
    """Return a Python identifier for a symbol. A symbol may contain `.` and `$`; `$` alone is the current address."""
    return HERE if symbol[0] == "$" else "s_" + symbol[0].encode().hex()


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
                raise BadInstruction(f"a shift by {second} bits is not possible")
            return _BINARY[type(how)](first, second)
        case ast.UnaryOp(how, operand) if type(how) in _UNARY:
            return _UNARY[type(how)](_value(operand, symbols, here))
    raise BadInstruction("an expression has only numbers, symbols, + - * / % & | ^ ~ << >> and brackets")


class Parsed(NamedTuple):
    """A parsed instruction: its form and operands. operands: for each operand, its parsing function and its text."""

    encoding: Encoding
    operands: tuple[tuple[Read, str], ...]

    def words(self, address: int, symbols: Mapping[str, int]) -> tuple[int, ...]:
        """Encode the instruction for an address. Raise BadInstruction if an operand does not fit."""
        values: dict[str, int] = {}
        for read, text in self.operands:
            values |= read(text, address, lambda expression: evaluate(expression, symbols, address))
        pair = self.encoding.pair(values)
        return (pair >> 16, pair & 0xFFFF)[: self.encoding.words]

    def fits(self, address: int, symbols: Mapping[str, int]) -> bool:
        """Return True if every operand fits its field. Operands with undefined symbols count as fitting."""
        values: dict[str, int] = {}
        for read, text in self.operands:
            try:
                values |= read(text, address, lambda expression: evaluate(expression, symbols, address))
            except Undefined:
                continue
            except BadInstruction:
                return False
        bounds = self.encoding.bounds
        return all(values[name] in allowed for name, allowed in bounds.items() if name in values)


def parse(source: str, address: int, symbols: Mapping[str, int]) -> Parsed:
    """Return the shortest form that matches a source line. Raise BadInstruction if no form matches.

    symbols: the symbols defined so far. An operand with an undefined symbol is assumed to fit.
    """
    text = " ".join(source.split())
    mnemonic = text.partition(" ")[0].upper()
    forms = _forms().get(mnemonic)
    if forms is None:
        raise BadInstruction(f"there is no instruction {mnemonic!r}; {did_you_mean(mnemonic, sorted(_forms()))}")
    matched = []
    for encoding in forms:
        found = _pattern(encoding).fullmatch(text)
        if found is None:
            continue
        reading = [part.read for part in parts_of(encoding) if part.read is not None]
        parsed = Parsed(encoding, tuple(zip(reading, found.groups(), strict=True)))
        if parsed.fits(address, symbols):
            return parsed
        matched.append(parsed)
    if matched:
        matched[-1].words(address, symbols)  # raises BadInstruction, which names the operand that does not fit
    known = ", ".join(dict.fromkeys(encoding.syntax for encoding in forms))
    raise BadInstruction(f"{text!r} has none of the operands of {mnemonic}: {known}")


@cache
def _forms() -> Mapping[str, list[Encoding]]:
    """Return the forms of each mnemonic, in the order in which `parse` tries them.

    Forms with fewer words come first. Forms with equally many words are ordered by two rules: aliases come after other
    forms, and then forms with fewer operands come first, such as `MOVL P,ACC` before `MOVL loc32,ACC`.
    """
    forms: dict[str, list[Encoding]] = {}
    for encoding in encodings():
        forms.setdefault(encoding.mnemonic, []).append(encoding)
        if encoding.also:
            also = replace(encoding, mnemonic=encoding.also.partition(" ")[0], syntax=encoding.also)
            forms.setdefault(also.mnemonic, []).append(also)
    for rows in forms.values():
        rows.sort(key=lambda row: (row.words, row.alias_of > "", sum(part.read is not None for part in parts_of(row))))
    return forms


@cache
def _pattern(encoding: Encoding) -> re.Pattern[str]:
    """Return the regular expression of source lines of this form, with one group for each operand."""
    pieces = [_flexible(part.literal) if part.read is None else f"({part.pattern})" for part in parts_of(encoding)]
    return re.compile(r"\s*".join(pieces), re.IGNORECASE)


def _flexible(literal: str) -> str:
    """Return the regular expression of a literal text. It accepts spaces between the tokens of the text."""
    pieces = re.findall(r"\w+|\s+|\|\||<<|\S", literal)
    return r"\s*".join(re.escape(piece) for piece in pieces if piece.strip())
