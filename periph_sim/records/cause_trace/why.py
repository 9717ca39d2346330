r"""Causes and effects of the value that a field, wire, span, interrupt or variable has at an instant.

question --> value, and the record of the change to this value --> its causes, back in time
                                                             \--> its effects, the next read and the next change
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...core.records import Kind
from ...core.text_table import columns, paragraph, together
from ..record_text import happened_where, number
from ..register_maps import register_of
from ..run import Rows, Run
from ..subject import RecordedSignal, asked
from .causes import RECORDED, Link, end_of_walk, holders, walk_back, wire_rows

DEPTH = 8  # default for the maximum number of causes that are followed back
EFFECTS = 5  # maximum number of effects of a record that are shown
AS_RESET = "as reset left it"
SKIPPED = (
    "note: polls of a wait that is skipped exactly are not recorded, only its first and last passes; "
    "a read above is the next recorded one"
)


@dataclass(frozen=True)
class Answer:
    """The value of a signal at an instant, with its causes and effects: the answer to a question such as "SDA@3us".

    tick: the instant of the question.
    value: the value of the signal; None if it is not known, as for a variable before its first recorded change.
    since: the tick from which the signal had the value; 0 if the signal had not changed before.
    back: the record that gave the value, then the causes of this record; empty if the signal had not changed before.
        For a wire that is low, the first record is instead the last change, up to `tick`, of the set of parties that
        hold the wire low.
    pulled_by: the parties that pulled the wire low at its last fall. It is empty if the signal is no wire, if the wire
        is high at `tick`, or if no fall was recorded.
    held_by: the parties that hold the wire low at `tick`. It is empty in the same cases as `pulled_by`.
    effects: the first records, at most EFFECTS, whose cause is the record that gave the value.
    reader: the first recorded read of the field after the change to the value and before the next change, or None.
    reads: number of recorded reads of the field between these two changes.
    changed: the next change of the signal after `tick`; None if there is none.
    ends: a phrase that says why `back` ends; "" if `back` is empty.
    """

    run: Run
    subject: RecordedSignal
    tick: int
    value: int | None
    since: int
    back: tuple[Link, ...]
    pulled_by: tuple[str, ...]
    held_by: tuple[str, ...]
    effects: tuple[Link, ...]
    reader: Link | None
    reads: int
    changed: Link | None
    ends: str = ""


def why(run: Run | Path | str, question: str, depth: int = DEPTH) -> Answer:
    """Return the answer to a question such as "I2C-A.I2CSTR.XRDY@12.345ms".

    Raise NotInRun if the question is not NAME@TIME, if the name is unknown or ambiguous, if the time is invalid or
    outside the run, or if the file is no recorded run; BadCapture if the recording is damaged.

    run: a recorded run, or its file.
    depth: maximum number of causes that are followed back.
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
    effects = () if row is None else np.flatnonzero(run.table.cause == run.table.number[row])[:EFFECTS].tolist()
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
        tuple(_step(run, effect) for effect in effects),
        _step(run, int(reads[0])) if len(reads) else None,
        len(reads),
        None if next_row is None else _step(run, next_row),
        end_of_walk(run, back, depth),
    )


def _value(run: Run, subject: RecordedSignal, rows: Rows, row: int | None) -> int | None:
    """Return the value that the signal has from the change in `row` on.

    If `row` is None, return the value before the first change: the reset value of a field, the level of a wire, or 0
    for a span or interrupt. Return None for a variable, because its first value is not recorded.
    """
    if row is not None:
        return int(run.table.value[row])
    if subject.field is not None:
        return subject.field.reset
    if subject.kind is Kind.EDGE:
        return 1 - int(run.table.value[rows[0]] != 0) if len(rows) else None
    if subject.kind is Kind.FLAG:
        return None
    return 0


def _reads(run: Run, subject: RecordedSignal, after: int, until: int | None) -> Rows:
    """Return the recorded reads of the signal's field after row `after` and before row `until`.

    If `until` is None, the reads up to the end of the run are returned. The result is empty if the signal is no field.
    """
    if subject.register is None or subject.field is None:
        return np.empty(0, np.int64)
    rows = run.accesses_of(subject.unit, "R", subject.module, subject.register.name)
    end = np.searchsorted(rows, until) if until is not None else len(rows)
    return run.looking_at(rows[np.searchsorted(rows, after, "right") : end], subject.field)


def _step(run: Run, row: int) -> Link:
    return Link(row, run.record(row), RECORDED)


def text(answer: Answer) -> str:
    """Return an answer as text: the value, what the field means, the causes, the effects, the next read and change."""
    run, subject = answer.run, answer.subject
    lines = [f"{subject.name} at {run.at(answer.tick)}: {_value_text(answer)}"]
    register, f = subject.register, subject.field
    if register is not None and f is not None:
        lines += paragraph(f"{f.name}, {f.access}{f': {f.doc}' if f.doc else ''} [{register.source}]", "  ", "    ")
    lines += ["", "back:"]
    if not answer.back:
        lines.append(f"  nothing changed it before; {'it is ' + AS_RESET if subject.field else 'no record of it'}")
    rows = []
    for step in answer.back:
        before = run.length(answer.back[0].record.tick - step.record.tick, step.record.tick, subject.unit) + " before"
        distance = before if step.known else run.at(step.record.tick)
        indent = "  " * step.aside
        known = f"\n{indent}[{step.known}: {step.because}]" if step.known else ""
        rows.append((f"#{step.record.number}", distance, f"{indent}{_with_source(said(run, step))}{known}"))
    lines += columns(rows)
    if answer.ends:
        lines += paragraph(f"the walk ends here: {answer.ends}", "  ", "    ")
    return "\n".join([*lines, "", "forward:", *_forward(answer)])


def as_json(answer: Answer) -> dict[str, object]:
    """Return the answer as a dictionary for JSON, with times in seconds.

    "set_off" has the entries of `Answer.effects`. "next_read" has the entry of `Answer.reader`, the first recorded read
    of the signal's field after its change to the value.
    """
    run, subject = answer.run, answer.subject
    register, f = subject.register, subject.field
    return {
        "subject": subject.name,
        "kind": subject.kind.value,
        "at_s": float(run.seconds(answer.tick)),
        "tick": answer.tick,
        "ticks_per_second": str(run.per_second),
        "cycle_ticks": float(run.cycles.ticks),
        "cycle_from": run.cycles.how,
        "value": answer.value,
        "since_s": float(run.seconds(answer.since)),
        "doc": f.doc if f is not None else None,
        "source": register.source if register is not None else None,
        "pulled_by": list(answer.pulled_by),
        "held_by": list(answer.held_by),
        "back": [_entry(answer, step) for step in answer.back],
        "back_ends": answer.ends or None,
        "set_off": [_entry(answer, step) for step in answer.effects],
        "next_read": None if answer.reader is None else _entry(answer, answer.reader),
        "reads_before_change": answer.reads,
        "next_change": None if answer.changed is None else _entry(answer, answer.changed),
    }


def said(run: Run, step: Link) -> str:
    """Return a record as text.

    For a change of a register's field, the text ends with the section of the manual that describes the register. For a
    rising edge, it ends with the parties that released the wire, if they are known.
    """
    record = step.record
    words = happened_where(record)
    if record.kind is Kind.EDGE and record.value:
        who = ", ".join(holders(run, step.row, record))
        words += f", released by {who}" if who else ""
    if record.kind is not Kind.FLAG:
        return words
    module, name = record.where.rpartition(".")[2], record.what.partition(".")[0]
    register = register_of(module, name)
    return f"{words} [{register.source}]" if register is not None else words


def _with_source(words: str) -> str:
    """Return the text with "[section of the manual]" at its end, if it has one, protected against line breaks."""
    what, bracket, source = words.partition(" [")
    return f"{what} {together(f'[{source}')}" if bracket else words


def _value_text(answer: Answer) -> str:
    if answer.value is None:
        return "not known, it never changed"
    states = {Kind.EDGE: ("low", "high"), Kind.SPAN: ("not in it", "in it"), Kind.IRQ: ("not in it", "in it")}
    kind = answer.subject.kind
    value = states[kind][answer.value != 0] if kind in states else number(answer.value)
    if not answer.back:
        return f"{value}, {AS_RESET}" if kind is Kind.FLAG else f"{value} from the start"
    run = answer.run
    length = run.length(answer.tick - answer.since, answer.since, answer.subject.unit)
    said = f"{value} since {run.at(answer.since)}, {length} before"
    pulled, held = (" and ".join(who) for who in (answer.pulled_by, answer.held_by))
    return said if pulled == held else f"{said}; pulled low first by {pulled}, held now by {held}"


def _forward(answer: Answer) -> list[str]:
    run, since, unit = answer.run, answer.since, answer.subject.unit
    effects = [("set off", step) for step in answer.effects]
    lines = columns(
        [
            (how, f"{run.length(step.record.tick - since, since, unit)} after", _with_source(said(run, step)))
            for how, step in [*effects, ("read", answer.reader), ("changed", answer.changed)]
            if step is not None
        ]
    )
    field = answer.subject.field is not None
    if field:
        until = "that change" if answer.changed is not None else "the end of the run"
        lines.append(
            f"  {answer.reads or 'no'} recorded read{'s' * (answer.reads != 1)} that looked at it before {until}"
        )
    if answer.changed is None:
        lines.append("  it did not change again")
    return [*lines, *paragraph(SKIPPED)] if field else lines


def _entry(answer: Answer, step: Link) -> dict[str, object]:
    record = step.record
    return {
        "record": record.number,
        "at_s": float(answer.run.seconds(record.tick)),
        "tick": record.tick,
        "cycles_from_value": answer.run.clock(answer.subject.unit).cycles(answer.since, record.tick),
        "kind": record.kind.value,
        "where": record.where,
        "what": record.what,
        "value": record.value,
        "text": record.text,
        "said": said(answer.run, step),
        "known": step.known or None,
        "because": step.because or None,
        "cause_of": int(answer.run.table.number[step.of]) if step.of >= 0 else None,
        "aside": step.aside,
    }
