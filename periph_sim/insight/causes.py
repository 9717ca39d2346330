"""From a record back to what made it: a row goes in, the row of its cause comes out, and how that is known.

A recording names the causes of what chips do: the access or edge that changed a flag or moved a pin, at once or behind
filters and bit clocks, where it is the last that had come through. What a party on the wire meant by an edge, which
request stands behind an interrupt and what the firmware saw before it wrote is taken from the order of the records, and
said to be inferred.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from ..core.records import Kind, Record
from ..f28335.pie_map import LINES
from .run import Rows, Run

RECORDED, INFERRED = "recorded", "inferred"
SOON = 1000  # cycles: a write later than this after a read is not said to come of it
LOOKS = 64  # records looked through for a change that a read saw
MODIFY = 4  # cycles: most between read and write of one read-modify-write
ROUND_A_GATE = 16  # cycles: most between a module's request and the PIE's flag


@dataclass(frozen=True)
class Step:
    """One record of the walk. known: RECORDED, INFERRED, or "" for the record that was asked about."""

    row: int
    record: Record
    known: str
    because: str = ""


def walk_back(run: Run, row: int, depth: int) -> Iterator[Step]:
    """The record itself, then its causes, at most `depth` of them."""
    step = Step(row, run.record(row), "")
    yield step
    for _ in range(depth):
        found = _cause(run, step.row, step.record)
        if found is None:
            return
        cause, known, because = found
        step = Step(cause, run.record(cause), known, because)
        yield step


Cause = tuple[int, str, str] | None  # row, how it is known, in what way it is the cause


def _cause(run: Run, row: int, record: Record) -> Cause:
    if record.kind is Kind.FLAG:
        return _of_flag(run, row, record)
    recorded = run.row_of(record.cause)
    if recorded is not None and recorded < row:
        way = "in its service routine" if record.kind is Kind.ACCESS else "caused it"
        return recorded, RECORDED, way
    if record.kind is Kind.ACCESS:
        return _of_access(run, row, record)
    if record.kind is Kind.IRQ:
        return _of_interrupt(run, row, record)
    if record.kind is Kind.EDGE:
        return _of_edge(run, row, record)
    return None


def _of_flag(run: Run, row: int, record: Record) -> Cause:
    request = _request(run, row, record)
    if request is not None:
        return request, INFERRED, "the request behind it"
    recorded = run.row_of(record.cause)
    if recorded is None:
        return None
    at_once = int(run.table.tick[recorded]) == record.tick
    return recorded, RECORDED, "in the same cycle" if at_once else "the last input that had come through"


def _request(run: Run, row: int, record: Record) -> int | None:
    """The flag of the module behind a PIE line that changed last before it, within a few cycles."""
    unit, _, owner = record.where.rpartition(".")
    register, _, line = record.what.partition(".")
    if owner != "PIE" or not register.startswith("PIEIFR") or not record.value:
        return None
    place = int(register.removeprefix("PIEIFR")), int(line.removeprefix("INTx"))
    name = next((name for name, of in LINES.items() if of == place), "")
    module = next((m for m in run.units.get(unit, ()) if _asks(m, name)), None)
    if module is None:
        return None
    found = run.last(run.rows(Kind.FLAG, f"{unit}.{module}"), record.tick, row)
    near = found is not None and run.cycles.of(record.tick - int(run.table.tick[found])) <= ROUND_A_GATE
    return found if near else None


def _asks(module: str, line: str) -> bool:
    """Whether a PIE line is a module's: SCIRXINTA of SCI-A, I2CINT1A of I2C-A, TINT0 of TIMER0."""
    if "-" in module:
        kind, _, letter = module.partition("-")
        return line.startswith(kind) and line.endswith(letter)
    return (line, module) == ("TINT0", "TIMER0") or (line.startswith("XINT") and module == "XINT")


def _of_access(run: Run, row: int, record: Record) -> Cause:
    return _read_before(run, row, record) if record.what.startswith("W ") else _news(run, row, record)


def _read_before(run: Run, row: int, record: Record) -> Cause:
    """The last read of the same routine before a write; that of its own read-modify-write is passed over."""
    rows = run.rows(Kind.ACCESS, record.where)
    place = int(np.searchsorted(rows, row))
    for earlier in reversed(rows[max(0, place - LOOKS) : place].tolist()):
        before = run.record(earlier)
        passed = run.cycles.of(record.tick - before.tick)
        own = before.text == record.text and before.what[2:] == record.what[2:] and passed <= MODIFY
        if passed > SOON:
            return None
        if before.cause == record.cause and before.what.startswith("R ") and not own:
            return earlier, INFERRED, "what the firmware read last before"
    return None


def _news(run: Run, row: int, record: Record) -> Cause:
    """The change that brought the value read, where a read at the same place had another value before."""
    module, _, register = record.what[2:].partition(".")
    table = run.table
    reads = run.rows(Kind.ACCESS, record.where, record.what)
    reads = reads[: int(np.searchsorted(reads, row, "right"))][-LOOKS:]
    reads = reads[table.columns["text"][reads] == table.columns["text"][row]]
    others = np.flatnonzero(table.value[reads] != record.value)
    since, saw = (int(reads[others[-1]]), int(reads[others[-1] + 1])) if len(others) else (-1, int(reads[0]))
    flags = run.rows(Kind.FLAG, f"{record.where}.{module}")
    for flag in reversed(flags[np.searchsorted(flags, since) : np.searchsorted(flags, saw)][-LOOKS:].tolist()):
        if run.record(flag).what.startswith(f"{register}."):
            return flag, INFERRED, "the change that this read, or one here before it, saw"
    return None


def _of_interrupt(run: Run, row: int, record: Record) -> Cause:
    if not record.value:
        entered = run.last(run.rows(Kind.IRQ, record.where, record.what), record.tick, row)
        return None if entered is None else (entered, INFERRED, "its service routine began")
    if record.what not in LINES:
        return None
    group, line = LINES[record.what]
    asked = run.rows(Kind.FLAG, f"{record.where}.PIE", f"PIEIFR{group}.INTx{line}")
    found = run.last(asked[run.table.value[asked] == 1], record.tick, row)
    return None if found is None else (found, INFERRED, "the PIE's flag of the interrupt")


def _of_edge(run: Run, row: int, record: Record) -> Cause:
    """What the party on the wire that pulled it, or let it go, did last."""
    party = holders(run, row, record)[-1:]
    if not party:
        return None
    rows = _merged(run.rows(kind, party[0]) for kind in (Kind.BUS, Kind.FRAME))
    found = run.last(rows, record.tick, row)
    return None if found is None else (found, INFERRED, f"what {party[0]} did last on the wire")


def holders(run: Run, row: int, record: Record) -> list[str]:
    """Who pulls a wire low after an edge; of a rising edge, who did before it."""
    text = record.text
    if record.value:
        edges = run.rows(Kind.EDGE, record.where)
        place = int(np.searchsorted(edges, row))
        text = run.record(int(edges[place - 1])).text if place else ""
    return text.split(", ") if text else []


def _merged(parts: Iterable[Rows]) -> Rows:
    return np.sort(np.concatenate([np.empty(0, np.int64), *parts]))
