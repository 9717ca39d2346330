"""Causes of accesses of the firmware.

    write --> the look before it, in the same routine, that saw the newest change
              beside it: the read of its own read-modify-write, the flag that it handed back; later looks
          --> without a look: the entry of its service routine
    read  --> the last change before it of the fields that it looked at
          --> without a change: the entry of its service routine

A look is a read that does not belong to a read-modify-write. Beside each link are the service routines that ended in
between, which delayed the firmware. Only the author of the firmware knows why it made an access; all of this is
inferred from the order of the records.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...core.records import Record
from ...core.registers import Field, OnWrite, Register
from ..read_modify_write import read_modify_writes
from ..register_maps import register_of
from ..run import Rows, Run

RECORDED, INFERRED = "recorded", "inferred"
MOST_LOOKS = 8  # maximum number of looks at different places or fields that are searched before a write
MOST_ACCESSES = 10_000  # searched for looks before a write, within its routine
MOST_ROUTINES = 3  # number of shown routines that delayed the firmware: the longest ones
SEEN = "the last change of what it read"
NEWEST = "the read before it that saw the newest change"


class Link(NamedTuple):
    """A record of a walk along causes, with its relation to another record.

    known: RECORDED, INFERRED, or "" for the record in question.
    because: the relation in words.
    aside: True if the record is shown beside the cause and is not the cause itself; the walk does not continue from it.
    of: the row of the record that this one is related to; -1 for the record whose causes are searched.
    """

    row: int
    record: Record
    known: str
    because: str = ""
    aside: bool = False
    of: int = -1


def causes_of_access(run: Run, row: int, record: Record, flag: Record | None) -> list[Link]:
    """Return the links of an access; the last one is its cause, unless it is `aside`.

    An access of the main program has no cause if no change or earlier look explains it.
    flag: the change of a field whose causes led to this access, or None.
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
    """Return the last look of each place and field in the same routine before a write."""
    of_writes = read_modify_writes(run, record.where)
    found: dict[tuple[str, str, str], int] = {}
    for earlier in accesses_before(run, row, record)[-MOST_ACCESSES:][::-1].tolist():
        if len(found) == MOST_LOOKS:
            break
        look = run.record(earlier)
        if look.what.startswith("R ") and not of_writes.has_read(earlier):
            found.setdefault((look.what, look.text, look.field), earlier)
    return [*found.values()]


def accesses_before(run: Run, row: int, record: Record) -> Rows:
    """Return the accesses of the same routine before an access."""
    routine = run.routine(record.where, record.cause)
    before: Rows = routine[: np.searchsorted(routine, row)]
    return before


def _beside(run: Run, look: int) -> list[Link]:
    """Return links that are only shown: a look after the one that the search follows, its change and its delays."""
    record = run.record(look)
    changed = change_seen(run, look, record)
    links = [Link(look, record, INFERRED, "looked at as well", aside=True)]
    if changed is not None:
        links += [link._replace(of=look) for link in held_up(run, record, changed, look)]
        links.append(Link(changed, run.record(changed), INFERRED, SEEN, True, look))
    return links


def change_seen(run: Run, row: int, record: Record) -> int | None:
    """Return the last change, before a read, of the fields that it named; of the whole register if it named none."""
    module, register, fields = looked_at(record)
    if register is None:
        return None
    found = [run.changed_before(record.where, module, register, f, row) for f in fields]
    return max((change for change in found if change is not None), default=None)


def looked_at(record: Record) -> tuple[str, Register | None, tuple[Field, ...]]:
    """Return module, register and fields of an access; None for the register if its name is not known."""
    module, _, name = record.what[2:].partition(".")
    register = register_of(module, name)
    if register is None:
        return module, None, ()
    return module, register, (register[record.field],) if record.field in register else register.fields


def held_up(run: Run, record: Record, after: int, before: int) -> list[Link]:
    """Return the ends of service routines that interrupted the routine of an access, or of an entry, between two rows.

    The last one is first.
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
    """Return links to the read of a write's read-modify-write, and to the change whose value the write only wrote back.

    The list is empty if the write does not belong to a read-modify-write.
    flag: the change whose causes led to this write, or None.
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
    """Return the field of a flag's change, if the write that made it only handed back what its read had seen."""
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
