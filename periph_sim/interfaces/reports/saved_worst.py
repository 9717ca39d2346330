"""The worst occurrences in the saved coverage and proof of a case, run again and explained.

coverage or proof that matches the case --starts, seed--> run --> verdict, explanation
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from ...proof.cover import Worst
from ...proof.coverage_file import Choice, CoverageFile
from ...proof.proof_file import ProofFile
from ...proof.saved_paths import coverage_path, proof_path
from ...proof.stretch import CoveredCase, Job
from ...proof.table_proof import WorstRun
from ...scene.scene import Scene
from ...timing.verdict import Verdict
from .coverage_line import phase_text
from .explain.explain import Explained, explain


class SavedWorst(NamedTuple):
    """The worst occurrence of a budget in a saved result.

    text: a line such as "at phase 1.5700000 ms, the worst of coverage/slave.json:".
    explained: the explanation of the occurrence; None if it has no instant.
    inputs: how the run differs from that of the case, for JSON: {"phases": ..., "seed": ...} for a coverage, or such as
        {"rounds_s": starts in seconds, "changes": ...} for a proof.
    """

    verdict: Verdict
    text: str
    explained: Explained | None
    inputs: dict[str, object]


def saved_worst(case: Path, verdicts: Sequence[Verdict]) -> dict[str, SavedWorst]:
    """Return the worst occurrences of budgets in the saved results of a case, by the names of the budgets.

    The result has only budgets whose saved value is worse than that in `verdicts`. A file that is out of date or not
    complete is not used. Raise BadSavedFile if a file cannot be read.
    """
    coverage = CoverageFile.current(coverage_path(case), case)
    proof = ProofFile.current(proof_path(case), case)
    found: dict[str, SavedWorst] = {}
    for one in verdicts:
        nearest = one
        if coverage is not None and not coverage[1] and coverage[0].is_complete:
            worst = coverage[0].found.worst.get(one.name)
            if worst is not None and _is_nearer(worst.verdict, nearest):
                found[one.name] = _at_phases(case, coverage[0].choice, worst)
                nearest = worst.verdict
        if proof is not None and not proof[1]:
            proven = proof[0].proven.get(one.name)
            if proven is not None and proven.worst.name == one.name and _is_nearer(proven.worst, nearest):
                found[one.name] = _of_proof(case, proof[0], proven)
    return found


def _at_phases(case: Path, choice: Choice, worst: Worst) -> SavedWorst:
    """Return the worst occurrence of a budget in a coverage."""
    covered = CoveredCase(Job(str(case), rounds=choice.rounds))
    scene = covered.scene_of(*covered.phases.inputs(worst.phases), worst.seed)
    text = f"at {phase_text(worst.phases, choice)}, the worst of {coverage_path(case)}:"
    return _again(scene, worst.verdict.name, text, {"phases": list(worst.phases), "seed": worst.seed})


def _of_proof(case: Path, file: ProofFile, proven: WorstRun) -> SavedWorst:
    """Return the worst occurrence of a budget in the runs of a proof."""
    covered = CoveredCase(Job(str(case), proven.changes))
    end = Fraction(proven.until, file.ticks_per_second)
    scene = covered.scene_of(covered.phases.inputs_at(proven.starts, proven.rounds), end, covered.case.seed)
    starts = [start / file.ticks_per_second for start in proven.starts]
    clock = f" and {', '.join(proven.changes)}" if proven.changes else ""
    text = f"in a run whose {file.moved} start at other times{clock}, the worst of {proof_path(case)}:"
    return _again(scene, proven.worst.name, text, {f"{file.moved}_s": starts, "changes": list(proven.changes)})


def _is_nearer(one: Verdict, other: Verdict) -> bool:
    """Return True if the value of `one` is worse: nearer to its limit than that of `other`, or farther beyond."""
    return one.margin is not None and (other.margin is None or one.margin < other.margin)


def _again(scene: Scene, budget: str, text: str, inputs: dict[str, object]) -> SavedWorst:
    """Run the scene of a worst occurrence, and explain it."""
    result = scene.run()
    (verdict,) = (one for one in result.budgets if one.name == budget)
    typical = [one for one in scene.typical() if one.name == budget]
    explained = next(iter(explain(scene.case, [verdict], typical)), None)
    return SavedWorst(verdict, text, explained, inputs)
