"""What is kept of a run to tell which flags its writes cleared: all records go in, those around such writes stay.

    R  R  R  . . .  R  x  R  W       x: any other access
    '--'--'         '  '--'--'
    none            last  those in the cycles before the write: which of them belongs to it is told later

A poll that no write follows is forgotten, so that memory grows with the writes and not with the reads. What tells
whether firmware had looked at a flag is the last read before; so the last one of each register and field stays.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np

from ...core.records import NOWHERE, OF_MODIFIES, UNHEARD, Kind
from ...records.read_modify_write import MODIFY
from ...records.register_maps import one_clears
from ...traces.formats.record_table import Columns, RecordTable
from ..language.scope import MAPS

CLEARABLE = [f"{module}.{r.name}" for module, registers in MAPS.items() for r in registers if one_clears(r)]
CLEARING = {f"W {register}" for register in CLEARABLE}
READING = {f"R {register}" for register in CLEARABLE}
FLAGS = {(module, f"{r.name}.{f.name}") for module, registers in MAPS.items() for r in registers for f in one_clears(r)}
FLAG, READ, WRITE, OTHER = range(4)  # what a record is here
SEVERAL = 4  # times as far back as a write's read may be


class Access:
    """One that may stay."""

    __slots__ = ("cause", "field", "number", "tag", "text", "tick", "value")

    def __init__(self, tag: int, number: int, tick: int, value: int, text: str, cause: int, field: str) -> None:
        self.tag = tag
        self.number = number
        self.tick = tick
        self.value = value
        self.text = text
        self.cause = cause
        self.field = field


class UnitAccesses:
    """Those of one unit that no write has made stay yet. recent: those of the last cycles. last: of each register that
    is read, and each field of it, the last read before these."""

    __slots__ = ("last", "recent")

    def __init__(self) -> None:
        self.recent: list[Access] = []
        self.last: list[dict[str, Access]] = []


class Topic:
    """All accesses of one kind. last: where the reads among them are, of those of the unit."""

    __slots__ = ("last", "role", "unit")

    def __init__(self, role: int, unit: UnitAccesses) -> None:
        self.role = role
        self.unit = unit
        self.last: dict[str, Access] = {}
        if role == READ:
            unit.last.append(self.last)


class AroundWrites(Columns):
    """concerns: whether records of a kind, place and thing are to be looked at; None: all are."""

    def __init__(self, concerns: Callable[[Kind, str, str], bool] | None = None) -> None:
        super().__init__()
        self._concerns = concerns
        self._back = 0  # ticks
        self._units: dict[str, UnitAccesses] = {}
        self._of: list[Topic] = []  # by tag

    def cycle_is(self, ticks: Fraction) -> None:
        """How long a cycle is: a write's read is a few of them before it."""
        self._back = int(SEVERAL * MODIFY * ticks)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        if self._concerns is not None and not self._concerns(kind, where, what):
            return UNHEARD
        if kind is Kind.FLAG and (where.partition(".")[2], what) not in FLAGS:
            return UNHEARD
        tag = Columns.tag_of(self, kind, where, what)
        if tag == len(self._of):
            role = FLAG if kind is Kind.FLAG else READ if what in READING else WRITE if what in CLEARING else OTHER
            self._of.append(Topic(role, self._units.setdefault(where, UnitAccesses())))
        return tag

    def places(self, tag: int) -> int:
        """Of a read and a write of one statement it has to be the same."""
        return OF_MODIFIES if self._of[tag].role in (READ, WRITE) else NOWHERE

    def keep(self, tag: int, number: int, tick: int, value: int, text: str, cause: int, field: str) -> None:
        topic = self._of[tag]
        if topic.role == FLAG:
            Columns.keep(self, tag, number, tick, value, text, cause, field)
            return
        unit = topic.unit
        recent = unit.recent
        passed = 0
        for old in recent:
            if tick - old.tick <= self._back:
                break
            passed += 1
            of = self._of[old.tag]
            if of.role == READ:
                of.last[old.field] = old
        if passed:
            del recent[:passed]
        recent.append(Access(tag, number, tick, value, text, cause, field))
        if topic.role == WRITE:
            for last in unit.last:
                for one in last.values():
                    self._stays(one)
                last.clear()
            for one in recent:
                self._stays(one)
            recent.clear()

    def _stays(self, one: Access) -> None:
        Columns.keep(self, one.tag, one.number, one.tick, one.value, one.text, one.cause, one.field)

    def table(self, per_second: Fraction, end: int, modules: dict[str, tuple[str, ...]]) -> RecordTable:
        """In the order in which they were made."""
        found = super().table(per_second, end, modules)
        order = np.argsort(found.number, kind="stable")
        return replace(found, columns={name: column[order] for name, column in found.columns.items()})
