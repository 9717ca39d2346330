"""Levels of fidelity as changes of a case: each word that `fidelity` takes, and the case's own table."""

from __future__ import annotations

from dataclasses import dataclass

from ...scene.case.fidelity import LEVELS, fidelity_text
from ...scene.case.model import Case

REFERENCE = "edge"
SAME_RECORDS = (REFERENCE, "adaptive")  # as edge in every scene (tests/scene/test_adaptive.py)


@dataclass(frozen=True)
class Level:
    """changes: of the case, as `--set` has them. same_records: as the reference has, in every scene."""

    name: str
    changes: tuple[str, ...]
    same_records: bool = False


def level_of(fidelity: str) -> Level:
    return Level(fidelity, (f"fidelity={fidelity}",), fidelity in SAME_RECORDS)


def fidelities_of(case: Case) -> tuple[Level, ...]:
    """Return the reference, the other words, and the case as it is where it has a level for each bus."""
    others = [level_of(name) for name in LEVELS if name != REFERENCE]
    if isinstance(case.fidelity, str):
        return (level_of(REFERENCE), *others)
    same = all(level in SAME_RECORDS for level in case.fidelity.values())
    return (level_of(REFERENCE), *others, Level(fidelity_text(case.fidelity), (), same))
