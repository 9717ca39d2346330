"""A trade as a table and as JSON."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from itertools import pairwise
from math import isinf

from ....core.text_table import paragraph, text_table
from ....timing.verdict import duration_text
from .observe import Error
from .trade import Outcome, Trade

TITLES = ("row", "budgets agree", "time error", "value error", "CPU s/s", "spread")


def text(found: Trade) -> str:
    """Return the header, the table, notes, and the recommended row."""
    return "\n".join(_lines(found))


def _lines(found: Trade) -> Iterator[str]:
    reference = found.outcomes[0]
    ran, half = duration_text(found.ran_s), duration_text(found.ran_s / 2)
    settled = f"{', '.join(found.changed)} changed since {half}" if found.changed else f"{half} gives the same errors"
    start, timed = duration_text(found.start_s), duration_text(found.timed_s)
    yield from paragraph(
        f"{found.case}: {ran}, n-th occurrence and value against n-th of {reference.row.name}; {settled}"
    )
    yield from paragraph(f"CPU time: {reference.cost.runs} runs of {timed} after the first {start}")
    yield ""
    yield from text_table(TITLES, [_row(outcome, outcome is reference) for outcome in found.outcomes], range(1, 6))
    for outcome in found.outcomes:
        if outcome.errors.differ:
            yield from paragraph(f"{outcome.row.name} judges differently: {', '.join(outcome.errors.differ)}")
    worst = [
        f"{outcome.row.name} in {outcome.errors.time.place}"
        for outcome in found.outcomes
        if outcome.errors.time.amount and not outcome.row.record
    ]
    if worst:
        yield from paragraph(f"largest errors of times: {'; '.join(worst)}")
    for name, why in found.refused.items():
        yield from paragraph(f"{name} is refused: {why}")
    in_order = sorted(found.outcomes, key=lambda outcome: outcome.cost.cpu_s)
    same = [f"{one.row.name} and {two.row.name}" for one, two in pairwise(in_order) if not one.cost.is_below(two.cost)]
    if same:
        yield from paragraph(f"same cost within their spread: {', '.join(same)}")
    yield from paragraph(f"recommended: {found.best.row.name}: {found.why}")


def _row(outcome: Outcome, is_reference: bool) -> tuple[str, ...]:
    cost = outcome.cost
    agree, time, value = outcome.errors.cells
    cells = (agree, "reference", "reference") if is_reference else (agree, time, value)
    return (outcome.row.name, *cells, f"{cost.cpu_s:.3g}", f"{cost.spread_s / cost.cpu_s:.1%}")


def as_json(found: Trade) -> dict[str, object]:
    """Return the whole trade. Infinite errors are the text "infinite"."""
    return {
        "case": found.case,
        "ran_s": found.ran_s,
        "changed_in_second_half": list(found.changed),
        "start_s": found.start_s,
        "timed_s": found.timed_s,
        "rows": [_outcome_as_json(outcome) for outcome in found.outcomes],
        "refused": found.refused,
        "recommended": found.best.row.name,
        "why": found.why,
    }


def _outcome_as_json(outcome: Outcome) -> dict[str, object]:
    errors = outcome.errors
    return {
        "name": outcome.row.name,
        "changes": list(outcome.row.changes),
        "record": outcome.row.record,
        "budgets": errors.judged,
        "differ": list(errors.differ),
        "time_error": _error_as_json(errors.time),
        "value_error": _error_as_json(errors.value),
        "cost": asdict(outcome.cost),
    }


def _error_as_json(error: Error) -> dict[str, object]:
    return asdict(error) | ({"amount": "infinite"} if isinf(error.amount) else {})
