"""A coverage (runs at many phases) or a closed table (all starts) of a case, in the form of the result of one run.

    case with other answers --phases or starts--> worst value of each budget --> CoveredResult, a Row of an exploration

The result also has, for each worst value, the starts of the run in which it occurs. The first difference is later
searched in a repetition of this run.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from msgspec import Struct

from ....core.phrases import counted
from ....proof.closed_table import Contradiction
from ....proof.cover import Coverer
from ....proof.free_run import NotClosed
from ....proof.near import chosen_phases, parts_of
from ....proof.stretch import RUN_ERRORS, CoveredCase, Job
from ....proof.table_proof import TableProof, prove
from ....scene.case.inputs_table import InputsTable
from ....scene.result import Result
from ....timing.verdict import FAIL, NOT_JUDGED, PASS, PROVEN, Verdict
from .. import REFUSED
from ..coverage import PART
from ..sweep.runs import Row
from ..witness import input_texts

# A run of a case with given starts: the "key=value" texts of the starts and, in a coverage, of the seed; and the
# duration in seconds.
StartedRun = tuple[tuple[str, ...], Fraction]


@dataclass
class CoveredResult(Result):
    """The result of a coverage or of a table. Its budgets have their worst values of all runs.

    is_table: True for a table.
    what: the number of phases, or of starts, as text.
    runs: a dictionary from each budget to the run with its worst value.
    """

    is_table: bool = False
    what: str = ""
    runs: dict[str, StartedRun] = field(default_factory=dict)


class Cover(Struct, frozen=True):
    """The way to run a case with each answer to an open question: at many phases, or with a closed table.

    The glossary in `periph_sim.proof` has the terms.

    step: the distance between two chosen phases that are not near a write of the firmware, in cycles.
    only: the times, in seconds, between which phases are chosen; None for all phases of a period.
    rounds: the number of moved starts in a run with one phase alone.
    start_up: True to move the first start through the start-up.
    table: True to prove the budgets for all starts with a closed table; False to run the case at the chosen phases.
    """

    step: int
    only: tuple[Fraction, Fraction] | None
    rounds: int
    start_up: bool
    table: bool

    def row(self, file: str, changes: Sequence[str]) -> Row:
        """Return the result for a case with "key=value" texts, or a sentence that says why there is none."""
        try:
            job = Job(file, tuple(changes), self.start_up, self.rounds)
            return _of_table(prove(job)) if self.table else self._of_phases(CoveredCase(job))
        except NotClosed as error:
            return f"{file}: it has no closed table: {error}"
        except (*REFUSED, *RUN_ERRORS, Contradiction) as error:
            return str(error)

    def _of_phases(self, case: CoveredCase) -> CoveredResult:
        bounds = (0, case.phases.count - 1) if self.only is None else case.phases.between(*self.only)
        chosen, _ = chosen_phases(case, self.step, bounds)
        coverer = Coverer(case, case.case.seed)
        for part in parts_of(chosen, PART):
            coverer.cover(part)
        found, runs = coverer.found, {}
        for name, worst in found.worst.items():
            inputs, length = case.phases.inputs(worst.phases)
            runs[name] = (*_texts(case, inputs), f"seed={worst.seed}"), length
        failed = {name for names in found.failed.values() for name in names}
        failed |= {name for one in found.drifting for name in one.names}
        worst_of = {name: one.verdict for name, one in found.worst.items()}
        result = _result(case, worst_of, failed, found.reasons, runs)
        return replace(result, what=counted(len(chosen), "phase"))


def _of_table(made: TableProof) -> CoveredResult:
    case, words, worst, runs = made.covered, made.words(), made.worst(), {}
    for name, one in worst.items():
        one.verdict.proven = words[name] == PROVEN
        run = one.run()
        texts = _texts(case, case.phases.inputs_at(run.starts, run.rounds))
        runs[name] = tuple(texts), Fraction(run.until, case.phases.ticks_per_second)
    outcome = made.parts[-1].table.outcomes[-1]
    verdicts = {name: one.verdict for name, one in worst.items()}
    result = _result(case, verdicts, outcome.failures, outcome.reasons, runs)
    return replace(result, what=counted(made.entries, "start"), is_table=True)


def _result(
    case: CoveredCase,
    worst: dict[str, Verdict],
    failed: Iterable[str],
    reasons: dict[str, str],
    runs: dict[str, StartedRun],
) -> CoveredResult:
    """Return the result of runs. failed: the names of what failed, as in `Outcome`."""
    verdicts = [
        worst.get(one.name) or Verdict(one.name, one.measure, "", None, 0, None, 0, NOT_JUDGED, None)
        for one in case.case.budget
    ]
    stuck = [reason for name, reason in reasons.items() if name in failed]
    passed = all(verdict.passed for verdict in verdicts) and not stuck
    return CoveredResult(
        case=case.case.name,
        verdict=PASS if passed else FAIL,
        simulated_s=0.0,
        wall_s=0.0,
        events=0,
        wire_bytes=0,
        sci_bytes=0,
        budgets=verdicts,
        counts={},
        unknowns=sorted(case.unknowns),
        notes=[],
        stuck=stuck,
        runs=runs,
    )


def _texts(case: CoveredCase, inputs: InputsTable) -> list[str]:
    """Return the starts of a run as "key=value" texts."""
    return [f"inputs.{key}={json.dumps(value)}" for key, value in input_texts(case, inputs).items()]
