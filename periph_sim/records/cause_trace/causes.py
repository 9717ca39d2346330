"""Search from a record back to its causes. Each link states whether it was recorded or inferred.

A recording has the causes of what chips do: the access or edge that changed a flag or moved a pin. If the chip filters
or samples its inputs, the recorded cause is the last input that had passed. Three causes are inferred from the order of
the records: what a party did on the wire before an edge, the request for an interrupt, and what firmware read before it
wrote.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...core.counted import counted
from ...core.records import Kind, Record
from ...f28335.parts.f28335 import PART
from ...f28335.pie.register_map import LINES
from ..run import Rows, Run
from .firmware_causes import INFERRED, MOST_ACCESSES, RECORDED, Link, accesses_before, causes_of_access, held_up

ROUND_A_GATE = 16  # maximum cycles between a module's request and the PIEIFR flag that it sets


def walk_back(run: Run, row: int, depth: int) -> Iterator[Link]:
    """Yield the record itself, then at most `depth` causes. Each cause follows the links that are shown beside it."""
    step = Link(row, run.record(row), "")
    yield step
    flag: Record | None = None
    for _ in range(depth):
        flag = step.record if step.record.kind is Kind.FLAG else flag
        links = [link for link in causes(run, step.row, step.record, flag) if link.row < step.row]
        yield from (link._replace(of=step.row) if link.of < 0 else link for link in links)
        if not links or links[-1].aside:
            return
        step = links[-1]


def end_of_walk(run: Run, steps: Sequence[Link], depth: int) -> str:
    """Return the reason why a walk ends at its last step, as a clause; "" if there was no step."""
    main = [step for step in steps if not step.aside]
    if not main:
        return ""
    if len(main) > depth:
        return f"{counted(depth, 'cause')} were asked for; --depth gives more"
    record = main[-1].record
    if record.kind is not Kind.ACCESS:
        return "no record of a cause of it"
    if record.what.startswith("R "):
        return "nothing that this access read had changed before it"
    searched = len(accesses_before(run, main[-1].row, record))
    if searched > MOST_ACCESSES:
        return f"its routine read nothing else in the {MOST_ACCESSES} accesses before it; no more were searched"
    return "its routine had read nothing before it"


def causes(run: Run, row: int, record: Record, flag: Record | None = None) -> list[Link]:
    """Return links to the cause of a record and to the records that are shown beside it.

    If the cause is known, the last link is the cause.
    flag: the change of a field whose causes led to this record, or None.
    """
    kind = record.kind
    if kind is Kind.ACCESS:
        return causes_of_access(run, row, record, flag)
    if kind is Kind.HOLD:
        return causes_of_hold(run, row, record) or _recorded(run, record) or _of_party(run, row, record)
    if kind is Kind.FLAG:
        return _request(run, row, record) or _recorded(run, record)
    if kind is Kind.IRQ:
        return _of_interrupt(run, row, record)
    return _recorded(run, record) or (_of_party(run, row, record) if kind is Kind.EDGE else [])


def _recorded(run: Run, record: Record) -> list[Link]:
    """Return a link to the cause that the record names."""
    found = run.row_of(record.cause)
    if found is None:
        return []
    cause, because = run.record(found), "caused it"
    if record.kind is Kind.FLAG:
        because = "in the same cycle" if cause.tick == record.tick else "the last input that had taken effect"
    return [Link(found, cause, RECORDED, because)]


def _request(run: Run, row: int, record: Record) -> list[Link]:
    """Return a link to the request that set a PIEIFR flag: the flag of a module that rose last, within a few cycles."""
    unit, _, owner = record.where.rpartition(".")
    register, _, line = record.what.partition(".")
    if owner != "PIE" or not register.startswith("PIEIFR") or not record.value:
        return []
    place = int(register.removeprefix("PIEIFR")), int(line.removeprefix("INTx"))
    vectors = [name for name, of in LINES.items() if of == place]
    rose = (
        run.rows(Kind.FLAG, f"{unit}.{module}", field)
        for vector in vectors
        for module, interrupt in PART.requesters(vector).items()
        for field in interrupt.fields
    )
    asked = [run.last(rows[run.table.value[rows] != 0], record.tick, row) for rows in rose]
    found = max((one for one in asked if one is not None), default=None)
    if found is None or run.clock(unit).cycles(int(run.table.tick[found]), record.tick) > ROUND_A_GATE:
        return []
    return [Link(found, run.record(found), INFERRED, "the request that set it")]


def _of_interrupt(run: Run, row: int, record: Record) -> list[Link]:
    """Return links from the entry of a service routine to its PIEIFR flag and to the service routines that delayed it.

    If the record is the end of a service routine, its cause is the entry.
    """
    if not record.value or record.what not in LINES:
        return _recorded(run, record)
    group, line = LINES[record.what]
    asked = run.rows(Kind.FLAG, f"{record.where}.PIE", f"PIEIFR{group}.INTx{line}")
    found = run.last(asked[run.table.value[asked] == 1], record.tick, row)
    if found is None:
        return _recorded(run, record)
    held = held_up(run, record, found, row)
    return [*held, Link(found, run.record(found), INFERRED, "the PIE's flag of the interrupt")]


def _of_party(run: Run, row: int, record: Record) -> list[Link]:
    """Return a link to the last action of the party that pulled or released the wire."""
    party = mover(run, row, record)
    rows = np.sort(np.concatenate([run.rows(kind, party) for kind in (Kind.BUS, Kind.FRAME)]))
    found = run.last(rows, record.tick, row)
    because = f"what {party} did last on the wire"
    return [] if found is None else [Link(found, run.record(found), INFERRED, because)]


# Parties that pull a wire low --------------------------------------------------


def holders(run: Run, row: int, record: Record) -> tuple[str, ...]:
    """Return the parties that pull the wire low after this record; for a rising edge, those that pulled it low until
    then.

        EDGE fell "controller"   HOLD "controller, dsp.SCLA"   HOLD "dsp.SCLA"   EDGE rose
        the controller pulls     the unit pulls it low, too    the unit alone still pulls
    """
    before = _before(run, row, record)
    return _named(record.text) if not record.value else () if before is None else _named(before.text)


def mover(run: Run, row: int, record: Record) -> str:
    """Return the party that pulled or released the wire with this record; "" if it is not known."""
    earlier = _before(run, row, record)
    now, before = _named(record.text), () if earlier is None else _named(earlier.text)
    moved = [who for who in now if who not in before] or [who for who in before if who not in now]
    return moved[-1] if moved else ""


def wire_rows(run: Run, wire: str) -> Rows:
    """Return the rows of a wire in order: its edges and the changes of its holders."""

    def both() -> Rows:
        return np.sort(np.concatenate([run.rows(kind, wire) for kind in (Kind.EDGE, Kind.HOLD)]))

    return run.remembered(f"edges and holders of {wire}", both)


def causes_of_hold(run: Run, row: int, record: Record) -> list[Link]:
    """Return a link to the record from which on the parties that now hold the wire low have all held it.

    Return no link if one of them began to hold the wire with this record; the record's own cause then explains it.
    """
    ours = set(_named(record.text))
    joined = row
    rows = wire_rows(run, record.where)
    for earlier in rows[: np.searchsorted(rows, row)][::-1].tolist():
        before = run.record(earlier)
        if before.value or not ours <= set(_named(before.text)):
            break
        joined = earlier
    because = f"since then {' and '.join(_named(record.text))} has held it"
    return [] if joined == row else [Link(joined, run.record(joined), RECORDED, because)]


def _before(run: Run, row: int, record: Record) -> Record | None:
    rows = wire_rows(run, record.where)
    place = int(np.searchsorted(rows, row))
    return run.record(int(rows[place - 1])) if place else None


def _named(text: str) -> tuple[str, ...]:
    return tuple(text.split(", ")) if text else ()
