"""Measure of races, and functions for the races and lost flags of a table of records.

    records --Kept--> records.Run, when the run is over --> distances in cycles

The result equals that of `periph-sim races` on a recorded run (`records/races.py`, `records/read_modify_write.py`).
"""

from __future__ import annotations

from dataclasses import replace
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
from ..language.scope import scope_of_table
from .measure import Measure, MeasuredScene
from .watched import Watched, losing, raced


class Kept(Columns):
    """Stores the records that concern the watched register."""

    def __init__(self, watched: Watched) -> None:
        super().__init__()
        self._watched = watched

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        return super().tag_of(kind, where, what) if self._watched.concerns(kind, where, what) else UNWANTED


class Race(Measure):
    """Distance, in SYSCLKOUT cycles, of each CPU read of a status register to the nearest change of the bits read.

    All records of the register are stored, and evaluated after the run like a recorded run.
    Nothing is proven if a wait was skipped and its polls near a change cannot be reconstructed.
    """

    STATE = State("_kept_records")
    unit = "cycles"
    kinds = frozenset({Kind.ACCESS, Kind.FLAG})

    def __init__(self, watched: Watched) -> None:
        super().__init__()
        self.looks_back = "the whole run"
        self.watched = watched
        self._kept_records: Columns = Kept(watched)
        self._unplaced = 0

    @property
    def subjects(self) -> Subjects:
        watched = self.watched
        return {Kind.FLAG: {f"{watched.unit}.{watched.module}.{watched.register}"}}

    @property
    def silent(self) -> bool:
        return not self.count or self._unplaced > 0

    def listen(self, scene: MeasuredScene) -> None:
        self._per_second = scene.ticks_per_second()
        self._clocks = {self.watched.unit: scene.clock_history(self.watched.unit)}

    def subscribe(self, recorder: Recorder) -> None:
        recorder.subscribe(self.kinds, self._kept_records, self.subjects)

    def finish(self, now: int) -> None:
        from ...records.races import distances  # imported here, because `lost_flags` does not need it

        run = Run(replace(self._kept_records.table(Fraction(self._per_second), now, {}), clocks=self._clocks))
        self._kept_records.clear()
        try:
            cycles, ticks, self._unplaced = distances(run, self.watched.name)
        except NotInRun:  # never accessed: nothing was measured, and `missing` says so
            return
        for value, at in zip(cycles.tolist(), ticks.tolist(), strict=True):
            self.take(value, at)

    def why_silent(self) -> str:
        if self._unplaced:
            return (
                f"of {self._unplaced} skipped waits for {self.watched.text} the polls beside a change are not known; "
                "skip_polls = false in the unit's table makes and records each of them"
            )
        return f"no read of {self.watched.text} had a change to be compared with"


class Distances(NamedTuple):
    """Distances between reads and changes, one for each read, as int64.

    cycles: the distance from the read to the nearest change. tick: the tick of the read.
    """

    cycles: NDArray[np.int64]
    tick: NDArray[np.int64]


def races(table: RecordTable, name: str, sysclk: Fraction | None = None) -> Distances:
    """Return the cycles between each read of a status register, or of one field, and the nearest change.

    name: such as "I2C-A.I2CSTR" or "imu:I2C-A.I2CSTR.XRDY". sysclk: in Hz; None for the clock in the records.

    Raise BadEvent if the run cannot contain this register, and NotInRun if the firmware never accessed it.
    """
    from ...records.races import distances

    unit, _, text = name.rpartition(":")
    cycles, tick, _ = distances(Run(table, sysclk=sysclk), raced(unit, text, scope_of_table(table)).name)
    return Distances(cycles, tick)


def lost_flags(table: RecordTable, name: str = "") -> NDArray[np.int64]:
    """Return the ticks at which read-modify-writes lost flags of a register, or of all registers if `name` is empty.

    Raise BadEvent as `races` does.
    """
    unit, _, text = name.rpartition(":")
    run, watched = Run(table), losing(unit, text, scope_of_table(table))
    try:
        groups = [group for group, _ in groups_of(run, watched.name)]
    except NotInRun:  # the firmware never accessed the register
        groups = []
    lost = sorted(tick for modify in modifies_of(run, groups) for flag in modify.flags for tick in flag.lost)
    return np.array(lost, np.int64)
