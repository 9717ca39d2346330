"""Option --questions of `run` and `prove`: judge a case with other answers to open questions, and show the verdicts.

An open question is a behaviour that the manuals do not state. An option of the case selects the answer.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path

from ...scene.case.load import load
from ..reports.questions import text_report
from ..reports.questions.dependence import Dependence, dependences
from ..reports.questions.explore import explore
from ..reports.questions.first_difference import first_differences
from ..reports.sweep.runs import Row
from .command_frame import print_json, progress, running_user_code, say


def judge_under_questions(
    command: str,
    case: Path,
    changes: tuple[str, ...],
    length: Fraction | None,
    jobs: int | None,
    as_json: bool,
    make: Callable[[str, Sequence[str]], Row] | None = None,
    left_out: Mapping[str, str] | None = None,
) -> Sequence[Dependence]:
    """Judge a case with other answers. Show and return the verdicts of each budget in all runs.

    command: the command and its option --questions, for the JSON output.
    length: the duration of each run in seconds; None for that of the case.
    make: a function from a case file and its "key=value" texts to the combined result of many runs; None to run the
        case once.
    left_out: the budgets and inputs that are not covered, with the reasons; None for a run, which covers all.
    """
    with running_user_code():
        seconds = load(case, list(changes)).duration if length is None else length
        explored = explore(case, changes, seconds, jobs, progress, make)
        found = dependences(explored)
        differences = first_differences(case, changes, seconds, explored.attempts, found)
    if as_json:
        covered = {} if left_out is None else {"not_covered": left_out}
        print_json(command, text_report.as_json(explored, found, differences) | covered)
    else:
        say(text_report.text(explored, found, differences))
        say(*(f"not covered: {name}: {reason}" for name, reason in (left_out or {}).items()))
    return found
