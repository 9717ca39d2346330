"""Races and lost flags as measures: accesses and flag changes go in, distances and what was lost come out.

    records --Kept--> records.Run, when the run is over --> distances in cycles
        '---Modifies--------------------------------------> flags lost to read-modify-writes

What counts is what `periph-sim races` shows of a recorded run (`records/races.py`, `records/lost_flags.py`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from ...core.records import UNHEARD, Kind, Record, Recorder, Subjects
from ...core.suggest import did_you_mean
from ...core.time import NO_TIME
from ...records.lost_flags import ReadModifyWrite, modifies_of
from ...records.register_choice import groups_of
from ...records.register_maps import is_status, one_clears
from ...records.run import NotInRun, Run
from ...traces.formats.record_table import Columns, RecordTable
from ..language.scope import MAPS, BadEvent, Scope, scope_of_table
from .measure import Measure, SceneEvents
from .modifies import CLEARABLE, Modifies


class Watched(Struct, frozen=True):
    """A status register, or one field of it. unit, module, register: empty for all of the scene's, with its units."""

    text: str
    unit: str = ""
    module: str = ""
    register: str = ""
    field: str = ""
    units: tuple[str, ...] = ()

    @property
    def name(self) -> str | None:
        """As `insight` calls it."""
        return ".".join(filter(None, (self.unit, self.module, self.register, self.field))) or None

    def shows(self, record: Record) -> bool:
        """Whether a record is an access to the register, or a change of what is watched of it."""
        return self.is_about(record.kind, record.where, record.what)

    def is_about(self, kind: Kind, where: str, what: str) -> bool:
        """The same, of all records of one kind, place and thing."""
        if kind is Kind.ACCESS:
            place = f"{self.module}.{self.register}" if self.register else what[2:]
            return self.concerns(kind, where, what) and what[2:] == place
        field = f"{self.register}.{self.field}" if self.field else what
        return kind is Kind.FLAG and self.concerns(kind, where, what) and what == field

    def concerns(self, kind: Kind, where: str, what: str) -> bool:
        if kind is Kind.ACCESS:
            return where == self.unit or not self.unit
        if not self.unit:
            return True
        return where == f"{self.unit}.{self.module}" and what.startswith(f"{self.register}.")


def raced(unit: str, text: str, scope: Scope) -> Watched:
    """What "I2C-A.I2CSTR.XRDY" or "I2C-A.I2CSTR" names. BadEvent unless hardware changes flags of that register."""
    if text.count(".") == 2:
        owner, module, register, f = scope.field(unit, text)
        field = f.name
    else:
        owner, module, register = scope.register(unit, text)
        field = ""
    if not is_status(register):
        flags = [r.name for r in MAPS[module] if is_status(r)]
        raise BadEvent(
            f"{register.name} is no status register: hardware sets no flag in it; {did_you_mean(register.name, flags)}"
        )
    return Watched(text, owner, module, register.name, field)


def losing(unit: str, text: str, scope: Scope) -> Watched:
    """The register whose flags may be lost; all of the scene's where none is named. BadEvent if none can be."""
    if not text:
        if not scope.units:
            raise BadEvent("the scene has no unit")
        return Watched("", units=tuple(scope.units))
    owner, module, register = scope.register(unit, text)
    if not one_clears(register):
        flags = [r.name for r in MAPS[module] if one_clears(r)]
        raise BadEvent(
            f"writing 1 clears no flag of {register.name}, so none can be lost; {did_you_mean(register.name, flags)}"
        )
    return Watched(text, owner, module, register.name)


def clearing(unit: str, text: str, scope: Scope) -> Watched:
    """The one flag that a write may clear along with another. BadEvent if writing 1 does not clear it."""
    owner, module, register, f = scope.field(unit, text)
    clearable = [each.name for each in one_clears(register)]
    if f.name not in clearable:
        raise BadEvent(f"writing 1 does not clear {text}; {did_you_mean(f.name, clearable)}")
    return Watched(text, owner, module, register.name, f.name)


class Kept(Columns):
    """The records that concern a register."""

    def __init__(self, watched: Watched) -> None:
        super().__init__()
        self._watched = watched

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        return super().tag_of(kind, where, what) if self._watched.concerns(kind, where, what) else UNHEARD


class RegisterMeasure(Measure, ABC):
    """Keeps the records that concern a register, to look at them as a recorded run."""

    kinds = frozenset({Kind.ACCESS, Kind.FLAG})

    def __init__(self, watched: Watched) -> None:
        super().__init__()
        self.watched = watched
        self._kept_records: Columns = Kept(watched)

    @property
    def subjects(self) -> Subjects:
        watched = self.watched
        return {Kind.FLAG: {f"{watched.unit}.{watched.module}.{watched.register}"}} if watched.register else {}

    def listen(self, scene: SceneEvents) -> None:
        self._per_second = scene.ticks_per_second()
        self._sysclk = scene.sysclk(self.watched.unit)

    def subscribe(self, recorder: Recorder) -> None:
        super().subscribe(recorder)
        recorder.subscribe(self.kinds, self._kept_records, self.subjects)

    def finish(self, now: int) -> None:
        table = self._kept_records.table(Fraction(self._per_second), now, {})
        self.look(Run(table, sysclk=self._sysclk))
        self._kept_records.clear()

    @abstractmethod
    def look(self, run: Run) -> None:
        """Measure over all that was kept."""


class Race(RegisterMeasure):
    """From each CPU read of a status register to the nearest change of what was looked at, in cycles of SYSCLKOUT.

    Where a wait was skipped, and its polls beside a change cannot be put back, nothing is proven.
    """

    unit = "cycles"

    def __init__(self, watched: Watched) -> None:
        super().__init__(watched)
        self._unplaced = 0

    @property
    def silent(self) -> bool:
        return not self.count or self._unplaced > 0

    def look(self, run: Run) -> None:
        from ...records.races import distances  # which lost flags need not

        try:
            cycles, ticks, self._unplaced = distances(run, self.watched.name)
        except NotInRun:  # never accessed: nothing was measured, and `missing` says so
            return
        for value, at in zip(cycles.tolist(), ticks.tolist(), strict=True):
            self.take(value, at)

    def missing(self) -> str:
        if self._unplaced:
            return (
                f"of {self._unplaced} skipped waits for {self.watched.text} the polls beside a change are not known; "
                "skip_polls = false in the unit's table makes and records each of them"
            )
        return f"no read of {self.watched.text} had a change to be compared with"


class LostFlags(Measure):
    """Flags that a read-modify-write cleared unmeant, and that firmware had not looked at since they rose.

    worst is how many were lost, count how many writes there were, of which a plain one clears what it means to: with
    none, nothing is proven.
    """

    unit = "flags"
    series = False
    kinds = frozenset({Kind.ACCESS, Kind.FLAG})

    def __init__(self, watched: Watched) -> None:
        super().__init__()
        self.watched = watched
        self.modifies = Modifies(watched.concerns, watched.is_about, not watched.register)

    @property
    def subjects(self) -> Subjects:
        watched = self.watched
        if watched.register:
            return {Kind.FLAG: {f"{watched.unit}.{watched.module}.{watched.register}"}}
        return {Kind.FLAG: {f"{unit}.{register}" for unit in watched.units for register in CLEARABLE}}

    def listen(self, scene: SceneEvents) -> None:
        self.modifies.cycle_is(Fraction(scene.ticks_per_second()) / scene.sysclk(self.watched.unit))

    def subscribe(self, recorder: Recorder) -> None:
        recorder.subscribe(self.kinds, self.modifies, self.subjects)

    def finish(self, now: int) -> None:
        self.modifies.finish()
        gone = self.gone()
        self.count = self.modifies.writes
        self.worst = self.least = len(gone)
        self.worst_at = self.least_at = gone[0] if gone else NO_TIME

    def gone(self) -> list[int]:
        """The ticks at which one was, in order."""
        return self.modifies.lost()

    def missing(self) -> str:
        what = self.watched.text or "a register with flags that writing 1 clears"
        return f"the firmware never wrote {what}"


class ClearedAlong(LostFlags):
    """How often a read-modify-write cleared this flag though another one was meant, whether it had been read or not.

    This is for a flag that is waited for afterwards, and that no other write may take.
    """

    def gone(self) -> list[int]:
        return self.modifies.cleared(self.watched.field)


def _modifies(run: Run, watched: Watched) -> tuple[ReadModifyWrite, ...]:
    try:
        return modifies_of(run, [group for group, _ in groups_of(run, watched.name)])
    except NotInRun:
        return ()


class Distances(NamedTuple):
    """cycles: from each read to its nearest change. tick: when the read was, the same length. int64."""

    cycles: NDArray[np.int64]
    tick: NDArray[np.int64]


def races(table: RecordTable, name: str, sysclk: Fraction | None = None) -> Distances:
    """How many cycles lie between each read of a status register, or of one field, and the nearest change.

    name: "I2C-A.I2CSTR", "imu:I2C-A.I2CSTR.XRDY". sysclk: in Hz; None takes what the records show. BadEvent if the
    run can have no such register; NotInRun if the firmware never accessed it.
    """
    from ...records.races import distances

    unit, _, text = name.rpartition(":")
    cycles, tick, _ = distances(Run(table, sysclk=sysclk), raced(unit, text, scope_of_table(table)).name)
    return Distances(cycles, tick)


def lost_flags(table: RecordTable, name: str = "") -> NDArray[np.int64]:
    """The ticks at which read-modify-writes of a register, or of any, lost a flag. BadEvent as for `races`."""
    unit, _, text = name.rpartition(":")
    modifies = _modifies(Run(table), losing(unit, text, scope_of_table(table)))
    lost = sorted(tick for modify in modifies for flag in modify.flags for tick in flag.lost)
    return np.array(lost, np.int64)
