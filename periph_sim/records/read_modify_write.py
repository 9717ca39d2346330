"""Read-modify-writes of a run: pairs of a read and a write of one statement.

    i2c.I2CSTR.SCD = 1     R I2CSTR, W I2CSTR: one place, one routine, one field, a few cycles apart

The write may land after accesses that the CPU makes meanwhile, so it need not be the next one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..processor.instruction_location import statement
from .modify_window import MODIFY, OVERTAKEN
from .run import Rows, Run


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
