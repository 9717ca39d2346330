"""Lints: checks of what firmware did in a recorded run.

Every function in `lints/` that has the decorator `finds` is a lint.

Run --each lint--> faults, which are rows --> findings, one for each place and fault --> text, JSON
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..core.discover import modules_with
from ..core.phrases import counted
from ..core.registers import Register
from . import lints
from .run import Group, Rows, Run


class Fault(NamedTuple):
    """Faulty accesses, or entries of service routines, of one unit, all with the same kind of fault.

    rows: the rows of their records. A fault without rows is not reported.
    text: what is wrong with them.
    source: the section of the manual that gives the violated rule; "" if it is not known.
    """

    unit: str
    rows: Rows
    text: str
    source: str


@dataclass(frozen=True)
class Options:
    """Options of lints. bound: the longest time in seconds that a wait in a polling loop may take."""

    bound: Fraction = Fraction(20, 1000)


Faults: TypeAlias = "Callable[[Run, Options], Iterator[Fault]]"


class Lint(NamedTuple):
    """A rule that firmware can violate.

    says: a phrase that describes the faults that the lint finds.
    faults: the function that yields the faults of a run.
    """

    says: str
    faults: Faults


_LINTS: dict[str, Lint] = {}


@dataclass(frozen=True)
class Finding:
    """All faults of one kind at one place in the firmware.

    count: the number of the faulty accesses or entries.
    first: the tick of the first of them.
    """

    lint: str
    unit: str
    place: str
    count: int
    first: int
    text: str
    source: str


def finds(says: str) -> Callable[[Faults], Faults]:
    """Return a decorator that registers a function as a lint. `flag_wiped` becomes the lint "flag-wiped".

    says: a phrase that describes the faults that the lint finds.
    """

    def register(faults: Faults) -> Faults:
        _LINTS[faults.__name__.replace("_", "-")] = Lint(says, faults)
        return faults

    return register


@cache
def all_lints() -> dict[str, Lint]:
    """Return a dictionary from the names of all lints to the lints, in the order of the names."""
    modules_with("finds", lints.__name__, lints.__path__)
    return dict(sorted(_LINTS.items()))


def lint(run: Run | Path | str, options: Options | None = None) -> list[Finding]:
    """Return the findings of all lints, in the order of their first occurrence. run: a recorded run, or its file."""
    if not isinstance(run, Run):
        run = Run.read(run)
    found = []
    for name, one in all_lints().items():
        for fault in one.faults(run, options or Options()):
            for place, rows in run.by_place(fault.rows):
                first = int(run.table.tick[rows].min())
                found.append(Finding(name, fault.unit, place, len(rows), first, fault.text, fault.source))
    return sorted(found, key=lambda finding: (finding.first, finding.lint, finding.place))


def accesses(run: Run, way: str, register: Register) -> Iterator[Group]:
    """Yield the reads (way "R") or writes ("W") of a register, one group for each unit and module."""
    return (group for group in run.accesses if group.way == way and group.register is register)


def held(run: Run, group: Group, register: Register, name: str) -> NDArray[np.bool_]:
    """Return, for each access of a group, True if a field of the same module was 1 just before the access.

    register, name: the register with the field, and the name of the field.
    """
    found: NDArray[np.bool_] = run.values(group.unit, group.module, register, register[name], group.rows) == 1
    return found


def text(run: Run, findings: list[Finding]) -> str:
    """Return the findings as text, with the total at the end.

    Each finding has its place, what is wrong, the section of the manual if it is known, its lint, its count and its
    first time.
    """
    lines = []
    for f in findings:
        times = "once" if f.count == 1 else f"{f.count} times, first"
        source = f" [{f.source}]" if f.source else ""
        lines.append(f"{' '.join(filter(None, (f.unit, f.place)))}: {f.text}{source}")
        lines.append(f"  {f.lint}, {times} at {run.at(f.first)}")
    places = counted(len(findings), "finding") if findings else "nothing found"
    return "\n".join([*lines, f"{run.name}: {places} by {len(all_lints())} lints"])


def as_json(run: Run, findings: list[Finding]) -> dict[str, object]:
    """Return the findings for JSON, with times in seconds."""
    return {
        "run": run.name,
        "lints": {name: one.says for name, one in all_lints().items()},
        "findings": [
            {
                "lint": f.lint,
                "unit": f.unit,
                "place": f.place,
                "count": f.count,
                "first_s": float(run.seconds(f.first)),
                "text": f.text,
                "source": f.source,
            }
            for f in findings
        ],
    }
