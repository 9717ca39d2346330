"""What an access of the firmware came of: the row of an access goes in, links to what made it come out.

    write --> the look before it, in the same routine, that saw the newest change
              beside it: the read of its own read-modify-write, the flag that it handed back; later looks
          --> where it looked at nothing: the entry of its service routine
    read  --> the last change, before it, of the fields that it looked at
          --> where there was none: the entry of its service routine

A look is a read that is not of a read-modify-write. Beside each link stand the service routines that ended in between:
they held the firmware up. Nobody but the author of the firmware knows what an access came of; all of this is taken from
the order of the records.
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
MOST_LOOKS = 8  # at different places or fields
MOST_ACCESSES = 10_000  # of a routine that are searched for them before a write
MOST_ROUTINES = 3  # shown of those that held the firmware up: the longest
SEEN = "the last change of what it looked at"


class Link(NamedTuple):
    """A row that has to do with another one. known: RECORDED or INFERRED. because: in what way.

    aside: it is told beside the cause. of: the row that it has to do with, if that is not the one asked about.
    """

    row: int
    known: str
    because: str
    aside: bool = False
    of: int | None = None


def causes_of_access(run: Run, row: int, record: Record, flag: Record | None) -> list[Link]:
    """Links from an access, its cause last; no cause at the begin of a program, or where it looked at nothing.

    flag: the change of a field that the walk came from.
    """
    routine = run.row_of(record.cause)
    entry = [] if routine is None else [Link(routine, RECORDED, "its service routine began")]
    entry_beside = [link._replace(aside=True) for link in entry]
    if record.what.startswith("R "):
        changed = change_seen(run, row, record)
        if changed is None:
            return entry
        between = [link for link in entry_beside if link.row > changed]
        return [*held_up(run, record, changed, row), *between, Link(changed, INFERRED, SEEN)]
    own = _own_read(run, row, record, flag)
    looks = looks_before(run, row, record)
    if not looks and entry:
        return [*own, *entry]
    if not looks:
        return [*own[:-1], *(link._replace(aside=link.of is None) for link in own[-1:])]
    seen = {look: change_seen(run, look, run.record(look)) for look in looks}
    saw = {look: -1 if change is None else change for look, change in seen.items()}
    newest = max(looks, key=lambda look: (saw[look], look))
    later = [link for look in looks if look > newest for link in _beside(run, look)]
    held = held_up(run, record, newest, row)
    return [*own, *later, *held, Link(newest, INFERRED, "the look before it that saw the newest change")]


def looks_before(run: Run, row: int, record: Record) -> list[int]:
    """The last looks of the same routine before a write, however long before; the last one of each place and field."""
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
    """The accesses of the routine of an access before it."""
    routine = run.routine(record.where, record.cause)
    before: Rows = routine[: np.searchsorted(routine, row)]
    return before


def _beside(run: Run, look: int) -> list[Link]:
    """A later look than the one that the walk goes on with: what it saw, and what held it up."""
    record = run.record(look)
    changed = change_seen(run, look, record)
    links = [Link(look, INFERRED, "looked at as well", aside=True)]
    if changed is not None:
        links += [link._replace(of=look) for link in held_up(run, record, changed, look)]
        links.append(Link(changed, INFERRED, SEEN, True, look))
    return links


def change_seen(run: Run, row: int, record: Record) -> int | None:
    """The last change before a read of the fields that it looked at: of all of the register where it named none."""
    module, register, fields = looked_at(record)
    if register is None:
        return None
    found = [run.changed_before(record.where, module, register, f, row) for f in fields]
    return max((change for change in found if change is not None), default=None)


def looked_at(record: Record) -> tuple[str, Register | None, tuple[Field, ...]]:
    """Module, register and fields that an access is about; no register where none of that name is known."""
    module, _, name = record.what[2:].partition(".")
    register = register_of(module, name)
    if register is None:
        return module, None, ()
    return module, register, (register[record.field],) if record.field in register else register.fields


def held_up(run: Run, record: Record, after: int, before: int) -> list[Link]:
    """The ends of service routines that interrupted the routine of an access, or of an entry, between two rows; the
    last one first."""
    table = run.table
    ends, entries = run.service(record.where, record.cause, after, before)
    begins = table.tick[entries]
    lengths = table.tick[ends] - begins
    longest = np.sort(np.argsort(-lengths, kind="stable")[:MOST_ROUTINES])[::-1]
    return [
        Link(
            int(ends[n]),
            RECORDED,
            f"held the firmware up for {run.length(int(lengths[n]), int(begins[n]), record.where)}",
            aside=True,
        )
        for n in longest.tolist()
    ]


def _own_read(run: Run, row: int, record: Record, flag: Record | None) -> list[Link]:
    """The read of a write's own read-modify-write; and the change of the flag that this read saw and the write gave
    back."""
    read = read_modify_writes(run, record.where).read_of(row)
    if read is None:
        return []
    links = [Link(read, INFERRED, "the read of this read-modify-write", aside=True)]
    f = None if flag is None else handed_back(record, int(run.table.value[read]), flag)
    if f is not None:
        module, register, _ = looked_at(record)
        assert register is not None
        seen = run.changed_before(record.where, module, register, f, read)
        if seen is not None:
            links.append(Link(seen, INFERRED, f"{f.name} as that read saw it, and the write gave it back", True, read))
    return links


def handed_back(write: Record, read: int, flag: Record) -> Field | None:
    """The field of a flag's change, if the write that made it only gave back what its own read had seen."""
    module, register, _ = looked_at(write)
    name, _, field = flag.what.partition(".")
    ours = flag.where == f"{write.where}.{module}" and register is not None and register.name == name
    if not ours or register is None or field not in register:
        return None
    f = register[field]
    kept = f.of(read) == f.of(write.value)
    if f.on_write is OnWrite.ONE_CLEARS:
        return f if kept and f.of(read) else None
    return f if kept and f.on_write is OnWrite.STORE and f.name != write.field else None
