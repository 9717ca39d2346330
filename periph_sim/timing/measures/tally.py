"""How often each value came: values go in as they are measured, percentiles come out; memory has an end.

    value, when --> cell of its value: how often, and when first --> value that so many of a thousand do not exceed

As long as there are up to MOST different values, each has a cell of its own, and percentiles are exact. Of more, cells
get twice as wide, again and again: a quarter of MOST of them span no more than all values do. A cell stands for the
largest value in it, so that a percentile is one that was measured, and never too small.
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
        """(value, when first): the least value that so many of a thousand do not exceed (nearest rank)."""
        rank, passed = -(-per_mille * sum(cell.count for cell in self._cells.values()) // 1000), 0
        for _, cell in sorted(self._cells.items()):
            passed += cell.count
            if passed >= rank:
                return cell.value, cell.at
        raise AssertionError("there is no value")

    def _widen(self) -> None:
        """Cells twice as wide, until they are half as many: else values from far away would widen them each time."""
        while len(self._cells) > self._most // 2:
            self._shift += 1
            narrow, self._cells = self._cells, {}
            for number, cell in narrow.items():
                wide = self._cells.setdefault(number >> 1, cell)
                if wide is not cell:
                    wide.count += cell.count
                    if (cell.value, -cell.at) > (wide.value, -wide.at):
                        wide.value, wide.at = cell.value, cell.at
