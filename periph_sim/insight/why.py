r"""Why a field, wire, span or interrupt stood as it did at an instant: what it came from, and what came of it.

question --> value, the record that gave it --> causes back
                                          \--> next reads, effects and change forward
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..core.records import Kind
from .causes import RECORDED, Step, walk_back
from .run import Rows, Run
from .subject import Subject, asked

DEPTH = 8  # causes walked back
EFFECTS = 5  # shown of those that a record set off
AS_RESET = "as reset left it"


@dataclass(frozen=True)
class Answer:
    """value: None where nothing is known, as of a wire before its first edge. back: the record that gave the value,
    then its causes. reads: how many recorded reads before the next change."""

    run: Run
    subject: Subject
    tick: int
    value: int | None
    back: tuple[Step, ...]
    effects: tuple[Step, ...]
    reader: Step | None
    reads: int
    changed: Step | None

    @property
    def since(self) -> int:
        """The tick from which on it had the value; 0 where it never changed before."""
        return self.back[0].record.tick if self.back else 0


def why(run: Run, question: str, depth: int = DEPTH) -> Answer:
    """The answer to "I2C-A.I2CSTR.XRDY@12.345ms". NotInRun for an unknown name or a time outside the run."""
    subject, tick = asked(run, question)
    rows = run.rows(subject.kind, subject.where, subject.what)
    row = run.last(rows, tick)
    value: int | None
    if row is not None:
        value = int(run.table.value[row])
    elif subject.field is not None:
        value = subject.field.reset
    elif subject.kind is Kind.EDGE and len(rows):
        value = 1 - int(run.table.value[rows[0]] != 0)
    else:
        value = None if subject.kind is Kind.EDGE else 0
    after = -1 if row is None else row
    next_row = run.next(rows, after)
    reads = _reads(run, subject, after, next_row)
    return Answer(
        run,
        subject,
        tick,
        value,
        tuple(walk_back(run, row, depth)) if row is not None else (),
        _effects(run, row),
        _step(run, int(reads[0])) if len(reads) else None,
        len(reads),
        None if next_row is None else _step(run, next_row),
    )


def _reads(run: Run, subject: Subject, after: int, until: int | None) -> Rows:
    """The recorded reads of the field's register between two of its changes."""
    if subject.register is None:
        return np.empty(0, np.int64)
    rows = run.accesses_of(subject.unit, "R", subject.module, subject.register.name)
    end = np.searchsorted(rows, until) if until is not None else len(rows)
    return rows[np.searchsorted(rows, after, "right") : end]


def _effects(run: Run, row: int | None) -> tuple[Step, ...]:
    """What names this record as its cause."""
    if row is None:
        return ()
    rows = np.flatnonzero(run.table.cause == run.table.number[row])[:EFFECTS]
    return tuple(_step(run, int(effect)) for effect in rows)


def _step(run: Run, row: int) -> Step:
    return Step(row, run.record(row), RECORDED)
