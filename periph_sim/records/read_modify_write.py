"""Read-modify-writes of a run: pairs of a read and a write of one statement, and flags that they lose.

    i2c.I2CSTR.SCD = 1     R I2CSTR, W I2CSTR: one place, one routine, one field, a few cycles apart
                           whatever else was read as 1 is cleared as well

The write may land after accesses that the CPU makes meanwhile, so it need not be the next one.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..core.registers import Field
from ..processor.source_location import statement
from .register_maps import MODIFY, OVERTAKEN, one_clears
from .run import Group, Rows, Run, among


class Pairs(NamedTuple):
    """Rows of reads and of their writes, in the order of the writes. in_order: the rows of the reads, sorted."""

    reads: Rows
    writes: Rows
    in_order: Rows

    def read_of(self, write: int) -> int | None:
        """Return the row of the read that a write belongs to; None if it is a plain write."""
        place = int(np.searchsorted(self.writes, write))
        return int(self.reads[place]) if place < len(self.writes) and self.writes[place] == write else None

    def has_read(self, read: int) -> bool:
        """Return True if this read is the first half of a read-modify-write."""
        place = int(np.searchsorted(self.in_order, read))
        return place < len(self.in_order) and bool(self.in_order[place] == read)


def read_modify_writes(run: Run, unit: str) -> Pairs:
    """Return all read-modify-writes of a unit's firmware."""
    reads, writes, in_order = run.remembered(f"read-modify-writes of {unit}", lambda: _found(run, unit))
    return Pairs(reads, writes, in_order)


def _found(run: Run, unit: str) -> Rows:
    table = run.table
    rows, _ = run.in_order(unit)
    ways, registers = _split(table.names["what"])
    what = table.columns["what"][rows]
    is_read, register = ways[what], registers[what]
    same = [register, _statements(run)[table.columns["text"][rows]], table.columns["field"][rows], table.cause[rows]]
    clock = run.clock(unit)
    free = np.ones(len(rows), bool)
    reads, writes = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    for ahead in range(1, OVERTAKEN + 1):
        first, second = slice(None, -ahead), slice(ahead, None)
        fits = is_read[first] & ~is_read[second] & free[first] & free[second]
        for column in same:
            fits &= column[first] == column[second]
        begins = table.tick[rows[first]]
        fits &= table.tick[rows[second]] - begins <= clock.ticks_of(MODIFY, begins)
        found = np.flatnonzero(fits)
        free[found] = free[found + ahead] = False
        reads.append(rows[found])
        writes.append(rows[found + ahead])
    of_write = np.concatenate(reads)
    order = np.argsort(np.concatenate(writes))
    found_rows: Rows = np.stack([of_write[order], np.concatenate(writes)[order], np.sort(of_write)])
    return found_rows


def _statements(run: Run) -> Rows:
    """Return a number for the statement of each place."""
    numbers: dict[str, int] = {}
    return np.array([numbers.setdefault(statement(place), len(numbers)) for place in run.table.names["text"]], np.int64)


def _split(names: tuple[str, ...]) -> tuple[np.ndarray[tuple[int], np.dtype[np.bool_]], Rows]:
    """Return, for each access name such as "R I2CSTR", True if it is a read, and a number for its register."""
    numbers: dict[str, int] = {}
    registers = [numbers.setdefault(name[2:], len(numbers)) for name in names]
    return np.array([name.startswith("R ") for name in names], bool), np.array(registers, np.int64)


@dataclass(frozen=True)
class LostFlag:
    """One flag in the read-modify-writes of one place.

    rose: how often the flag rose between the read and the write.
    lost_between: how often that write then cleared it.
    along: how often it was set at the read and cleared by the write, though another flag was meant.
    unseen: how many of these `along` the firmware had not read since the flag rose. A read that named another field of
    the register does not count.
    first: the first of the ticks `cleared`, or None.
    lost: the ticks at which it was cleared without having been read, in order.
    cleared: the ticks at which it was cleared unintentionally, read or not.
    """

    flag: str
    rose: int
    lost_between: int
    along: int
    unseen: int
    first: int | None
    lost: tuple[int, ...]
    cleared: tuple[int, ...]


@dataclass(frozen=True)
class ReadModifyWrite:
    """The read-modify-writes of one place.

    meant: the flags that the firmware named, or that it certainly intended to clear.
    doubt: flags that were all set each time, so that the recording does not show which of them was meant.
    """

    unit: str
    register: str
    place: str
    count: int
    meant: tuple[str, ...]
    doubt: tuple[str, ...]
    flags: tuple[LostFlag, ...]

    @property
    def lost(self) -> int:
        """Number of times that a flag was cleared before the firmware had read it."""
        return sum(flag.lost_between + flag.unseen for flag in self.flags)


def modifies(run: Run, group: Group) -> list[ReadModifyWrite]:
    """Return the read-modify-writes of a group by place; none if writing 1 clears no field of the register."""
    fields = one_clears(group.register)
    if not fields or group.way != "W":
        return []
    reads, writes = pairs(run, group)
    found = []
    for place, some in run.by_place(writes):
        of_place = among(writes, some)
        found.append(_judged(run, group, place, reads[of_place], writes[of_place], fields))
    return found


def modifies_of(run: Run, groups: Iterable[Group]) -> tuple[ReadModifyWrite, ...]:
    """Return the read-modify-writes of several groups, those that lost most first."""
    found = [modify for group in groups for modify in modifies(run, group)]
    return tuple(sorted(found, key=lambda modify: -modify.lost))


def pairs(run: Run, group: Group) -> tuple[Rows, Rows]:
    """Return the reads and the writes, row by row, of the read-modify-writes among a group of writes."""
    found = read_modify_writes(run, group.unit)
    ours = among(found.writes, group.rows)
    return found.reads[ours], found.writes[ours]


def _judged(
    run: Run, group: Group, place: str, reads: Rows, writes: Rows, fields: tuple[Field, ...]
) -> ReadModifyWrite:
    values, written = run.table.value[reads], run.table.value[writes]
    proven = int(np.bitwise_or.reduce(written & ~values))
    always = int(np.bitwise_and.reduce(written))
    ones = [f for f in fields if always & f.mask]
    named = set(run.table.texts("field", writes)) - {""}
    meant = [f for f in fields if proven & f.mask] or (ones if len(ones) == 1 else [])
    if named:
        meant = [f for f in fields if f.name in named]
    doubt = ones if not meant and not named else []
    every = np.sort(run.accesses_of(group.unit, "R", group.module, group.register.name))
    plain = every[~among(every, reads)]
    flags = [
        _lost(run, group, f, reads, writes, run.looking_at(plain, f), f not in meant and f not in doubt)
        for f in fields
        if len(run.changes(group.unit, group.module, group.register, f))  # a flag that never changed was never lost
    ]
    return ReadModifyWrite(
        group.unit,
        f"{group.module}.{group.register.name}",
        place,
        len(writes),
        tuple(f.name for f in meant),
        tuple(f.name for f in doubt),
        tuple(flag for flag in flags if flag.rose or flag.along),
    )


def _lost(run: Run, group: Group, f: Field, reads: Rows, writes: Rows, plain: Rows, other: bool) -> LostFlag:
    """Return how often these read-modify-writes lost the flag.

    plain: reads of the flag that do not belong to these read-modify-writes. other: another flag was meant.
    """
    table = run.table
    changes = run.changes(group.unit, group.module, group.register, f)
    rises, falls = changes[table.value[changes] != 0], changes[table.value[changes] == 0]
    rose = np.searchsorted(rises, writes) > np.searchsorted(rises, reads)
    cleared = among(writes, run.made_by(falls))
    along = cleared & ~rose & (table.value[reads] & f.mask != 0) & other
    place = np.searchsorted(rises, reads) - 1
    last_rise = np.append(rises, -1)[place]
    last_read = np.append(plain, -1)[np.searchsorted(plain, reads) - 1]
    at = writes[(rose & cleared) | along]
    unseen = along & (last_read < last_rise)
    lost = writes[(rose & cleared) | unseen]
    return LostFlag(
        f.name,
        int(rose.sum()),
        int((rose & cleared).sum()),
        int(along.sum()),
        int(unseen.sum()),
        int(table.tick[at[0]]) if len(at) else None,
        tuple(table.tick[lost].tolist()),
        tuple(table.tick[at].tolist()),
    )
