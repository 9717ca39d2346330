"""An answer to "why" as text and as JSON; only here are there floats."""

from __future__ import annotations

from ...core.records import Kind
from ...core.text_table import columns, paragraph, together
from ..record_text import happened_where, number
from ..register_maps import register_of
from ..run import Run
from .causes import Step, holders
from .why import AS_RESET, Answer

SKIPPED = (
    "note: polls of a wait that is skipped exactly are not recorded, only its first and last passes; "
    "a read above is the next recorded one"
)


def text(answer: Answer) -> str:
    """Return the value and its begin, its meaning, its causes, and later reads and changes, as text."""
    run, subject = answer.run, answer.subject
    lines = [f"{subject.name} at {run.at(answer.tick)}: {_value(answer)}", *_meaning(answer), "", "back:"]
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
    """Return the answer for JSON, with times in seconds; `back` begins with the record that gave the value."""
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


def said(run: Run, step: Step) -> str:
    """Return a record as text, for a flag with the section of the manual that describes its register."""
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
    """Return the words with the section of the manual at their end, if any, kept on one line."""
    what, bracket, source = words.partition(" [")
    return f"{what} {together(f'[{source}')}" if bracket else words


def _value(answer: Answer) -> str:
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


def _meaning(answer: Answer) -> list[str]:
    register, f = answer.subject.register, answer.subject.field
    if register is None or f is None:
        return []
    return paragraph(f"{f.name}, {f.access}{f': {f.doc}' if f.doc else ''} [{register.source}]", "  ", "    ")


def _forward(answer: Answer) -> list[str]:
    run, since = answer.run, answer.since
    rows = []
    steps = [("set off", step) for step in answer.effects]
    steps += [("read", answer.reader)] if answer.reader is not None else []
    steps += [("changed", answer.changed)] if answer.changed is not None else []
    for how, step in steps:
        rows.append(
            (
                how,
                f"{run.length(step.record.tick - since, since, answer.subject.unit)} after",
                _with_source(said(run, step)),
            )
        )
    lines = columns(rows)
    field = answer.subject.field is not None
    if field:
        until = "that change" if answer.changed is not None else "the end of the run"
        lines.append(
            f"  {answer.reads or 'no'} recorded read{'s' * (answer.reads != 1)} that looked at it before {until}"
        )
    if answer.changed is None:
        lines.append("  it did not change again")
    return [*lines, *paragraph(SKIPPED)] if field else lines


def _entry(answer: Answer, step: Step) -> dict[str, object]:
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
