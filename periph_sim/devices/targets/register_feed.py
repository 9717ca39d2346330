"""Updates of a register by its device, by a [[device.NAME.register]] table: their number and the value.

updates = [["5 ms", 0x12], ["7 ms", 0x34]]    or a .csv file of such rows
every = "1 ms", values = [1, 2, 3]            the last one remains;   step = 1 counts
"""

from __future__ import annotations

import csv
from bisect import bisect_right
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from ...core.input_files import read_input
from ...core.settings import duration
from ...core.state import State
from . import BadDevice, TargetContext
from .register_settings import RegisterTable


class Feed:
    """ticks: of each value, or of the first one, with `period` for the others. period: 0 if there is none."""

    STATE = State("_taken")

    def __init__(self, ticks: Sequence[int], values: Sequence[int], period: int) -> None:
        self._ticks, self._values, self._period = ticks, values, period
        self._taken = 0  # updates so far

    def advance(self, now: int) -> tuple[int, int]:
        """Return (number of updates due since the last call, the value of the last one)."""
        due = bisect_right(self._ticks, now)
        if self._period and due:
            due = (now - self._ticks[0]) // self._period + 1
            if self._values:
                due = min(due, len(self._values))
        new, self._taken = due - self._taken, due
        return new, self._values[due - 1] if self._values and due else 0

    def next_due(self) -> int | None:
        """Return the tick of the next update; None after the last one."""
        if self._values and self._taken >= len(self._values):
            return None
        return self._ticks[0] + self._taken * self._period if self._period else self._ticks[self._taken]


def feed_of(table: RegisterTable, entry: int, place: TargetContext) -> Feed | None:
    """Return a register's feed; None if only the bus changes it. BadDevice for an invalid file."""
    if table.every is not None:
        first = table.every if table.first is None else table.first
        period = max(1, place.ticks(table.every))
        return Feed([place.start + place.ticks(first)], table.values, period)
    rows = table.updates
    if isinstance(rows, str):
        try:
            rows = _rows(place.folder / rows, table)
        except ValueError as error:
            raise BadDevice(str(error), "register", entry, "updates") from None
    if not rows:
        return None
    times = [time for time, _ in rows]
    if times != sorted(times):
        raise BadDevice(f"the times of {table.name} do not rise; sort its rows", "register", entry, "updates")
    return Feed([place.start + place.ticks(time) for time in times], [value for _, value in rows], 0)


def _rows(path: Path, table: RegisterTable) -> tuple[tuple[Fraction, int], ...]:
    """Read times and values from a file: "5 ms,0x12" in each line; a heading is skipped."""
    try:
        lines = list(csv.reader(read_input(path).decode("utf-8").splitlines()))
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise ValueError(f"{path} cannot be read ({why}); its path is relative to the folder of the case") from None
    rows = []
    for number, cells in enumerate(lines, 1):
        if not any(cell.strip() for cell in cells) or (number == 1 and cells[0].strip() in ("time", "at")):
            continue
        try:
            time, value = cells
            rows.append((duration(time.strip()), int(value.strip(), 0)))
        except ValueError:
            raise ValueError(
                f"{path}, line {number}: {','.join(cells)!r} is no time and value; write them as 5 ms,0x12"
            ) from None
        if not 0 <= rows[-1][1] <= table.full:
            raise ValueError(
                f"{path}, line {number}: {rows[-1][1]:#x} does not fit the {table.width} bits of {table.name}"
            )
    return tuple(rows)
