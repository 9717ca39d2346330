"""Comparison of the choices for a scene: the errors and the CPU time of each, and a recommendation.

Each choice is a row. The errors of a row are the differences from the most accurate row. CPU time is measured after the
start of the scenes. It is repeated until the rows differ significantly, within limits (FEWEST, MOST, PATIENCE).
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from fractions import Fraction
from itertools import pairwise
from math import inf, isinf
from time import process_time

from ....core.text_table import paragraph, text_table
from ....processor.user_code import output_muted
from ....scene.case.model import BadCase, Case
from ....timing.verdict import duration_text
from .. import REFUSED
from .cost import Cost, cost_of
from .observe import Error, Errors, Observed, built, compare, observe
from .rows import AS_GIVEN, TABLE, Make, Row
from .table_row import Tabulated

FEWEST, MOST = 5, 15  # minimum and maximum number of runs of each row
PATIENCE = 20.0  # in seconds of CPU time; after this time, the measurement is not repeated any more


def costs_of(rows: Mapping[str, tuple[Case, str]], start: Fraction, length: Fraction) -> dict[str, Cost]:
    """Return a dictionary from the names of rows to costs.

    All rows are run once before any row is run again, so that changes of the computer's load affect all rows.

    rows: a dictionary from the names of rows to their cases and the suffixes of their recordings; "" for no recording.
    start: the number of simulated seconds at the start that are not measured.
    length: the number of simulated seconds after `start` that are measured.
    """
    seconds: dict[str, list[float]] = {name: [] for name in rows}
    began = process_time()
    while True:
        for name, (case, record) in rows.items():
            seconds[name].append(_cpu_s(case, record, start, length))
        runs = len(next(iter(seconds.values())))
        if runs >= FEWEST:
            costs = {name: cost_of(found) for name, found in seconds.items()}
            if are_apart([*costs.values()]) or runs >= MOST or process_time() - began > PATIENCE:
                return costs


def are_apart(costs: Sequence[Cost]) -> bool:
    """Return True if each cost differs from every other cost by more than the sum of both spreads."""
    return all(one.is_below(other) for one, other in pairwise(sorted(costs, key=lambda cost: cost.cpu_s)))


def _cpu_s(case: Case, record: str, start: Fraction, length: Fraction) -> float:
    with built(case, record) as scene:
        scene.advance(scene.start + scene.timebase.ticks(start, "nearest"))
        gc.collect()
        began = process_time()
        scene.run(length)
    return (process_time() - began) / float(length)


START, TIMED = Fraction(1, 10), Fraction(1)  # simulated seconds before the measurement of CPU time, and during it


@dataclass(frozen=True)
class Outcome:
    """The errors and the cost of a row."""

    row: Row
    errors: Errors
    cost: Cost

    def fits(self, max_error_s: float) -> bool:
        """Return True if this row can be recommended.

        The row must have no recording, the verdicts of the reference, and no error of a time above `max_error_s`. If
        `max_error_s` is finite, the row must also have no error of values.
        """
        within = self.errors.time.amount <= max_error_s and (isinf(max_error_s) or not self.errors.value.amount)
        return not self.row.record and not self.errors.differ and within


@dataclass(frozen=True)
class Trade:
    """The outcomes of all rows that were run, the reference first.

    refused: a dictionary from the names of the other rows to the reasons why these rows cannot be run.
    ran_s: the simulated seconds over which errors are measured.
    changed: the names of the rows whose errors are different if only half of `ran_s` is simulated.
    start_s: the simulated seconds at the start, which are excluded from CPU times.
    timed_s: the simulated seconds after `start_s` in which CPU times are measured.
    best: the outcome of the recommended row.
    why: the reason for the recommendation, as a phrase.
    """

    case: str
    ran_s: float
    changed: tuple[str, ...]
    start_s: float
    timed_s: float
    outcomes: tuple[Outcome, ...]
    refused: dict[str, str]
    best: Outcome
    why: str


def trade(
    make: Make,
    rows: Sequence[Row],
    length: Fraction,
    max_error_s: float = inf,
    on_progress: Callable[[float], None] | None = None,
) -> Trade:
    """Run and compare all rows, which are the choices for one case.

    All rows without a recording are run for half of `length` seconds and then for `length` seconds. If the errors of
    any row differ between these two runs, all rows without a recording are also run for twice `length` seconds.
    Finally, the errors of rows with a recording and the CPU times of all rows are measured.

    make: a function that returns the case with the changes in a list of texts "key=value".
    max_error_s: the maximum error of times in the recommended row.
    on_progress: a function that is called with the completed share, 0 to 1.

    Raise one of the errors in REFUSED if the most accurate row or the unchanged case cannot be run. Raise BadCase if
    the run of the most accurate row has no verdict, occurrence or data to compare.
    """
    runs = _Runs(make, rows)
    changed: list[str] = []
    ran = length / 2
    with output_muted():
        errors = runs.errors(ran, may_be_empty=True)
        for step, ran in enumerate((length, 2 * length), 2):
            if on_progress is not None:
                on_progress(step / 5)
            before, errors = errors, runs.errors(ran)
            changed = [name for name, one in errors.items() if name in before and one.cells != before[name].cells]
            if not changed:
                break
        start, timed = min(START, length / 2), min(TIMED, length / 2)
        errors |= runs.errors_of_recorded(start + timed, errors[AS_GIVEN])
        costs = costs_of({row.name: (runs.cases[row.name], row.record) for row in runs.running}, start, timed)
    outcomes = [Outcome(row, errors[row.name], costs[row.name]) for row in runs.running]
    best, why = _best(outcomes, max_error_s)
    name = runs.cases[AS_GIVEN].name
    return Trade(name, float(ran), tuple(changed), float(start), float(timed), tuple(outcomes), runs.refused, best, why)


class _Runs:
    """The cases of all rows. refused: a dictionary from the names of rows to the reasons why they cannot be run."""

    def __init__(self, make: Make, rows: Sequence[Row]) -> None:
        self.rows = rows
        self.cases: dict[str, Case] = {}
        self.refused: dict[str, str] = {}
        for row in rows:
            if row.missing:
                self.refused[row.name] = row.missing
                continue
            with self._refusing(row):
                self.cases[row.name] = row.case(make)

    @property
    def running(self) -> list[Row]:
        return [row for row in self.rows if row.name not in self.refused]

    def errors(self, length: Fraction, may_be_empty: bool = False) -> dict[str, Errors]:
        """Return the errors of all rows that write no recording, by the names of the rows.

        may_be_empty: True to accept that the run of the first row has no verdict, occurrence or data to compare. If it
            is False, BadCase is raised in this case.
        """
        found: dict[str, Errors] = {}
        reference: Observed | None = None
        for row in self.running:
            if not row.record:
                with self._refusing(row):
                    run = observe(self.cases[row.name], length)
                    if reference is None and run.is_empty and not may_be_empty:
                        first = duration_text(float(length))
                        raise BadCase(
                            f"case {self.cases[AS_GIVEN].name}: nothing to compare: no budget is judged and nothing is "
                            f"read on I2C in the first {first}; simulate longer with --seconds, or add a budget"
                        )
                    reference = reference or run
                    found[row.name] = compare(reference, run)
        return found

    def errors_of_recorded(self, length: Fraction, unrecorded: Errors) -> dict[str, Errors]:
        """Return the errors of all rows that write a recording, by the names of the rows.

        If recording changes nothing in a run of `length` seconds, the errors are `unrecorded`, which are the errors of
        the unchanged case. Otherwise, the errors are the differences that recording causes.
        """
        found: dict[str, Errors] = {}
        for row in self.running:
            if row.record:
                with self._refusing(row):
                    alone, recorded = (observe(self.cases[row.name], length, record) for record in ("", row.record))
                    error = compare(alone, recorded)
                    is_same = not (error.differ or error.time.amount or error.value.amount)
                    found[row.name] = unrecorded if is_same else error
        return found

    @contextmanager
    def _refusing(self, row: Row) -> Iterator[None]:
        """Store the reason if a row cannot be run. Raise the error for the most accurate row and the unchanged case."""
        try:
            yield
        except REFUSED as error:
            if row.name in (self.rows[0].name, AS_GIVEN):
                raise
            self.refused[row.name] = str(error)


def _best(outcomes: Sequence[Outcome], max_error_s: float) -> tuple[Outcome, str]:
    """Return the outcome to recommend, and the reason as a phrase.

    Only outcomes that fit can be recommended (see `Outcome.fits`). Of those whose cost is not significantly above the
    lowest cost, the most accurate one is returned.
    """
    reference = outcomes[0]
    fitting = [one for one in outcomes if one.fits(max_error_s)]
    cheapest = min(fitting, key=lambda one: one.cost.cpu_s)
    best = next(one for one in fitting if not cheapest.cost.is_below(one.cost))
    if best is reference:
        return best, "it is the most accurate row, and no other run whose budgets all agree with it is cheaper"
    errors = f"errors of times: {best.errors.time.text}, of values: {best.errors.value.text}"
    share = best.cost.cpu_s / reference.cost.cpu_s
    share_text = f"it takes {share:.0%} of the CPU time of {reference.row.name}"
    return best, f"its budgets agree with the most accurate row, and {share_text}; {errors}"


TITLES = ("row", "budgets agree", "time error", "value error", "CPU s/s", "spread")


def text(found: Trade, table: Tabulated | None = None) -> Iterator[str]:
    """Yield the lines of the comparison: a header, a table, notes, and the recommended row.

    table: the cost and the error of the case's closed table, which gives the values of budgets for all starts of rounds
        or frames without a run. They are one more row; None for no such row.
    """
    reference = found.outcomes[0]
    ran, half = duration_text(found.ran_s), duration_text(found.ran_s / 2)
    settled = f"{', '.join(found.changed)} changed since {half}" if found.changed else f"{half} gives the same errors"
    start, timed = duration_text(found.start_s), duration_text(found.timed_s)
    yield from paragraph(
        f"{found.case}: {ran}, n-th occurrence and value against n-th of {reference.row.name}; {settled}"
    )
    yield from paragraph(f"CPU time: {reference.cost.runs} runs of {timed} after the first {start}")
    yield ""
    rows = [_table_row(outcome, outcome is reference) for outcome in found.outcomes]
    if table is not None:
        rows.append(_row_of_table(found, table))
    yield from text_table(TITLES, rows, range(1, 6))
    if table is not None:
        for sentence in table.sentences:
            yield from paragraph(sentence)
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


def _table_row(outcome: Outcome, is_reference: bool) -> tuple[str, ...]:
    agree, time, value = outcome.errors.cells
    cells = (agree, "reference", "reference") if is_reference else (agree, time, value)
    return (outcome.row.name, *cells, *outcome.cost.cells)


def _row_of_table(found: Trade, table: Tabulated) -> tuple[str, ...]:
    """Return the cells of the table, whose errors are those of the unchanged case if it agrees with a run."""
    (given,) = (outcome.errors for outcome in found.outcomes if outcome.row.name == AS_GIVEN)
    agree = len(set(table.budgets).difference(given.differ))
    error = table.error if table.error.amount else given.time
    return (TABLE, f"{agree} of {given.judged}", error.text, "-", *table.cost.cells)


def as_json(found: Trade, table: Tabulated | None = None) -> dict[str, object]:
    """Return the whole comparison as a dictionary for JSON. An infinite error is the text "infinite".

    table: the cost and the error of the case's closed table; None if it was not made.
    """
    return {
        "case": found.case,
        "ran_s": found.ran_s,
        "changed_in_second_half": list(found.changed),
        "start_s": found.start_s,
        "timed_s": found.timed_s,
        "rows": [
            {
                "name": outcome.row.name,
                "changes": list(outcome.row.changes),
                "record": outcome.row.record,
                "budgets": outcome.errors.judged,
                "differ": list(outcome.errors.differ),
                "time_error": _error_as_json(outcome.errors.time),
                "value_error": _error_as_json(outcome.errors.value),
                "cost": asdict(outcome.cost),
            }
            for outcome in found.outcomes
        ],
        "table": None if table is None else asdict(table),
        "refused": found.refused,
        "recommended": found.best.row.name,
        "why": found.why,
    }


def _error_as_json(error: Error) -> dict[str, object]:
    return asdict(error) | ({"amount": "infinite"} if isinf(error.amount) else {})
