"""Histogram of values for percentiles, in bounded memory.

    value, tick --> cell of the value: count, first tick --> percentile

Up to MOST different values have a cell each, and percentiles are exact. With more values the cells become twice as
wide until half of MOST are left. A cell represents the largest value in it, so a percentile is a measured value and
never too small.
"""

# core: compiled

from __future__ import annotations

from typing import final

MOST = 1 << 15  # cells


@final
class Cell:
    """count: of its values. value: the largest. at: when that was first."""

    __slots__ = ("at", "count", "value")

    count: int
    value: int
    at: int


@final
class Tally:
    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self._cells: dict[int, Cell] = {}
        self._shift = 0  # of a value, to the number of its cell

    def __len__(self) -> int:
        return len(self._cells)

    def add(self, value: int, at: int) -> None:
        number = value >> self._shift
        cell: Cell | None = self._cells.get(number)
        if cell is None:
            cell = self._cells[number] = Cell()
            cell.count, cell.value, cell.at = 1, value, at
            if len(self._cells) > self._most:
                self._widen()
        else:
            cell.count += 1
            if value > cell.value:
                cell.value, cell.at = value, at

    def percentile(self, per_mille: int) -> tuple[int, int]:
        """Return (value, first tick) of the least value that `per_mille` of the values do not exceed (nearest rank)."""
        rank, passed = -(-per_mille * sum(cell.count for cell in self._cells.values()) // 1000), 0
        for _, cell in sorted(self._cells.items()):
            passed += cell.count
            if passed >= rank:
                return cell.value, cell.at
        raise AssertionError("there is no value")

    def _widen(self) -> None:
        """Make cells twice as wide until half are left, so that values far apart do not widen them each time."""
        while len(self._cells) > self._most // 2:
            self._shift += 1
            narrow, self._cells = self._cells, {}
            for number, cell in narrow.items():
                wide = self._cells.setdefault(number >> 1, cell)
                if wide is not cell:
                    wide.count += cell.count
                    if (cell.value, -cell.at) > (wide.value, -wide.at):
                        wide.value, wide.at = cell.value, cell.at
