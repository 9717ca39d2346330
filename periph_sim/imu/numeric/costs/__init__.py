"""Costs of operations on the F28335: one file for each library, cycles with the source of each figure.

A cost is a range: a published figure is both its ends; without a published figure the ends are a stated guess.
A figure holds for code and data in memory without wait states. Tables of a library may be in the boot ROM, which has
one: its cost is listed separately, as is that of loading operands and storing results, an assumption.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from msgspec import Struct, field

Tables = Literal["RAM", "boot ROM"]

# Operands and results of an operation.
OPERANDS = {
    "scaled": 2,
    "add": 3,
    "sub": 3,
    "mul": 3,
    "div": 3,
    "neg": 2,
    "sqrt": 2,
    "mag": 3,
    "sincos": 3,
    "atan": 2,
    "atan2": 3,
    "select": 5,
    "clamp": 4,
    "to integer, nearest": 2,
    "to integer, floor": 2,
    "to integer, toward zero": 2,
}


class Cost(Struct, frozen=True):
    """SYSCLKOUT cycles, from low to high. guessed: based on experience, not on a published figure."""

    low: int
    high: int
    source: str
    guessed: bool = False


def exactly(cycles: int, source: str) -> Cost:
    return Cost(cycles, cycles, source)


def derived(low: int, high: int, source: str) -> Cost:
    """Return a cost derived from published figures of the source's instructions."""
    return Cost(low, high, source)


def guessed(low: int, high: int, source: str) -> Cost:
    return Cost(low, high, source, guessed=True)


class Library(Struct, frozen=True):
    """rom: cycles added by tables in the boot ROM. with_operands: operations whose figure includes loads and stores."""

    name: str
    source: str
    costs: Mapping[str, Cost]
    rom: Mapping[str, int] = field(default_factory=dict)
    with_operands: frozenset[str] = frozenset()
