"""Read-modify-writes of a run: the read and the write of one statement, and the flags that are lost.

    i2c.I2CSTR.SCD = 1     reads I2CSTR, sets SCD, and writes I2CSTR a few cycles later; this also clears every other
                           flag that was read as 1. Both accesses have the same statement, routine and field.

The CPU may make other accesses before the write is made, so the write need not be the next access.

A flag is lost if it is cleared although the firmware has not read it since its last rise.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..processor.source_location import statement
from .cleared_flags import CLEARABLE, Clearable, ClearedRegister, FlagOfPlace, Modify
from .register_maps import MODIFY, OVERTAKEN
from .run import Group, Rows, Run, among


class ReadWritePairs(NamedTuple):
    """Rows of reads and of the writes that belong to them, in the order of the writes."""

    reads: Rows
    writes: Rows

    def read_of(self, write: int) -> int | None:
        """Return the row of the read that belongs to the write in row `write`; None for a plain write."""
        place = int(np.searchsorted(self.writes, write))
        return int(self.reads[place]) if place < len(self.writes) and self.writes[place] == write else None


def read_modify_writes(run: Run, unit: str) -> ReadWritePairs:
    """Return all read-modify-writes of a unit's firmware."""
    return ReadWritePairs(*run.remembered(f"read-modify-writes of {unit}", lambda: _found(run, unit)))


def _found(run: Run, unit: str) -> Rows:
    table = run.table
    rows, _ = run.in_order(unit)
    what = table.columns["what"][rows]
    is_read = np.array([name.startswith("R ") for name in table.names["what"]], bool)[what]
    register = np.unique([name[2:] for name in table.names["what"]], return_inverse=True)[1][what]
    statements = np.unique([statement(place) for place in table.names["text"]], return_inverse=True)[1]
    same = [register, statements[table.columns["text"][rows]], table.columns["field"][rows], table.cause[rows]]
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
    found_rows: Rows = np.stack([of_write[order], np.concatenate(writes)[order]])
    return found_rows


@dataclass(frozen=True)
class LostFlag:
    """One flag in the read-modify-writes of one place.

    rose: number of times that the flag rose between the read and the write.
    lost_between: number of the times in `rose` at which the write cleared the flag.
    along: number of times that the read returned the flag as 1 and the write cleared it, although the firmware intended
        to clear only other flags.
    unseen: number of the times in `along` at which the firmware had not read the flag since its last rise. A read of
        another field does not count as a read of the flag, nor does a read by the read-modify-writes of this place.
    lost: the ticks of the writes that `lost_between` and `unseen` count, in order.
    cleared: the ticks of the writes that `lost_between` and `along` count, in order. These are all writes that cleared
        the flag unintentionally, whether the firmware had read it or not.
    """

    flag: str
    rose: int
    lost_between: int
    along: int
    unseen: int
    lost: tuple[int, ...]
    cleared: tuple[int, ...]

    @property
    def first(self) -> int | None:
        """The first tick at which the flag was cleared unintentionally; None if this never happened."""
        return self.cleared[0] if self.cleared else None


@dataclass(frozen=True)
class ReadModifyWrite:
    """The read-modify-writes of one register at one place.

    count: number of read-modify-writes.
    meant: the flags that the firmware named, or that it certainly intended to clear; empty if `doubt` is not.
    doubt: the flags that every write set to 1, if the recording does not show which of them the firmware intended to
        clear; else empty.
    flags: the flags that rose between a read and its write, or that were cleared unintentionally.
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
        """Number of times that a flag was cleared although the firmware had not read it since its last rise."""
        return sum(flag.lost_between + flag.unseen for flag in self.flags)


def modifies_of(run: Run, groups: Iterable[Group]) -> tuple[ReadModifyWrite, ...]:
    """Return the read-modify-writes of several groups, one object for each register and place.

    The places at which flags were lost most often come first. Registers without a field that is cleared by writing 1
    are left out.
    """
    found = []
    for group in groups:
        name = f"{group.module}.{group.register.name}"
        if group.way == "W" and name in CLEARABLE:
            judged = _judged(run, group, CLEARABLE[name])
            places = sorted(judged.places, key=run.table.names["text"].index)
            found += [_of_place(judged, group.unit, name, place) for place in places]
    return tuple(sorted(found, key=lambda modify: -modify.lost))


def pairs(run: Run, group: Group) -> tuple[Rows, Rows]:
    """Return the rows (reads, writes) of the read-modify-writes whose writes are in the group, as pairs in order."""
    found = read_modify_writes(run, group.unit)
    ours = among(found.writes, group.rows)
    return found.reads[ours], found.writes[ours]


def _judged(run: Run, group: Group, clearable: Clearable) -> ClearedRegister:
    """Return what all read-modify-writes of one register did to its flags.

    group: the writes of the register.
    clearable: the name of the register, and its flags that are cleared by writing 1.
    """
    judged = ClearedRegister(clearable, keeps_ticks=True)
    table = run.table
    reads, writes = pairs(run, group)
    changes = [run.changes(group.unit, group.module, group.register, field) for field in clearable.flags]
    rows = np.sort(np.concatenate([writes, *changes])) if len(writes) else writes
    made: dict[int, Modify] = {}
    figures = (column[rows].tolist() for column in (table.number, table.tick, table.value, table.cause))
    for number, tick, value, cause, what, text in zip(
        *figures, table.texts("what", rows), table.texts("text", rows), strict=True
    ):
        flag = judged.flag(what.partition(".")[2])
        if flag is None or what.startswith("W "):
            made[number] = judged.written(number, tick, value, text)
        else:
            judged.flag_changed(flag, number, tick, value, cause)
    of_read = dict(zip(table.number[reads].tolist(), table.number[writes].tolist(), strict=True))
    rows = np.sort(run.accesses_of(group.unit, "R", group.module, group.register.name)) if made else writes
    figures = (column[rows].tolist() for column in (table.number, table.value))
    for number, value, field in zip(*figures, table.texts("field", rows), strict=True):
        judged.judge(number, value, field, made.get(of_read.get(number, 0)))
    return judged


def _of_place(register: ClearedRegister, unit: str, name: str, place: str) -> ReadModifyWrite:
    of = register.places[place]
    may_mean = of.meant(register.flags)
    meant = tuple(flag.name for flag in register.flags if flag.name in may_mean)
    in_doubt = not of.named and len(meant) > 1 and not any(of.proven & flag.mask for flag in register.flags)
    flags = [
        _lost(flag.name, found, flag.name not in may_mean)
        for flag, found in zip(register.flags, of.flags, strict=True)
        if found.rose or (found.along.count and flag.name not in may_mean)
    ]
    return ReadModifyWrite(
        unit, name, place, of.count, () if in_doubt else meant, meant if in_doubt else (), tuple(flags)
    )


def _lost(name: str, found: FlagOfPlace, other: bool) -> LostFlag:
    """Return the LostFlag of a flag at a place.

    other: True if the firmware intends to clear only other flags here. If it is False, `LostFlag.along` and
        `LostFlag.unseen` are 0.
    """
    between, along, unseen = (found.between.ticks or [], found.along.ticks or [], found.unseen.ticks or [])
    if not other:
        along = unseen = []
    lost, cleared = tuple(sorted(between + unseen)), tuple(sorted(between + along))
    return LostFlag(name, found.rose, len(between), len(along), len(unseen), lost, cleared)
