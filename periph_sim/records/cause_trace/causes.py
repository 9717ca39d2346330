"""Search from a record back to its causes. Each link states whether it was recorded or inferred.

A recording states the causes of what the hardware does: the access or edge that changed a flag or a pin. If a module
filters or samples its inputs, the recorded cause is the last input that passed the filter. Other causes are inferred
from the order of the records: the action of a party before an edge of a wire, the request for an interrupt, and most
causes of accesses. A look is a read that is not the first half of a read-modify-write.

    cause of a write: of the earlier looks in the same routine, the look that saw the newest change;
                      if there is no look, the entry of the service routine;
                      in the main program without a look, the earlier change of a field that is written back
    cause of a read:  the last change of the fields that were read;
                      if they had not changed before, the entry of the service routine

A field is written back if a read-modify-write writes it with the value that it has read, in order to change another
field.

Some records are not the cause of an access, but are shown together with the cause: the read that belongs to the same
read-modify-write, the earlier change of a field that is written back, later looks with the changes that they saw, the
entry of the service routine between a change and its read, and service routines that delayed the firmware.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ...core.phrases import counted
from ...core.records import Kind, Record
from ...core.registers import Field, OnWrite, Register
from ...f28335.parts.f28335 import PART
from ...f28335.pie.register_map import LINES
from ..read_modify_write import read_modify_writes
from ..register_maps import register_of
from ..run import Rows, Run

RECORDED, INFERRED = "recorded", "inferred"
MOST_LOOKS = 8  # maximum number of earlier reads that are considered as the cause of a write
MOST_ACCESSES = 10_000  # maximum number of earlier accesses of the routine that are searched for the cause of a write
MOST_ROUTINES = 3  # maximum number of service routines shown as delays of the firmware; the longest are chosen
MAX_REQUEST_CYCLES = 16  # maximum number of cycles from a module's interrupt request to the PIEIFR flag that it sets
SEEN = "the last change of what it read"
NEWEST = "the read before it that saw the newest change"


class Link(NamedTuple):
    """A record found in a search for causes, with its relation to another record.

    known: RECORDED or INFERRED, the source of the relation; "" for the record whose causes are searched.
    because: the relation, as a phrase.
    aside: True if the record is only additional information and not the cause. The search does not continue from it.
    of: the row of the other record, which this record explains; -1 if there is none, as in the first link of
        `walk_back`. In the result of `causes`, -1 is the record that was passed to it.
    """

    row: int
    record: Record
    known: str
    because: str = ""
    aside: bool = False
    of: int = -1


def causes_of_access(run: Run, row: int, record: Record, flag: Record | None) -> list[Link]:
    """Return links to the cause of an access and to the records shown with the cause. The last link is the cause.

    If the list is empty, or if `Link.aside` is True for its last link, no cause was found. This happens only in the
    main program, if neither a change nor an earlier read explains the access.

    flag: the record of the last field change that the search passed on its way back to this access; None if none.
    """
    routine = run.row_of(record.cause)
    entry = [] if routine is None else [Link(routine, run.record(routine), RECORDED, "its service routine began")]
    if record.what.startswith("R "):
        changed = change_seen(run, row, record)
        if changed is None:
            return entry
        between = [link._replace(aside=True) for link in entry if link.row > changed]
        return [*held_up(run, record, changed, row), *between, Link(changed, run.record(changed), INFERRED, SEEN)]
    own = _own_read(run, row, record, flag)
    looks = looks_before(run, row, record)
    if not looks and entry:
        return [*own, *entry]
    if not looks:
        return [*own[:-1], *(link._replace(aside=link.of < 0) for link in own[-1:])]
    seen = {look: change_seen(run, look, run.record(look)) for look in looks}
    saw = {look: -1 if change is None else change for look, change in seen.items()}
    newest = max(looks, key=lambda look: (saw[look], look))
    later = [link for look in looks if look > newest for link in _beside(run, look)]
    held = held_up(run, record, newest, row)
    return [*own, *later, *held, Link(newest, run.record(newest), INFERRED, NEWEST)]


def looks_before(run: Run, row: int, record: Record) -> list[int]:
    """Return the rows of the reads before a write in the same run of its routine, the last read first.

    Reads that are the first half of a read-modify-write are left out. Of several reads with the same register, place
    and field, only the last one is returned. The result has at most MOST_LOOKS reads, from the last MOST_ACCESSES
    accesses.
    """
    accesses = accesses_before(run, row, record)[-MOST_ACCESSES:][::-1]
    found: dict[tuple[str, str, str], int] = {}
    for earlier in accesses[~np.isin(accesses, read_modify_writes(run, record.where).reads)].tolist():
        if len(found) == MOST_LOOKS:
            break
        look = run.record(earlier)
        if look.what.startswith("R "):
            found.setdefault((look.what, look.text, look.field), earlier)
    return [*found.values()]


def accesses_before(run: Run, row: int, record: Record) -> Rows:
    """Return the rows of the accesses before `row` in the same run of its service routine, or in the main program."""
    routine = run.routine(record.where, record.cause)
    before: Rows = routine[: np.searchsorted(routine, row)]
    return before


def _beside(run: Run, look: int) -> list[Link]:
    """Return links that describe a look between the cause of a write and this write.

    The links lead to the look, to the change that the look saw, and to the service routines that delayed the firmware
    between this change and the look. All of them are `aside`.
    """
    record = run.record(look)
    changed = change_seen(run, look, record)
    links = [Link(look, record, INFERRED, "looked at as well", aside=True)]
    if changed is not None:
        links += [link._replace(of=look) for link in held_up(run, record, changed, look)]
        links.append(Link(changed, run.record(changed), INFERRED, SEEN, True, look))
    return links


def change_seen(run: Run, row: int, record: Record) -> int | None:
    """Return the row of the last change that a read could see; None if there is none, or if the register is unknown.

    A read that names a field sees changes of that field; any other read sees changes of the whole register.
    """
    module, register, fields = looked_at(record)
    if register is None:
        return None
    found = [run.changed_before(record.where, module, register, f, row) for f in fields]
    return max((change for change in found if change is not None), default=None)


def looked_at(record: Record) -> tuple[str, Register | None, tuple[Field, ...]]:
    """Return the module, the register (None if unknown) and the fields of an access: the named field, or all."""
    module, _, name = record.what[2:].partition(".")
    register = register_of(module, name)
    if register is None:
        return module, None, ()
    return module, register, (register[record.field],) if record.field in register else register.fields


def held_up(run: Run, record: Record, after: int, before: int) -> list[Link]:
    """Return links to the ends of the service routines that delayed `record`.

    These routines interrupted the routine of `record` and ended between the rows `after` and `before`. Only the
    MOST_ROUTINES longest are returned, the last one first.

    record: the delayed record: an access, or the entry of another service routine.
    """
    table = run.table
    ends, entries = run.service(record.where, record.cause, after, before)
    begins = table.tick[entries]
    lengths = table.tick[ends] - begins
    longest = np.sort(np.argsort(-lengths, kind="stable")[:MOST_ROUTINES])[::-1]
    return [
        Link(
            int(ends[n]),
            run.record(int(ends[n])),
            RECORDED,
            f"held the firmware up for {run.length(int(lengths[n]), int(begins[n]), record.where)}",
            aside=True,
        )
        for n in longest.tolist()
    ]


def _own_read(run: Run, row: int, record: Record, flag: Record | None) -> list[Link]:
    """Return links to the read half of a write's read-modify-write and, possibly, to an earlier change of a field.

    The list is empty if the write does not belong to a read-modify-write. If the write only wrote the field of `flag`
    back (`handed_back`), the list ends with a link to the change of this field that the read half saw.

    flag: see `causes`.
    """
    read = read_modify_writes(run, record.where).read_of(row)
    if read is None:
        return []
    links = [Link(read, run.record(read), INFERRED, "the read of this read-modify-write", aside=True)]
    f = None if flag is None else handed_back(record, int(run.table.value[read]), flag)
    if f is not None:
        module, register, _ = looked_at(record)
        assert register is not None
        seen = run.changed_before(record.where, module, register, f, read)
        if seen is not None:
            because = f"{f.name} as that read saw it, and the write gave it back"
            links.append(Link(seen, run.record(seen), INFERRED, because, True, read))
    return links


def handed_back(write: Record, read: int, flag: Record) -> Field | None:
    """Return the field whose change `flag` records, if the write only wrote back what had been read; else None.

    If the field is cleared by writing 1, a 1 must have been written back, because a 0 has no effect. Any other field
    must take the written value, and the firmware must not have named it in the write.

    read: the value of the register that the read half of the read-modify-write returned.
    """
    module, register, _ = looked_at(write)
    name, _, field = flag.what.partition(".")
    ours = flag.where == f"{write.where}.{module}" and register is not None and register.name == name
    if not ours or register is None or field not in register:
        return None
    f = register[field]
    kept = f.extract(read) == f.extract(write.value)
    if f.on_write is OnWrite.ONE_CLEARS:
        return f if kept and f.extract(read) else None
    return f if kept and f.on_write is OnWrite.STORE and f.name != write.field else None


def walk_back(run: Run, row: int, depth: int) -> Iterator[Link]:
    """Yield a link to the record in `row`, then links to at most `depth` causes.

    Before each cause come the links to records that are only additional information about it (`Link.aside`).
    """
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
    """Return a phrase that says why `walk_back` ended at its last step; "" if there was no step."""
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
    """Return links to the cause of a record and to the records that are shown together with the cause.

    The last link is the cause. If the list is empty or its last link is `aside`, the cause is not known.

    flag: the record of the last field change that the search passed on its way back to this record; None if none.
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
    """Return a link to the cause that the record names; an empty list if it names none that was recorded."""
    found = run.row_of(record.cause)
    if found is None:
        return []
    cause, because = run.record(found), "caused it"
    if record.kind is Kind.FLAG:
        because = "in the same cycle" if cause.tick == record.tick else "the last input that had taken effect"
    return [Link(found, cause, RECORDED, because)]


def _request(run: Run, row: int, record: Record) -> list[Link]:
    """Return a link to the request that set a PIEIFR flag; no link if the record does not set such a flag.

    The request is the last rise of a module's flag that can request this interrupt. If it was not recorded, or is more
    than MAX_REQUEST_CYCLES cycles before the record, no link is returned.
    """
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
    if found is None or run.clock(unit).cycles(int(run.table.tick[found]), record.tick) > MAX_REQUEST_CYCLES:
        return []
    return [Link(found, run.record(found), INFERRED, "the request that set it")]


def _of_interrupt(run: Run, row: int, record: Record) -> list[Link]:
    """Return links from the entry of a service routine to its PIEIFR flag and to the service routines that delayed it.

    If the record is the end of a service routine, return a link to the entry of this routine. If no rise of the PIEIFR
    flag is recorded, or the vector has no such flag, return a link to the cause that the record names.
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
    """Return a link to the last BUS or FRAME record of the party that moved the wire; no link if there is none."""
    party = mover(run, row, record)
    rows = np.sort(np.concatenate([run.rows(kind, party) for kind in (Kind.BUS, Kind.FRAME)]))
    found = run.last(rows, record.tick, row)
    because = f"what {party} did last on the wire"
    return [] if found is None else [Link(found, run.record(found), INFERRED, because)]


# Parties that pull a wire low --------------------------------------------------


def holders(run: Run, row: int, record: Record) -> tuple[str, ...]:
    """Return the parties that pull the wire low after this record; for a rising edge, those that did so before.

    The records of a wire in order, for example:
        EDGE fell "controller"   HOLD "controller, dsp.SCLA"   HOLD "dsp.SCLA"   EDGE rose
        the controller pulls     the unit pulls it low, too    the unit alone still pulls
    """
    before = _before(run, row, record)
    return _named(record.text) if not record.value else () if before is None else _named(before.text)


def mover(run: Run, row: int, record: Record) -> str:
    """Return the party whose pull or release of a wire the EDGE or HOLD record describes; "" if it is not known.

    If several parties pulled or released the wire at once, the last of them in the text that names them is returned.
    """
    earlier = _before(run, row, record)
    now, before = _named(record.text), () if earlier is None else _named(earlier.text)
    moved = [who for who in now if who not in before] or [who for who in before if who not in now]
    return moved[-1] if moved else ""


def wire_rows(run: Run, wire: str) -> Rows:
    """Return the rows of a wire in order: its edges, and the changes of the set of parties that hold it low."""

    def both() -> Rows:
        return np.sort(np.concatenate([run.rows(kind, wire) for kind in (Kind.EDGE, Kind.HOLD)]))

    return run.remembered(f"edges and holders of {wire}", both)


def causes_of_hold(run: Run, row: int, record: Record) -> list[Link]:
    """Return a link to the earlier record at which the last of the parties named in `record` began to pull.

    Since then, all of them have held the wire low. Return no link if one of these parties began to pull with `record`
    itself: the cause of `record` then explains the level of the wire.
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
