"""Measures over a table of the records of a run, as arrays.

    table = formats.psr.read_table(path)
    timing.between(table, "bus address 0x68 read", "access W I2C-A.I2CDXR") --> durations and starts, int64 ticks

`between` measures `from EVENT to EVENT` in the table. `races` and `lost_flags` give the results of `periph-sim races`
(`records/races.py`, `records/read_modify_write.py`). The measure `Race` of a scene stores its records in such a table
and evaluates them when the run is over:

    records --RaceRecords--> records.Run, when the run is over --> distances in cycles
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...core.records import UNWANTED, Kind, Recorder, Subjects
from ...core.state import State
from ...records.read_modify_write import modifies_of
from ...records.run import NotInRun, Run
from ...records.subject import groups_of
from ...traces.formats.record_table import Columns, RecordTable
from ..language.events import matcher, stretch_of
from ..language.language import measure_of
from ..language.matcher import ANYTHING, Matcher
from ..language.scope import BadEvent, scope_of_table
from .measure import Measure, MeasuredScene
from .pair import FIRST, SECOND, START, Between
from .watched_register import Watched, losing, raced

Ticks = NDArray[np.int64]


class Durations(NamedTuple):
    """Durations between pairs of events, in ticks.

    duration: from the first event to the second. start: the tick of the first event.
    """

    duration: Ticks
    start: Ticks


def between(
    table: RecordTable, begin: str, end: str, rule: str = "", transfers_in_round: int | None = None
) -> Durations:
    """Return the duration from each `begin` to the `end` that belongs to it, if there is one.

    rule: the rule after the comma in a budget: "in order", "next" or "last"; "same transfer" or "same round" for pairs
    within a transfer or round, which ends at the START of the next transfer or round; or both: "last, same transfer".
    transfers_in_round: the number of transfers in a round; needed for "same round", because no record contains it.

    Raise BadEvent for another rule, or if a text names no event, or an event that this run cannot contain. Raise
    BadEvent also if a second `begin` comes before the `end` of the first one and no rule says to which of them the
    `end` belongs.
    """
    said = measure_of(f"from {begin} to {end}, {rule}" if rule else f"from {begin} to {end}")
    group = said.group
    if group == "unit" or said.clauses:
        raise BadEvent(f"{rule!r}: over a recorded run a rule is in order, next, last, same transfer or same round")
    scope = scope_of_table(table)
    first, second = (matcher(event, scope) for event in said.events)
    events = [(row, FIRST) for row in rows_of(first, table).tolist()]
    events += [(row, SECOND) for row in rows_of(second, table).tolist()]
    stretch = stretch_of(group, scope, f"'same {group}'") if group else None
    if stretch is not None:
        starts = rows_of(stretch.begin, table)
        if group == "round":
            if transfers_in_round is None or transfers_in_round < 1:
                raise BadEvent("same round needs transfers_in_round, 1 or more: no record says how many a round has")
            starts = starts[::transfers_in_round]
        events += [(row, START) for row in starts.tolist()]
    measure = Between(first, second, said.pairing, stretch)
    measure.keep()
    # Of events of the same record, the start of a transfer or round is first, then the end of a pair, then the start of
    # a pair.
    for row, place in sorted(events, key=lambda event: (event[0], -event[1])):
        measure.happened(place, int(table.tick[row]), 0)
    if measure.again is not None:
        raise BadEvent(
            f"{begin!r} of tick {measure.again[0]} came again before {end!r}, so it is not known which belong "
            "together; give the rule in order, next or last"
        )
    return Durations(*measure.all_kept())


def rows_of(matcher: Matcher, table: RecordTable) -> NDArray[np.int64]:
    """Return the rows of the table at which an event happened, in order.

    Raise BadEvent for an event that counts once per group, such as "last ... of transfer". Only budgets in a scene can
    recognize such an event.
    """
    if matcher.group is not None:
        raise BadEvent(f"{matcher.text!r}: over a recorded run every one is found; leave first, last or the number out")
    found = np.zeros(len(table), bool)
    for one in matcher.each:
        what = None if one.what == ANYTHING else frozenset((one.what,))
        wanted = _named(table, "kind", frozenset((one.kind.value,))) & _named(table, "what", what)
        found |= wanted & _named(table, "where", one.where) & (table.value & one.mask == one.want)
    return np.flatnonzero(found)


def _named(table: RecordTable, column: str, names: frozenset[str] | None) -> NDArray[np.bool_]:
    if names is None:
        return np.ones(len(table), bool)
    known = np.array([name in names for name in table.names[column]], bool)
    return known[table.columns[column]] if len(known) else np.zeros(len(table), bool)


def periods(table: RecordTable, event: str) -> Durations:
    """Return the duration from each occurrence of an event to the next one.

    Raise BadEvent if the text names no event, or an event that this run cannot contain.
    """
    ticks = happened(table, event)
    return Durations(np.diff(ticks), ticks[:-1])


def happened(table: RecordTable, event: str) -> Ticks:
    """Return the ticks at which an event happened.

    Raise BadEvent if the text names no event, or an event that this run cannot contain.
    """
    return table.tick[rows_of(matcher(event, scope_of_table(table)), table)]


class RaceRecords(Columns):
    """Stores the records for a measure of races: accesses of the register's unit, and changes of the register."""

    def __init__(self, watched: Watched) -> None:
        super().__init__()
        self._watched = watched

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        return super().tag_of(kind, where, what) if self._watched.concerns(kind, where, what) else UNWANTED


class Race(Measure):
    """Distance, in SYSCLKOUT cycles, of each CPU read of a status register to the nearest change of the bits read.

    The records are stored, and evaluated after the run like those of a recorded run. The simulator can skip the polls
    of a wait. If skipped polls near a change cannot be reconstructed, the budget is not judged.
    """

    STATE = State("_kept_records")
    unit = "cycles"
    kinds = frozenset({Kind.ACCESS, Kind.FLAG})

    def __init__(self, watched: Watched) -> None:
        super().__init__()
        self.looks_back = "the whole run"
        self.watched = watched
        self._kept_records: Columns = RaceRecords(watched)
        self._unplaced = 0

    @property
    def subjects(self) -> Subjects:
        watched = self.watched
        return {Kind.FLAG: {f"{watched.unit}.{watched.module}.{watched.register}"}}

    @property
    def silent(self) -> bool:
        return not self.count or self._unplaced > 0

    def listen(self, scene: MeasuredScene) -> None:
        self._per_second = scene.ticks_per_second
        self._clocks = {self.watched.unit: scene.clock_history(self.watched.unit)}

    def subscribe(self, recorder: Recorder) -> None:
        recorder.subscribe(self.kinds, self._kept_records, self.subjects)

    def finish(self, now: int) -> None:
        from ...records.races import distances  # imported here, because `lost_flags` does not need it

        run = Run(self._kept_records.table(Fraction(self._per_second), now, {}, self._clocks))
        self._kept_records.clear()
        try:
            cycles, ticks, self._unplaced = distances(run, self.watched.name)
        except NotInRun:  # firmware never accessed the register, so no value is taken
            return
        for value, at in zip(cycles.tolist(), ticks.tolist(), strict=True):
            self.take(value, at)

    def why_silent(self) -> str:
        if self._unplaced:
            return (
                f"in {self._unplaced} skipped waits for {self.watched.text}, the polls next to a change are not known; "
                "skip_polls = false in the unit's table makes and records each poll"
            )
        return f"no read of {self.watched.text} had a change to be compared with"


class Distances(NamedTuple):
    """Distances between reads and changes, one for each read or reconstructed poll, as int64.

    Reads without a change to compare them with are left out.

    cycles: the distance from the read to the nearest change. tick: the tick of the read.
    """

    cycles: NDArray[np.int64]
    tick: NDArray[np.int64]


def races(table: RecordTable, name: str, sysclk: Fraction | None = None) -> Distances:
    """Return the cycles between each read of a status register, or of one field, and the nearest change.

    name: the register or field, such as "I2C-A.I2CSTR" or "imu:I2C-A.I2CSTR.XRDY".
    sysclk: SYSCLKOUT in Hz; None if the table has the history of SYSCLKOUT.

    Raise BadEvent if the run cannot contain this register, and NotInRun if the firmware never accessed it.
    """
    from ...records.races import distances

    unit, _, text = name.rpartition(":")
    cycles, tick, _ = distances(Run(table, sysclk=sysclk), raced(unit, text, scope_of_table(table)).name)
    return Distances(cycles, tick)


def lost_flags(table: RecordTable, name: str = "") -> NDArray[np.int64]:
    """Return the ticks at which read-modify-writes cleared flags of a register unintentionally.

    name: the register, such as "I2C-A.I2CSTR"; "" for all registers. A flag is listed if firmware had not read it.

    Raise BadEvent if the run cannot contain this register, or if writing 1 clears no flag of it.
    """
    unit, _, text = name.rpartition(":")
    run, watched = Run(table), losing(unit, text, scope_of_table(table))
    try:
        groups = [group for group, _ in groups_of(run, watched.name)]
    except NotInRun:  # the firmware never accessed the register
        groups = []
    lost = sorted(tick for modify in modifies_of(run, groups) for flag in modify.flags for tick in flag.lost)
    return np.array(lost, np.int64)
