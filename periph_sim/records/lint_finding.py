"""Lints, the faults that they report, and findings: one for each place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..core.registers import Register
from .run import Group, Rows, Run


class Fault(NamedTuple):
    """Accesses of one unit with one kind of fault.

    rows: the accesses at fault, in order; empty if there is no fault.
    source: the section of the manual that gives the rule.
    """

    unit: str
    rows: Rows
    text: str
    source: str


@dataclass(frozen=True)
class Options:
    """Options of lints. bound: seconds that a wait on one register may take."""

    bound: Fraction = Fraction(20, 1000)


class Lint(Protocol):
    """A module in `lints/`. SAYS: what the lint finds, in one sentence. Its name is that of the file, with hyphens."""

    SAYS: str

    def faults(self, run: Run, options: Options) -> Iterator[Fault]: ...


@dataclass(frozen=True)
class Finding:
    """One fault at one place in the firmware. first: the tick at which it occurred first."""

    lint: str
    unit: str
    place: str
    count: int
    first: int
    text: str
    source: str


def accesses(run: Run, way: str, register: Register) -> Iterator[Group]:
    """Yield the accesses of one way ("R" or "W") to a register, by unit and module."""
    return (group for group in run.accesses if group.way == way and group.register is register)


def held(run: Run, group: Group, register: Register, name: str) -> NDArray[np.bool_]:
    """Return True for each access of a group at which a field of the same module was 1."""
    found: NDArray[np.bool_] = run.values(group.unit, group.module, register, register[name], group.rows) == 1
    return found
