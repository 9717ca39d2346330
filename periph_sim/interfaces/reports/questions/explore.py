"""The runs with other answers.

case as it is     --> the questions that it touches
each other answer --> a run with this answer alone
answers that break nothing alone, two at a time --> a run with both, if
    their questions are related (`Question.is_related`), or
    the second question is touched only with the first answer

An answer *breaks* something if a budget passes in the case as it is but not with this answer, if firmware gets stuck
only with it, or if the run cannot be made. Such an answer is not tried in pairs, because its question must be decided
in any case. The answers that break nothing are tried in the pairs shown above. Three answers at once are never tried. A
question that is touched only in a pair, or only with an answer that breaks something, is not varied;
`Exploration.not_varied` names it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from ....core.phrases import counted
from ....scene.case.model import BadCase
from ....scene.prepared import PreparedScene
from ....scene.result import Result
from ....timing.verdict import FAIL
from ..sweep.runs import Job, Row, rows_of
from ..sweep.sweep import row_batches
from .question import Answer, Question, questions_of

Bars = Callable[[str], AbstractContextManager[Callable[[float], None] | None]]


@dataclass(frozen=True)
class Attempt:
    """A run of the case as it is, or with other answers to questions that TI's manuals leave open.

    answers: the answers that differ from those of the case as it is; empty for the case as it is.
    row: the result of the run, or the reason why the run could not be made.
    """

    answers: tuple[Answer, ...]
    row: Row


@dataclass(frozen=True)
class Exploration:
    """All runs of a case.

    default: the result of the case as it is.
    attempts: the case as it is, the runs with one other answer, then those with two.
    questions: the questions whose answers were varied.
    not_varied: the names of other questions that some run touched, sorted.
    """

    default: Result
    attempts: tuple[Attempt, ...]
    questions: tuple[Question, ...]
    not_varied: tuple[str, ...]

    def count(self, answers: int) -> int:
        """Return how many runs had this number of answers that differ from those of the case as it is: 0, 1 or 2."""
        return sum(len(attempt.answers) == answers for attempt in self.attempts)


def explore(
    file: Path,
    changes: Sequence[str],
    length: Fraction,
    jobs: int | None = None,
    bars: Bars = lambda step: nullcontext(),
    make: Callable[[str, Sequence[str]], Row] | None = None,
) -> Exploration:
    """Run a case as it is and with other answers. The result does not depend on `jobs`.

    changes: the "key=value" texts for all runs.
    length: the duration of each run in seconds.
    jobs: the number of worker processes; None for one per core.
    bars: a function that returns the context of a step, such as "60 pairs". The context yields None, or a function that
        is called with the completed share of the step, 0 to 1.
    make: a function from a case file and its "key=value" texts to the combined result of many runs; None to run the
        case once.

    Raise BadCase if the case has no budget or touches no question, and the errors of a run if the case as it is cannot
    be run.
    """
    scene = PreparedScene(file, changes).scene()
    job = Job(str(file.absolute()), str(file), length, {}, make)
    default = scene.run(length) if make is None else _made(job, changes)
    if not default.budgets:
        raise BadCase(f"{file}: the case has no budget that an answer could break; add one, or leave out --questions")
    if not default.unknowns:
        raise BadCase(f"{file}: the run depends on no undocumented behaviour; leave out --questions")
    workers = jobs or os.cpu_count() or 1

    def made(tried: Sequence[tuple[Answer, ...]], what: str) -> list[Attempt]:
        texts = [[*changes, *(answer.change for answer in answers)] for answers in tried]
        rows: list[Row] = []
        with bars(counted(len(texts), what)) as on_progress:
            for some in row_batches(job, texts, None, min(workers, len(texts))) if texts else ():
                rows += some
                if on_progress is not None:
                    on_progress(len(rows) / len(texts))
        return [Attempt(answers, row) for answers, row in zip(tried, rows, strict=True)]

    questions = questions_of(scene, default.unknowns)
    alone = made([(Answer(one, value),) for one in questions.values() for value in one.others], "answer")
    kept = [attempt for attempt in alone if not breaks(default, attempt.row)]
    tried: list[tuple[Answer, ...]] = [
        (one.answers[0], other.answers[0])
        for number, one in enumerate(kept)
        for other in kept[number + 1 :]
        if one.answers[0].question is not other.answers[0].question
        and one.answers[0].question.is_related(other.answers[0].question)
    ]
    for attempt in kept:
        further = questions_of(scene, sorted(touched_by(attempt.row) - set(default.unknowns)))
        tried += [(*attempt.answers, Answer(one, value)) for one in further.values() for value in one.others]
    pairs = made(tried, "pair")
    varied = {answer.question.name: answer.question for attempt in (*alone, *pairs) for answer in attempt.answers}
    touched = set[str]().union(*(touched_by(attempt.row) for attempt in (*alone, *pairs)))
    not_varied = tuple(sorted(touched - varied.keys()))
    return Exploration(default, (Attempt((), default), *alone, *pairs), tuple(varied.values()), not_varied)


def _made(job: Job, changes: Sequence[str]) -> Result:
    """Return the result of the case as it is. Raise BadCase if the run could not be made."""
    (row,) = rows_of(job, [changes])
    if isinstance(row, str):
        raise BadCase(row)
    return row


def touched_by(row: Row) -> set[str]:
    """Return the names of the questions that a run touched."""
    return set(row.unknowns) if isinstance(row, Result) else set()


def is_stuck(row: Row) -> bool:
    """Return True if a run could not be made, or if it failed because its firmware got stuck."""
    return isinstance(row, str) or (row.verdict == FAIL and bool(row.stuck))


def breaks(default: Result, row: Row) -> bool:
    """Return True if a budget passes in the case as it is but not in `row`, or if `row` is stuck and the case is not.

    default: the result of the case as it is. row: the result of a run with other answers. A run that could not be made
        breaks something, too.
    """
    if isinstance(row, str) or is_stuck(row) > is_stuck(default):
        return True
    return any(one.passed and not other.passed for one, other in zip(default.budgets, row.budgets, strict=True))
