"""What is kept of a run to tell which flags its writes cleared: all records go in, those around such writes stay.

    R  R  R  . . .  R  x  R  W       x: any other access
    '--'--'         '  '--'--'
    none            last  those in the cycles before the write: which of them belongs to it is told later

A poll that no write follows is forgotten, so that memory grows with the writes and not with the reads. What tells
whether firmware had looked at a flag is the last read before; so the last one of each register and field stays.
"""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from fractions import Fraction
from typing import Final

import numpy as np

from ...core.records import UNHEARD, Kind
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


Access = tuple[int, int, int, int, str, int, str]  # one that may stay: tag, number, tick, value, text, cause, field
TAG: Final = 0  # places in it
TICK: Final = 2
FIELD: Final = 6


class UnitAccesses:
    """Those of one unit that no write has made stay yet. last: of each register and field the last read before
    `recent`, those of the last cycles."""

    def __init__(self) -> None:
        self.recent: deque[Access] = deque()
        self.last: dict[tuple[int, str], Access] = {}


class AroundWrites(Columns):
    def __init__(self) -> None:
        super().__init__()
        self._back = 0  # ticks
        self._roles: list[int] = []  # by tag
        self._units: dict[str, UnitAccesses] = {}
        self._unit_of: list[UnitAccesses] = []  # by tag

    def cycle_is(self, ticks: Fraction) -> None:
        """How long a cycle is: a write's read is a few of them before it."""
        self._back = int(SEVERAL * MODIFY * ticks)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        if kind is Kind.FLAG and (where.partition(".")[2], what) not in FLAGS:
            return UNHEARD
        tag = Columns.tag_of(self, kind, where, what)
        if tag == len(self._roles):
            role = FLAG if kind is Kind.FLAG else READ if what in READING else WRITE if what in CLEARING else OTHER
            self._roles.append(role)
            self._unit_of.append(self._units.setdefault(where, UnitAccesses()))
        return tag

    def keep(self, tag: int, number: int, tick: int, value: int, text: str, cause: int, field: str) -> None:
        role = self._roles[tag]
        if role == FLAG:
            Columns.keep(self, tag, number, tick, value, text, cause, field)
            return
        unit = self._unit_of[tag]
        recent = unit.recent
        while recent:
            old = recent[0]
            if tick - old[TICK] <= self._back:
                break
            recent.popleft()
            if self._roles[old[TAG]] == READ:
                unit.last[old[TAG], old[FIELD]] = old
        recent.append((tag, number, tick, value, text, cause, field))
        if role == WRITE:
            for one in (*unit.last.values(), *recent):
                of, made, at, found, told, under, named = one
                Columns.keep(self, of, made, at, found, told, under, named)
            unit.last.clear()
            recent.clear()

    def table(self, per_second: Fraction, end: int, modules: dict[str, tuple[str, ...]]) -> RecordTable:
        """In the order in which they were made."""
        found = super().table(per_second, end, modules)
        order = np.argsort(found.number, kind="stable")
        return replace(found, columns={name: column[order] for name, column in found.columns.items()})
