"""Verdicts under open questions as text and as JSON. A run with other answers is named by its number: `[12]`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ....core.phrases import counted
from ....core.text_table import paragraph, text_table
from ....scene.result import Result
from ....timing.verdict import PROVEN, SEEN, figure, limit, simulated
from .covered_rows import CoveredResult
from .dependence import Departure, Dependence
from .explore import Exploration
from .first_difference import FirstDifference
from .question import Question

Differences = Mapping[int, FirstDifference | None]  # first differences by the numbers of runs
HOLDS_AT = "holds: at these phases, in the states that their runs reached"
PROVEN_FOR = "proven: for all starts that `prove --table` names, with the clocks, rates and data of the case"
MOST_NAMED = 6  # maximum number of runs that are named for a budget


def text(explored: Exploration, found: Sequence[Dependence], differences: Differences) -> str:
    """Format the report.

    It says what was run, and lists the budgets, the runs in which a verdict differs, and the questions of these runs
    with the experiments that would decide them.
    """
    result, attempts = explored.default, explored.attempts
    alone, pairs = counted(explored.count(1), "other answer"), counted(explored.count(2), "pair")
    lines = paragraph(
        f"{result.case}: {_attempts(result, len(attempts))}: the case as it is, "
        f"{alone} one at a time, and {pairs}, to {counted(len(explored.questions), 'open question')}"
    )
    rows = [_row(one) for one in found]
    lines += ["", *text_table(("budget", "limit", "worst", "with other answers"), rows, (1, 2)), ""]
    lines += paragraph(
        f"worst: of all these {_kind(result)}s. Besides single answers, pairs were tried of related answers that break "
        "nothing alone, and of an answer with those to the questions that arise only with it. "
        "Other combinations were not tried."
    )
    if isinstance(result, CoveredResult) and not result.is_table:
        lines += paragraph(HOLDS_AT)
    elif any(one.word == PROVEN for one in found):
        lines += paragraph(PROVEN_FOR)
    if explored.not_varied:
        names = ", ".join(explored.not_varied)
        lines += paragraph(f"Not varied, because only a pair, or an answer that breaks something, uses them: {names}")
    questions: dict[str, Question] = {}
    for number, difference in differences.items():
        answers = attempts[number].answers
        questions |= {answer.question.name: answer.question for answer in answers}
        lines += ["", *paragraph("; ".join(map(str, answers)), f"[{number}] ", "    ")]
        lines += paragraph(f"first difference: {_difference(difference, len(answers))}", "    ", "    ")
    more = {departure.number for one in found for departure in one.departures} - differences.keys()
    lines += ["", f"{counted(len(more), 'more run')} with other verdicts; --json lists them"] if more else []
    lines += ["", "Questions to decide, and how:"] if questions else []
    for name, one in questions.items():
        lines += paragraph(f"{name}: {one.text} {one.experiment}".rstrip(), "  ", "    ")
    return "\n".join(lines)


def _kind(result: Result) -> str:
    if not isinstance(result, CoveredResult):
        return "run"
    return "table" if result.is_table else "coverage"


def _attempts(result: Result, number: int) -> str:
    """Return a phrase with the number of attempts, and what each of them is."""
    each = result.what if isinstance(result, CoveredResult) else simulated(result.simulated_s)
    return f"{counted(number, _kind(result))} of {each}"


def _row(one: Dependence) -> tuple[str, ...]:
    """Return the cells of a budget."""
    worst = one.worst
    cells = (
        ("", "") if worst is None else (limit(worst.limit, worst.unit, worst.which), figure(worst.worst, worst.unit))
    )
    if not one.departures:
        word = "holds" if one.word == SEEN else one.word
        return one.name, *cells, f"{word} whatever the answers are"
    said = [_departure(departure) for departure in one.departures[:MOST_NAMED]]
    more = len(one.departures) - len(said)
    listed = "; ".join([*said, *([f"{more} more"] if more else [])])
    return one.name, *cells, f"depends on {listed}" if one.word == SEEN else f"{one.word} as it is; {listed}"


def _departure(one: Departure) -> str:
    word = "holds" if one.word == SEEN else one.word
    return f"[{one.number}]: {word}{f' ({one.found})' if one.found not in ('', '-') else ''}"


def _difference(found: FirstDifference | None, answers: int) -> str:
    """Return a first difference as a phrase. answers: the number of other answers."""
    if found is None:
        return "none in edges, accesses, flags and interrupts"
    base, other = found
    on_base, on_other = ("as it is", "with this answer") if answers == 1 else ("with the first alone", "with both")
    if base is not None and other is not None and base.text == other.text:
        return f"{base.text}: at {base.at} {on_base}, at {other.at} {on_other}"
    ends = ((base, on_base), (other, on_other))
    return "; ".join(f"{'nothing' if one is None else f'{one.text} at {one.at}'} {when}" for one, when in ends)


def as_json(explored: Exploration, found: Sequence[Dependence], differences: Differences) -> dict[str, object]:
    """Convert the report to JSON. Numbers of runs are indices of `runs`; run 0 is the case as it is."""
    return {
        "case": explored.default.case,
        "simulated_s": explored.default.simulated_s,
        "questions": {
            one.name: {
                "question": one.text,
                "experiment": one.experiment,
                "registers": sorted(one.registers),
                "default": one.default,
                "others": one.others,
            }
            for one in explored.questions
        },
        "not_varied": explored.not_varied,
        "runs": [
            {
                "answers": {answer.question.name: answer.value for answer in attempt.answers},
                "verdict": attempt.row.verdict if isinstance(attempt.row, Result) else "error",
                "first_difference": _difference_as_json(differences.get(number)),
            }
            for number, attempt in enumerate(explored.attempts)
        ],
        "budgets": {
            one.name: {
                "holds": one.holds,
                "verdict": one.word,
                "worst": None if one.worst is None else one.worst.worst,
                "unit": "" if one.worst is None else one.worst.unit,
                "departures": [each._asdict() for each in one.departures],
            }
            for one in found
        },
    }


def _difference_as_json(found: FirstDifference | None) -> object:
    if found is None:
        return None
    ends = zip(("base", "other"), found, strict=True)
    return {name: None if one is None else {"at_s": one.at_s, "event": one.text} for name, one in ends}
