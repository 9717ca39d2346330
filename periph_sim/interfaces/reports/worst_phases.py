"""The worst occurrences at the phases of a coverage file, which are run again and explained.

coverage file that matches the case --phases, seed--> run --> verdict, explanation
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from ...proof.cover import Worst
from ...proof.coverage_file import Choice, current
from ...proof.coverage_path import path_for
from ...proof.stretch import CoveredCase, Job
from ...timing.verdict import Verdict
from .coverage_line import phase_text
from .explain.explain import Explained, explain


class WorstAtPhase(NamedTuple):
    """The worst occurrence of a budget at the phases of a coverage file.

    text: a line that names the phase, or all phases of the run if the run has several.
    explained: the explanation of the occurrence; None if it has no instant.
    phases, seed: the run in which it occurs, as in `Worst`.
    """

    verdict: Verdict
    text: str
    explained: Explained | None
    phases: tuple[int, ...]
    seed: int


def worst_at_phases(case: Path, verdicts: Sequence[Verdict]) -> dict[str, WorstAtPhase]:
    """Return a dictionary from the names of budgets to their worst occurrences at the phases of the coverage file.

    It contains only budgets whose value in the file is nearer to the limit, or farther beyond it, than the value in
    `verdicts`. It is empty if no complete coverage file matches the case.
    """
    saved = current(case)
    if saved is None or saved[1] or not saved[0].is_complete:
        return {}
    nearer = [
        saved[0].found.worst[one.name]
        for one in verdicts
        if one.name in saved[0].found.worst and _is_nearer(saved[0].found.worst[one.name].verdict, one)
    ]
    covered = CoveredCase(Job(str(case.absolute()), rounds=saved[0].choice.rounds)) if nearer else None
    return {} if covered is None else {one.verdict.name: _again(case, covered, one, saved[0].choice) for one in nearer}


def _is_nearer(one: Verdict, other: Verdict) -> bool:
    return one.margin is not None and (other.margin is None or one.margin < other.margin)


def _again(case: Path, covered: CoveredCase, worst: Worst, choice: Choice) -> WorstAtPhase:
    """Run the phases of a worst occurrence again, and explain it."""
    scene = covered.scene(worst.phases, worst.seed)
    result = scene.run()
    (verdict,) = (one for one in result.budgets if one.name == worst.verdict.name)
    typical = [one for one in scene.typical() if one.name == verdict.name]
    explained = next(iter(explain(scene.case, [verdict], typical)), None)
    text = f"at {phase_text(worst.phases, choice)}, the worst of {path_for(case)}:"
    return WorstAtPhase(verdict, text, explained, worst.phases, worst.seed)
