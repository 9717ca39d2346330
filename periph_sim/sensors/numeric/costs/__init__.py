"""What an operation costs on the F28335: one file a library, cycles with the source of each figure.

A cost is a range: a published figure is both its ends; where nothing was published the ends are a stated guess.
A figure holds for code and data in memory without wait states. Tables of a library may lie in the boot ROM, which has
one: what that adds is listed apart. Loading operands and storing results is listed apart too, as an assumption.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from msgspec import Struct, field

Tables = Literal["RAM", "boot ROM"]

# Numbers that an operation takes and gives.
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
    """SYSCLKOUT cycles, from low to high. guessed: no published figure is behind it, only experience."""

    low: int
    high: int
    source: str
    guessed: bool = False


def exactly(cycles: int, source: str) -> Cost:
    return Cost(cycles, cycles, source)


def derived(low: int, high: int, source: str) -> Cost:
    """From published figures of the instructions that the source names."""
    return Cost(low, high, source)


def guessed(low: int, high: int, source: str) -> Cost:
    return Cost(low, high, source, guessed=True)


class Library(Struct, frozen=True):
    """rom: what tables in the boot ROM add. with_operands: operations whose figure has loads and stores in it."""

    name: str
    source: str
    costs: Mapping[str, Cost]
    rom: Mapping[str, int] = field(default_factory=dict)
    with_operands: frozenset[str] = frozenset()
