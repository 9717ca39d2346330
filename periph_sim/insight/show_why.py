"""An answer to "why" as a person reads it, and as JSON; floats appear here and nowhere before."""

from __future__ import annotations

from collections.abc import Sequence

from ..core.records import Kind, Record
from .causes import Step, holders
from .maps import register_of
from .run import Run
from .why import AS_RESET, Answer

SKIPPED = (
    "note: polls of a wait that is skipped exactly are not recorded, only its first and last passes; "
    "a read above is the next recorded one"
)


def text(answer: Answer) -> str:
    """What it was and since when, its meaning, the causes back, and forward who read it and when it changed."""
    run, subject = answer.run, answer.subject
    lines = [f"{subject.name} at {run.at(answer.tick)}: {_value(answer)}", *_meaning(answer), "", "back:"]
    if not answer.back:
        lines.append(f"  nothing changed it before; {'it is ' + AS_RESET if subject.field else 'no record of it'}")
    at = answer.back[0].record.tick if answer.back else 0
    rows = []
    for step in answer.back:
        distance = run.length(at - step.record.tick) + " before" if step.known else run.at(step.record.tick)
        known = f"[{step.known}: {step.because}]" if step.known else ""
        rows.append((f"#{step.record.number}", distance, said(run, step), known))
    lines += aligned(rows)
    return "\n".join([*lines, "", "forward:", *_forward(answer)])


def as_json(answer: Answer) -> dict[str, object]:
    """Times in seconds as numbers, and in ticks; `back` begins with the record that gave the value."""
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
        "back": [_entry(answer, step) for step in answer.back],
        "set_off": [_entry(answer, step) for step in answer.effects],
        "next_read": None if answer.reader is None else _entry(answer, answer.reader),
        "reads_before_change": answer.reads,
        "next_change": None if answer.changed is None else _entry(answer, answer.changed),
    }


def said(run: Run, step: Step) -> str:
    """One record in words."""
    record = step.record
    source = ""
    if record.kind is Kind.FLAG:
        module, _, name = record.where.rpartition(".")[2], "", record.what.partition(".")[0]
        register = register_of(module, name)
        source = f" [{register.source}]" if register is not None else ""
    return _said(run, step.row, record) + source


def _said(run: Run, row: int, record: Record) -> str:
    if record.kind is Kind.FLAG:
        return f"{record.where}.{record.what} became {_number(record.value)}"
    if record.kind is Kind.ACCESS:
        way = "read" if record.what.startswith("R ") else "wrote"
        return f"{record.where} {way} {record.what[2:]} = {record.value:#06x} at {record.text}"
    if record.kind is Kind.EDGE:
        who = ", ".join(holders(run, row, record))
        verb = ("let go" if record.value else "pulled low") + f" by {who}" if who else ""
        return f"{record.where} {'rose' if record.value else 'fell'}{', ' + verb if verb else ''}"
    if record.kind in (Kind.IRQ, Kind.SPAN):
        what = "interrupt " if record.kind is Kind.IRQ else ""
        verb = "entered" if record.kind is Kind.IRQ else "began"
        return f"{record.where} {what}{record.what} {verb if record.value else 'ended'}"
    about = f" ({record.text})" if record.text else ""
    return f"{record.where}: {record.what} {record.value:#x}{about}"


def _value(answer: Answer) -> str:
    if answer.value is None:
        return "not known, it never changed"
    states = {Kind.EDGE: ("low", "high"), Kind.SPAN: ("not in it", "in it"), Kind.IRQ: ("not in it", "in it")}
    kind = answer.subject.kind
    value = states[kind][answer.value != 0] if kind in states else _number(answer.value)
    if not answer.back:
        return f"{value}, {AS_RESET}" if kind is Kind.FLAG else f"{value} from the start"
    return f"{value} since {answer.run.at(answer.since)}, {answer.run.length(answer.tick - answer.since)} before"


def _number(value: int) -> str:
    return str(value) if value < 10 else f"{value:#x}"


def _meaning(answer: Answer) -> list[str]:
    register, f = answer.subject.register, answer.subject.field
    return [f"  {f.name}, {f.access}: {f.doc} [{register.source}]"] if register is not None and f is not None else []


def _forward(answer: Answer) -> list[str]:
    run, since = answer.run, answer.since
    rows = []
    for step in answer.effects:
        rows.append(("set off", f"{run.length(step.record.tick - since)} after", said(run, step)))
    if answer.reader is not None:
        rows.append(("read", f"{run.length(answer.reader.record.tick - since)} after", said(run, answer.reader)))
    if answer.changed is not None:
        rows.append(("changed", f"{run.length(answer.changed.record.tick - since)} after", said(run, answer.changed)))
    lines = aligned(rows)
    field = answer.subject.field is not None
    if field:
        until = "that change" if answer.changed is not None else "the end of the run"
        lines.append(
            f"  {answer.reads or 'no'} recorded read{'s' * (answer.reads != 1)} of the register before {until}"
        )
    if answer.changed is None:
        lines.append("  it did not change again")
    return [*lines, SKIPPED] if field else lines


def aligned(rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))] if rows else []
    return ["  " + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows]


def _entry(answer: Answer, step: Step) -> dict[str, object]:
    record = step.record
    away = record.tick - answer.since
    return {
        "record": record.number,
        "at_s": float(answer.run.seconds(record.tick)),
        "tick": record.tick,
        "cycles_from_value": answer.run.cycles.of(away),
        "kind": record.kind.value,
        "where": record.where,
        "what": record.what,
        "value": record.value,
        "text": record.text,
        "said": said(answer.run, step),
        "known": step.known or None,
        "because": step.because or None,
    }
