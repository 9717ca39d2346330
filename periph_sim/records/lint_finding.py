"""What a lint gives and what is made of it: rows of accesses that are at fault --> one finding a place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, Protocol

from .run import Rows, Run


class Fault(NamedTuple):
    """Accesses of one unit that are at fault in one way. rows: theirs, in order. source: the section that says why."""

    unit: str
    rows: Rows
    text: str
    source: str


@dataclass(frozen=True)
class Options:
    """What a user may set. bound: seconds that a wait on one register may take."""

    bound: Fraction = Fraction(20, 1000)


class Lint(Protocol):
    """One file of `lints/`. SAYS: what it looks for, in one sentence; its name is the file's, with hyphens."""

    SAYS: str

    def faults(self, run: Run, options: Options) -> Iterator[Fault]: ...


@dataclass(frozen=True)
class Finding:
    """One place in the firmware with one fault. first: tick of the first time."""

    lint: str
    unit: str
    place: str
    count: int
    first: int
    text: str
    source: str
