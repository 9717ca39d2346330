"""Lints, the faults that they report, and findings: one for each place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, Protocol

from .run import Rows, Run


class Fault(NamedTuple):
    """Accesses of one unit with one kind of fault. rows: in order. source: the section of the manual that says why."""

    unit: str
    rows: Rows
    text: str
    source: str


@dataclass(frozen=True)
class Options:
    """Options of lints. bound: seconds that a wait on one register may take."""

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
