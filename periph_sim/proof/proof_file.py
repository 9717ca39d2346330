"""The file of a proof: proofs/NAME.json beside the case, with the proven budgets and everything they depend on.

    StartTable --proof_of--> ProofFile --text_of--> file --current--> the proven budgets, for `run`, `check` and pytest

Only a closed table is saved. A proof holds for the case as it is in the file: a changed dependency ends it.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Literal

from msgspec import Struct

from ..core.phrases import counted
from ..timing.verdict import Verdict
from . import saved_file
from .closed_table import StartTable
from .dependencies import Dependencies
from .saved_paths import proof_path
from .stretch import CoveredCase

RENEW = "write it again with prove --table --save"
TOO_LITTLE = "too little was measured to judge it"


class ProvenBudget(Struct, frozen=True):
    """A proven budget.

    worst: the worst value of all starts.
    starts: the starts of a run with this value, up to the value itself, in ticks from the start of the run.
    until: the tick at which this run ends.
    """

    worst: Verdict
    starts: tuple[int, ...]
    until: int


class ProofFile(Struct, frozen=True, kw_only=True):
    """The contents of a proof file.

    case: the name of the case.
    moved: what starts, "rounds" or "frames".
    ticks_per_second: the length of a tick.
    first: the first start, in ticks from the start of the run.
    apart: the least distance of two starts for which the proof holds, in ticks.
    starts: the number of starts in the table, all of which were run.
    again: the number of starts that were run again, and compared.
    proven: a dictionary from each proven budget to its worst value.
    not_proven: a dictionary from each other budget of the case to the reason.
    """

    version: Literal[1] = 1
    case: str
    moved: str
    ticks_per_second: int
    first: int
    apart: int
    starts: int
    again: int
    proven: dict[str, ProvenBudget]
    not_proven: dict[str, str]
    dependencies: Dependencies

    @property
    def line(self) -> str:
        """A sentence with the number of proven budgets, and the starts for which the proof holds."""
        of = len(self.proven) + len(self.not_proven)
        apart = 1000 * Fraction(self.apart, self.ticks_per_second)
        starts = f"all sequences of {self.moved} that start at least {float(apart):.4f} ms apart"
        return f"{len(self.proven)} of {counted(of, 'budget')} proven for {starts}"


def proof_of(table: StartTable, covered: CoveredCase, dependencies: Dependencies) -> ProofFile:
    """Return the contents of the proof file for a closed table."""
    not_proven = covered.not_whole | table.not_proven(covered)
    proven: dict[str, ProvenBudget] = {}
    worst = table.worst()
    for budget in covered.case.budget:
        found = worst.get(budget.name)
        if found is None or not found.verdict.passed:
            not_proven.setdefault(budget.name, TOO_LITTLE)
        elif budget.name not in not_proven:
            starts, until = table.run_of(found, covered.phases.ticks_per_second)
            proven[budget.name] = ProvenBudget(found.verdict, tuple(starts), until)
    return ProofFile(
        case=covered.case.name,
        moved=covered.phases.moved,
        ticks_per_second=covered.phases.ticks_per_second,
        first=covered.phases.first_start(),
        apart=table.apart,
        starts=table.entries,
        again=table.again,
        proven=proven,
        not_proven=not_proven,
        dependencies=dependencies,
    )


def read(path: Path) -> ProofFile | None:
    """Return the contents of a proof file; None if there is no file. Raise BadSavedFile if it is no proof."""
    return saved_file.read(path, ProofFile, "proof", RENEW)


def current(case: Path) -> tuple[ProofFile, list[str]] | None:
    """Return the proof file of a case, with a phrase for each changed dependency; None if there is no file.

    Raise BadSavedFile for a file that cannot be read.
    """
    return saved_file.current(read(proof_path(case)), case)
