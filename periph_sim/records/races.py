"""Time between the firmware's reads of status registers and changes of the fields that were read, for each place.

    reads, skipped polls  --> distance to the nearest change, in cycles --> closest, histogram by decades
    read-modify-writes    --> flags that rose between read and write; flags that the write cleared unintentionally

Skipped polls are the reads of a polling loop that the simulator did not run one by one. They are not recorded, but
reconstructed (`polls`).

A read of one field, as in `i2c.I2CSTR.XRDY == 1`, is compared with changes of that field. A read of the whole register,
as in `i2c.I2CSTR.all` or in the read-modify-write `i2c.I2CSTR.SCD = 1`, is compared with changes of all its fields.
Changes that an access of the firmware itself makes in the same tick are left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..core.records import Kind
from ..core.registers import Field
from ..processor.source_location import parsed
from .polls import LONGEST_PASS, MOST_READS, NDBool, skipped_polls
from .read_modify_write import ReadModifyWrite, modifies_of, read_modify_writes
from .run import Group, Rows, Run
from .subject import groups_of

DECADES = 6  # number of classes of distances in cycles: 0, 1 to 9, 10 to 99, 100 to 999, 1000 to 9999, and more
NEVER = np.iinfo(np.int64).max


@dataclass(frozen=True)
class NearMiss:
    """The read or reconstructed poll that came closest to a change on one side: before the change, or after it.

    cycles: distance between read and change.
    tick: the tick of the read.
    field: the field that changed.
    """

    cycles: int
    tick: int
    field: str


@dataclass(frozen=True)
class PlaceRaces:
    """The reads of one register at one place in the firmware, compared with the changes of the register.

    reads: number of recorded reads.
    polls: number of reads that were reconstructed from skipped waits.
    unplaced: number of waits during which a field that was read changed, and whose skipped polls could not be
        reconstructed.
    before: the read that was the fewest cycles before a change; None if no read was before a change.
    after: the read that was the fewest cycles after a change; None if no read was after a change.
    histogram: for each of the DECADES classes of distances, the number of reads and polls whose distance to the nearest
        change is in this class.
    alone: number of reads without a change to compare them with, because in this run the fields that they read changed
        only by accesses of the firmware, or never.
    """

    unit: str
    register: str
    place: str
    reads: int
    polls: int
    unplaced: int
    before: NearMiss | None
    after: NearMiss | None
    histogram: tuple[int, ...]
    alone: int

    @property
    def closest(self) -> int | None:
        return min((miss.cycles for miss in (self.before, self.after) if miss is not None), default=None)


@dataclass(frozen=True)
class Races:
    run: Run
    places: tuple[PlaceRaces, ...]
    modifies: tuple[ReadModifyWrite, ...]

    @property
    def closest(self) -> int | None:
        """The fewest cycles between any read and a change; None if no read could be compared with a change."""
        return min((place.closest for place in self.places if place.closest is not None), default=None)

    @property
    def lost(self) -> int:
        """Number of times that a read-modify-write cleared a flag that the firmware had not read since it rose."""
        return sum(modify.lost for modify in self.modifies)

    @property
    def along(self) -> int:
        """Number of times that a read-modify-write of another field cleared a flag, because it wrote back a 1."""
        return sum(flag.along for modify in self.modifies for flag in modify.flags)


def races(run: Run, register: str | None = None) -> Races:
    """Return the races of one register or field, such as "I2C-A.I2CSTR", or of all status registers.

    The places are in the order of their smallest distance between a read and a change. Raise NotInRun if the register
    does not exist or the firmware never accessed it.
    """
    chosen = groups_of(run, register)
    reads = [(group, f, place) for group, f in chosen if group.way == "R" for place in _reads_by_place(run, group)]
    places = [one for group, f, place in reads if (one := _judged(run, group, f, place)).reads]
    places.sort(key=lambda place: (NEVER if place.closest is None else place.closest, place.register, place.place))
    return Races(run, tuple(places), modifies_of(run, [group for group, _ in chosen]))


def distances(run: Run, register: str | None = None) -> tuple[Rows, Rows, int]:
    """Return (cycles, ticks, unplaced) for the reads of one register or field, or of all status registers.

    Raise NotInRun as `races` does.

    register: a name such as "I2C-A.I2CSTR"; None for all status registers.

    cycles: the distance of each read or reconstructed poll to the nearest change. Reads are left out if the run has no
        change to compare them with.
    ticks: the tick of each of these reads and polls. `cycles` and `ticks` are in order of time.
    unplaced: number of waits during which a field that was read changed, and whose skipped polls could not be
        reconstructed.
    """
    unplaced = 0
    cycles, ticks = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for group, f in groups_of(run, register):
        for place in _reads_by_place(run, group) if group.way == "R" else ():
            beside = _beside(run, group, f, place)
            unplaced += beside.unplaced
            nearest = beside.nearest
            at = beside.before.ticks[nearest < NEVER]
            cycles.append(run.clock(group.unit).of_distances(nearest[nearest < NEVER], at))
            ticks.append(at)
    when = np.concatenate(ticks)
    order = np.argsort(when, kind="stable")
    return np.concatenate(cycles)[order], when[order], unplaced


class _Reads(NamedTuple):
    """All reads of one register at a place.

    looked_at: for each read, the name of the field that was read, as an index into the names in the table of the run.
        For a read of the whole register, it is the index of the name "", or -1 if the table does not have this name.
    waits: for each read, True if the read and the next read at this place belong to the same wait. This is the case if
        the routine makes no access in between, or only reads that belong to the same loop (`_loops_of_an_image`).
    """

    place: str
    rows: Rows
    looked_at: Rows
    waits: NDBool


def _reads_by_place(run: Run, group: Group) -> Iterator[_Reads]:
    """Yield the reads of each place.

    The read of a read-modify-write counts as a read of the whole register, because the whole register is written back.
    """
    table = run.table
    rows, following = run.in_order(group.unit)
    order = np.argsort(rows)
    next_of = following[order][np.searchsorted(rows[order], group.rows)]
    for_writes = read_modify_writes(run, group.unit).reads
    whole = table.names["field"].index("") if "" in table.names["field"] else -1
    for place, reads in run.by_place(group.rows):
        nexts = next_of[np.searchsorted(group.rows, reads)]
        codes = table.columns["field"][reads].astype(np.int64)
        codes = np.where(np.isin(reads, for_writes), whole, codes)
        waits = np.append(reads[1:] == nexts[:-1], False)
        if parsed(place) is not None:
            waits |= _loops_of_an_image(run, group.unit, reads, nexts)
        yield _Reads(place, reads, codes, waits)


def _loops_of_an_image(run: Run, unit: str, reads: Rows, nexts: Rows) -> NDBool:
    """Return, for each read, True if a loop makes this read again after one or two reads at other places.

    In firmware that is a program image, each instruction that reads is a place, so one loop can have several places.
    A loop is assumed if all accesses in between are reads, and if the read is repeated after at most LONGEST_PASS
    cycles or after a recorded wait.
    """
    rows, following = run.in_order(unit)
    order = np.argsort(rows)
    is_read = np.array([name.startswith("R ") for name in run.table.names["what"]], bool)
    asleep = run.rows(Kind.WAIT, unit)
    slept = np.diff(np.searchsorted(asleep, reads), append=len(asleep)) > 0
    longest = run.clock(unit).ticks_of(LONGEST_PASS, run.table.tick[reads])
    short = np.diff(run.table.tick[reads], append=np.iinfo(np.int64).max) <= longest
    found, at, only_reads = np.zeros(len(reads), bool), nexts, np.ones(len(reads), bool)
    for _ in range(MOST_READS - 1):
        there = at >= 0
        only_reads &= there & is_read[run.table.columns["what"][at]]
        place = np.minimum(np.searchsorted(rows[order], at), len(rows) - 1)
        at = np.where(there, following[order][place], -1)
        found |= only_reads & (np.append(reads[1:], -1) == at) & (at >= 0)
    return found & (slept | short)


def _changes(run: Run, group: Group, fields: tuple[Field, ...]) -> Rows:
    """Return the rows at which the fields changed, except changes that an access of the unit made in the same tick."""
    of = [run.changes(group.unit, group.module, group.register, each) for each in fields]
    rows = np.sort(np.concatenate(of))
    others: Rows = rows[~np.isin(run.made_by(rows), run.in_order(group.unit)[0])]
    return others


class _Side(NamedTuple):
    """Reads and reconstructed polls, each paired with a change: the next one, or the previous one.

    ticks: the tick of each read or poll.
    distances: the number of ticks between each read and its change; NEVER if there is no such change.
    changes: for each read, the row of its change; meaningless if the distance is NEVER.
    """

    ticks: Rows
    distances: Rows
    changes: Rows


NONE = _Side(*(np.zeros(0, np.int64) for _ in range(3)))


class _Beside(NamedTuple):
    """The reads of a place and its reconstructed polls, with the changes of the fields that they read.

    before: each read or poll with the next change.
    after: the same reads and polls, each with the last change.
    reads: number of recorded reads.
    unplaced: number of waits during which a field that was read changed, and whose skipped polls could not be
        reconstructed.
    """

    before: _Side
    after: _Side
    reads: int
    unplaced: int

    @property
    def nearest(self) -> Rows:
        """The distance in ticks from each read or poll to the nearest change; NEVER if there is no change."""
        return np.minimum(self.before.distances, self.after.distances)


def _beside(run: Run, group: Group, f: Field | None, place: _Reads) -> _Beside:
    """Return the reads of a place and its reconstructed polls, each with the nearest changes.

    f: the field to which reads and changes are limited; None for all fields.
    """
    before, after, reads = [NONE], [NONE], 0
    unplaced = np.zeros(0, np.int64)
    tick = run.table.tick
    for code in sorted(set(place.looked_at.tolist())):
        name = run.table.names["field"][code] if code >= 0 else ""
        fields = (group.register[name],) if name in group.register else group.register.fields
        fields = tuple(each for each in fields if f is None or each is f)
        if not fields:
            continue
        changes, looking = _changes(run, group, fields), place.looked_at == code
        polls = skipped_polls(run, group.unit, place.rows, place.waits, changes, looking)
        rows = place.rows[looking]
        for ticks, next_changes in (
            (tick[rows], np.searchsorted(changes, rows)),
            (polls.ticks, np.searchsorted(tick[changes], polls.ticks, "right")),
        ):
            sides = _sides(run, ticks, next_changes, changes)
            before.append(sides[0])
            after.append(sides[1])
        reads += len(rows)
        unplaced = np.union1d(unplaced, polls.unplaced)
    return _Beside(_joined(before), _joined(after), reads, len(unplaced))


def _sides(run: Run, ticks: Rows, at: Rows, changes: Rows) -> tuple[_Side, _Side]:
    """Return all reads or polls with the next change after each, and again with the last change before each.

    ticks: the ticks of the reads or polls.
    at: for each of them, the index of the next change in `changes`.
    changes: the rows of the changes, in order.
    """
    rows = np.append(changes, 0)
    ends = run.table.tick[rows]
    to_next = np.where(at < len(changes), ends[at] - ticks, NEVER)
    since = np.where(at > 0, ticks - ends[at - 1], NEVER)
    return _Side(ticks, to_next, rows[at]), _Side(ticks, since, rows[at - 1])


def _joined(sides: list[_Side]) -> _Side:
    return _Side(*(np.concatenate(column) for column in zip(*sides, strict=True)))


def _judged(run: Run, group: Group, f: Field | None, place: _Reads) -> PlaceRaces:
    beside = _beside(run, group, f, place)
    nearest, ticks = beside.nearest, beside.before.ticks
    cycles = run.clock(group.unit).of_distances(nearest[nearest < NEVER], ticks[nearest < NEVER])
    decades = np.minimum(np.searchsorted(10 ** np.arange(DECADES - 1), cycles, "right"), DECADES - 1)
    return PlaceRaces(
        group.unit,
        f"{group.module}.{group.register.name}",
        place.place,
        beside.reads,
        len(ticks) - beside.reads,
        beside.unplaced,
        _closest(run, group.unit, beside.before, 1),
        _closest(run, group.unit, beside.after, -1),
        tuple(np.bincount(decades, minlength=DECADES).tolist()),
        int((nearest == NEVER).sum()),
    )


def _closest(run: Run, unit: str, side: _Side, way: int) -> NearMiss | None:
    """Return the read that is closest to its change; None if no read has a change.

    If several reads are equally close, the earliest of them is returned.

    way: 1 if the changes in `side` follow the reads, -1 if they precede the reads.
    """
    if not len(side.distances) or int(side.distances.min()) == NEVER:
        return None
    distance = int(side.distances.min())
    closest = np.flatnonzero(side.distances == distance)
    first = closest[np.argmin(side.ticks[closest])]
    field = run.record(int(side.changes[first])).what.partition(".")[2]
    read = int(side.ticks[first])
    return NearMiss(abs(run.clock(unit).cycles(read, read + way * distance)), read, field)
