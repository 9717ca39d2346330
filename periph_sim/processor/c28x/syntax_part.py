"""A part of a syntax: it formats and parses some fields of a form, or is literal text."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

Values = Mapping[str, int]
Evaluate = Callable[[str], int]  # evaluates an expression of the source
Read = Callable[[str, int, Evaluate], dict[str, int]]  # parses an operand of the instruction at an address


class BadOperand(ValueError):
    """Text is not an operand of this kind; the message is one sentence."""


class Part(NamedTuple):
    """show: formats the fields, for an instruction's address. pattern: text that `read` parses, "" for literals."""

    show: Callable[[Values, int], str]
    pattern: str
    read: Read | None = None
    literal: str = ""


def literal(text: str) -> Part:
    """Return the part that is this text."""
    return Part(lambda values, at: text, "", None, text)


def ranged(number: int, least: int, most: int, text: str) -> int:
    """Return a number if it is within its limits; else raise BadOperand."""
    if not least <= number <= most:
        raise BadOperand(f"{text.strip()!r} is {number}, outside {least} to {most}")
    return number
