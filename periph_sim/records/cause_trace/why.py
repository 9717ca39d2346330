r"""Causes and effects of the value that a field, wire, span or interrupt has at an instant.

question --> value, the record that gave it --> causes back
                                          \--> next reads, effects and change forward
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...core.records import Kind
from ..run import Rows, Run
from ..subject import RecordedSignal, asked
from .causes import Step, end_of_walk, holders, walk_back, wire_rows
from .firmware_causes import RECORDED

DEPTH = 8  # causes walked back
EFFECTS = 5  # number of shown effects of a record
AS_RESET = "as reset left it"


@dataclass(frozen=True)
class Answer:
    """The answer to a question.

    value: None if it is not known, as for a wire before its first edge. since: the tick from which it had the value; 0
    if it never changed before. back: the record that gave the value, then its causes; for a low wire first the record
    since which its holders have not changed. pulled_by, held_by: for such a wire, the parties that pulled it low and
    those that hold it now. reads: number of recorded reads of the field before the next change. ends: the reason why
    `back` ends.
    """

    run: Run
    subject: RecordedSignal
    tick: int
    value: int | None
    since: int
    back: tuple[Step, ...]
    pulled_by: tuple[str, ...]
    held_by: tuple[str, ...]
    effects: tuple[Step, ...]
    reader: Step | None
    reads: int
    changed: Step | None
    ends: str = ""


def why(run: Run | Path | str, question: str, depth: int = DEPTH) -> Answer:
    """Return the answer to "I2C-A.I2CSTR.XRDY@12.345ms". NotInRun for an unknown name or a time outside the run.

    run: recorded, or the file of one.
    """
    if not isinstance(run, Run):
        run = Run.read(run)
    subject, tick = asked(run, question)
    rows = run.rows(subject.kind, subject.where, subject.what)
    row = run.last(rows, tick)
    after = -1 if row is None else row
    next_row = run.next(rows, after)
    reads = _reads(run, subject, after, next_row)
    value = _value(run, subject, rows, row)
    now, low = row, subject.kind is Kind.EDGE and value == 0 and row is not None
    if low:
        now = run.last(wire_rows(run, subject.where), tick)
    back = () if now is None else tuple(walk_back(run, now, depth))
    return Answer(
        run,
        subject,
        tick,
        value,
        0 if row is None else int(run.table.tick[row]),
        back,
        holders(run, row, run.record(row)) if low and row is not None else (),
        holders(run, now, run.record(now)) if low and now is not None else (),
        _effects(run, row),
        _step(run, int(reads[0])) if len(reads) else None,
        len(reads),
        None if next_row is None else _step(run, next_row),
        end_of_walk(run, back, depth),
    )


def _value(run: Run, subject: RecordedSignal, rows: Rows, row: int | None) -> int | None:
    """Return the subject's value from `row` on; before its first change the reset value, or the wire's first level."""
    if row is not None:
        return int(run.table.value[row])
    if subject.field is not None:
        return subject.field.reset
    if subject.kind is Kind.EDGE:
        return 1 - int(run.table.value[rows[0]] != 0) if len(rows) else None
    if subject.kind is Kind.FLAG:
        return None  # the first value of a variable is not known
    return 0


def _reads(run: Run, subject: RecordedSignal, after: int, until: int | None) -> Rows:
    """Return the recorded reads of the subject's field after row `after` and before row `until`, if that is given."""
    if subject.register is None or subject.field is None:
        return np.empty(0, np.int64)
    rows = run.accesses_of(subject.unit, "R", subject.module, subject.register.name)
    end = np.searchsorted(rows, until) if until is not None else len(rows)
    return run.looking_at(rows[np.searchsorted(rows, after, "right") : end], subject.field)


def _effects(run: Run, row: int | None) -> tuple[Step, ...]:
    """Return the records that name this record as their cause."""
    if row is None:
        return ()
    rows = np.flatnonzero(run.table.cause == run.table.number[row])[:EFFECTS]
    return tuple(_step(run, int(effect)) for effect in rows)


def _step(run: Run, row: int) -> Step:
    return Step(row, run.record(row), RECORDED)
