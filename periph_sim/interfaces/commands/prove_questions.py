"""`periph-sim prove --questions`: judge a case at many phases, or by its table, with other answers to open questions.

An open question is a behaviour that the manuals do not state. An option of the case selects the answer.
"""

from __future__ import annotations

from pathlib import Path

from ...proof.stretch import CoveredCase, Job
from ...scene.case.load import load
from ...timing.verdict import PROVEN
from ..reports.questions import text_report
from ..reports.questions.covered_rows import Cover
from ..reports.questions.dependence import RUN, dependences
from ..reports.questions.explore import explore
from ..reports.questions.first_difference import first_differences
from .command_frame import print_json, progress, running_user_code, say


def prove_under_questions(case: Path, changes: tuple[str, ...], cover: Cover, jobs: int | None, as_json: bool) -> int:
    """Judge a case with other answers to open questions, and show the verdicts.

    cover: the values of --step, --phases, --rounds, --start-up and --table.

    Return the exit status: 0 if every covered budget holds (with a table: is proven) with every answer, and no run
    is stuck or cannot be made; else 1.
    """
    with running_user_code():
        duration = load(case, list(changes)).duration
        explored = explore(case, changes, duration, jobs, progress, cover.row)
        found = dependences(explored)
        differences = first_differences(case, changes, duration, explored.attempts, found)
        left_out = CoveredCase(Job(str(case), changes, cover.start_up, cover.rounds)).left_out
    if as_json:
        print_json("prove --questions", text_report.as_json(explored, found, differences) | {"not_covered": left_out})
    else:
        say(text_report.text(explored, found, differences))
        say(*(f"not covered: {name}: {reason}" for name, reason in left_out.items()))
    return int(not all(one.holds and (not cover.table or one.word == PROVEN or one.name == RUN) for one in found))
