"""How near the firmware's reads of status registers came to the changes of their flags, place by place.

reads, polls put back --> distance to the nearest change, in cycles --> closest, histogram by decades
read-modify-writes    --> flags that rose in between, flags cleared unmeant
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..core.nearest import near
from ..core.registers import Field, Register
from .maps import is_status
from .modify import Modify, modifies
from .polls import NDBool, skipped_polls
from .run import Group, NotInRun, Rows, Run

DECADES = 6  # below 1 cycle, 1 to 9, 10 to 99, up to 1000, up to 10 000, more
NEVER = np.iinfo(np.int64).max


@dataclass(frozen=True)
class Shave:
    """The closest of one side. cycles: between read and change. tick: of the read."""

    cycles: int
    tick: int
    field: str


@dataclass(frozen=True)
class PlaceRaces:
    """One place's reads of one register. before: a read that just missed a change; after: one that just saw it.

    polls: put back from skipped waits. unplaced: skipped waits with a change whose polls could not be put back.
    histogram: reads by the distance to their nearest change, by decades of cycles; `alone` had no change to compare.
    """

    unit: str
    register: str
    place: str
    reads: int
    polls: int
    unplaced: int
    before: Shave | None
    after: Shave | None
    histogram: tuple[int, ...]
    alone: int

    @property
    def closest(self) -> int | None:
        return min((shave.cycles for shave in (self.before, self.after) if shave is not None), default=None)


@dataclass(frozen=True)
class Races:
    run: Run
    places: tuple[PlaceRaces, ...]
    modifies: tuple[Modify, ...]

    @property
    def closest(self) -> int | None:
        """The fewest cycles between any read and a change; None where there was none."""
        return min((place.closest for place in self.places if place.closest is not None), default=None)

    @property
    def lost(self) -> int:
        """Flags that read-modify-writes cleared without meaning them, and that the firmware cannot have seen."""
        return sum(modify.lost for modify in self.modifies)

    @property
    def along(self) -> int:
        """Flags that read-modify-writes cleared without meaning them, seen or not."""
        return sum(flag.along for modify in self.modifies for flag in modify.flags)


def races(run: Run, register: str | None = None) -> Races:
    """All status registers, or one as "I2C-A.I2CSTR" or one field of it; closest first.

    NotInRun where the firmware never accessed such a register, or there is none.
    """
    chosen = _chosen(run, register)
    places = [place for group, f in chosen if group.way == "R" for place in _places(run, group, f)]
    found = [modify for group, _ in chosen for modify in modifies(run, group)]
    places.sort(key=lambda place: (NEVER if place.closest is None else place.closest, place.register, place.place))
    return Races(run, tuple(places), tuple(sorted(found, key=lambda modify: -modify.lost)))


def _named(run: Run, name: str) -> list[tuple[Group, Field | None]]:
    wanted = _folded(name)
    known: dict[str, list[tuple[Group, Field | None]]] = {}
    for group in run.accesses:
        for unit in ("", f"{group.unit}."):
            text = f"{unit}{group.module}.{group.register.name}"
            known.setdefault(text, []).append((group, None))
            for f in group.register.fields:
                known.setdefault(f"{text}.{f.name}", []).append((group, f))
    for text, found in known.items():
        if _folded(text) == wanted:
            return found
    registers = [text for text in known if text.count(".") == min(max(name.count("."), 1), 2)]
    raise NotInRun(f"{run.name}: the firmware never accessed {name!r}; {near(name, registers)}")


def _folded(name: str) -> str:
    return name.casefold().replace("-", "")


def distances(run: Run, register: str | None = None) -> tuple[Rows, Rows, int]:
    """(cycles, ticks, unplaced): of each read and each poll put back that has a change to be compared with, how many
    cycles lie between the two, and when it was, in the order of time; and the skipped waits with a change whose polls
    could not be put back. NotInRun as for `races`."""
    unplaced = 0
    cycles, ticks = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for group, f in _chosen(run, register):
        if group.way == "R":
            changes = _changes(run, group, f)
            for _, reads, waits in _reads_by_place(run, group):
                beside = _beside(run, reads, changes, waits)
                unplaced += beside.unplaced
                compared = beside.nearest < NEVER
                cycles.append(_cycles(run, beside.nearest[compared]))
                ticks.append(beside.ticks[compared])
    when = np.concatenate(ticks)
    order = np.argsort(when, kind="stable")
    return np.concatenate(cycles)[order], when[order], unplaced


def _chosen(run: Run, register: str | None) -> list[tuple[Group, Field | None]]:
    if register is not None:
        return _named(run, register)
    return [(group, None) for group in run.accesses if is_status(group.register)]


def _places(run: Run, group: Group, f: Field | None) -> list[PlaceRaces]:
    changes = _changes(run, group, f)
    return [_judged(run, group, place, reads, changes, waits) for place, reads, waits in _reads_by_place(run, group)]


def _reads_by_place(run: Run, group: Group) -> Iterator[tuple[str, Rows, NDBool]]:
    """Each place with its reads, and whether the routine's next access is the next one of them."""
    rows, following = run.in_order(group.unit)
    order = np.argsort(rows)
    next_of = following[order][np.searchsorted(rows[order], group.rows)]
    for place, reads in run.by_place(group.rows):
        nexts = next_of[np.searchsorted(group.rows, reads)]
        yield place, reads, np.append(reads[1:] == nexts[:-1], False)


def _changes(run: Run, group: Group, f: Field | None) -> Rows:
    """The rows at which fields changed that were not changed, in that cycle, by an access of the unit itself."""
    of = [run.changes(group.unit, group.module, group.register, each) for each in _fields(group.register, f)]
    rows = np.sort(np.concatenate(of))
    others: Rows = rows[~np.isin(run.made_by(rows), run.in_order(group.unit)[0])]
    return others


def _fields(register: Register, f: Field | None) -> tuple[Field, ...]:
    return register.fields if f is None else (f,)


class _Beside(NamedTuple):
    """Ticks from reads to the changes beside them. ticks, nearest: of all of them, recorded reads first."""

    before_ticks: Rows
    before: Rows
    after_ticks: Rows
    after: Rows
    ticks: Rows
    nearest: Rows
    polls: int
    unplaced: int


def _beside(run: Run, reads: Rows, changes: Rows, waits: NDBool) -> _Beside:
    tick = run.table.tick
    polls = skipped_polls(run, reads, waits, changes)
    at = np.searchsorted(changes, reads)
    ends = np.append(tick[changes], NEVER)
    to_next = np.where(at < len(changes), ends[at] - tick[reads], NEVER)
    since = np.where(at > 0, tick[reads] - np.append(tick[changes], 0)[at - 1], NEVER)
    missed, saw = polls.before >= 0, polls.after >= 0
    missed_at, saw_at = polls.before[missed], polls.after[saw]
    to_missed, since_seen = (polls.changes - polls.before)[missed], (polls.after - polls.changes)[saw]
    return _Beside(
        np.concatenate([tick[reads], missed_at]),
        np.concatenate([to_next, to_missed]),
        np.concatenate([tick[reads], saw_at]),
        np.concatenate([since, since_seen]),
        np.concatenate([tick[reads], missed_at, saw_at]),
        np.concatenate([np.minimum(to_next, since), to_missed, since_seen]),
        len(missed_at) + len(saw_at),
        polls.unplaced,
    )


def _cycles(run: Run, ticks: Rows) -> Rows:
    """Whole cycles, rounded to nearest."""
    cycles: Rows = (ticks / float(run.cycles.ticks) + 0.5).astype(np.int64)
    return cycles


def _judged(run: Run, group: Group, place: str, reads: Rows, changes: Rows, waits: NDBool) -> PlaceRaces:
    beside = _beside(run, reads, changes, waits)
    cycles = _cycles(run, beside.nearest[beside.nearest < NEVER])
    decades = np.minimum(np.searchsorted(10 ** np.arange(DECADES - 1), cycles, "right"), DECADES - 1)
    return PlaceRaces(
        group.unit,
        f"{group.module}.{group.register.name}",
        place,
        len(reads),
        beside.polls,
        beside.unplaced,
        _closest(run, changes, beside.before_ticks, beside.before, 1),
        _closest(run, changes, beside.after_ticks, beside.after, -1),
        tuple(np.bincount(decades, minlength=DECADES).tolist()),
        int((beside.nearest == NEVER).sum()),
    )


def _closest(run: Run, changes: Rows, ticks: Rows, distances: Rows, side: int) -> Shave | None:
    """side: 1 where the change comes after the read, -1 where before."""
    distance = int(distances.min())
    if distance == NEVER:
        return None
    tick = int(ticks[distances == distance].min())  # the first of several
    at = tick + side * distance
    row = changes[np.searchsorted(run.table.tick[changes], at)]
    return Shave(run.cycles.of(distance), tick, run.record(int(row)).what.partition(".")[2])
