"""Rows of CSV files: their cells and, in the files of logic analysers, their times and levels.

    0.000016460,1,0 --> only rows that change a level, and the first, are kept --> times since the first row, states

Times are integers. Their unit is the last decimal of the time with the most decimals so far. Only few combinations of
levels occur, so the text of each combination is parsed once.
"""

from __future__ import annotations

import csv
from array import array
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO

import numpy as np

from ..capture import size_limits as limits
from ..capture.capture import MOST_POSITION, BadCapture, Levels, Positions
from ..capture.sampling import exact_time


def numbered_rows(path: Path, file: IO[str], expected: str, way_out: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the line number and the cells of every row that is not empty.

    expected, way_out: parts of the message of BadCapture, which is raised if a row cannot be split into cells.
    """
    rows = csv.reader(file, skipinitialspace=True)
    try:
        for cells in rows:
            if cells:
                yield rows.line_num, cells
    except csv.Error as error:
        raise BadCapture(path, f"line {rows.line_num}", str(error), expected, way_out) from error


class Rows:
    """The rows of a file.

    columns: the number of levels in a row.
    states: a dictionary from the text of a cell to the state of a channel, 0, 1 or UNKNOWN.
    decimals: the number of decimals of the times. The argument is a minimum; later the attribute increases if a time
        has more decimals.
    separator: the text between two cells.
    timed: True if rows begin with a time; otherwise the time is the number of the row.
    expected, way_out: parts of the message about a malformed row.
    count: the number of rows so far.
    last_line: the line number of the last row that was passed to `add`.
    """

    def __init__(
        self,
        path: Path,
        columns: int,
        states: Mapping[str, int],
        decimals: int,
        expected: str,
        way_out: str,
        separator: str = ",",
        timed: bool = True,
    ) -> None:
        self.count = 0
        self.decimals = decimals
        self._path = path
        self._columns = columns
        self._states = states
        self._expected, self._way_out = expected, way_out
        self._separator, self._timed = separator, timed
        self._kinds: dict[str, int] = {}  # a dictionary from the text of a combination of levels to its number
        self._levels: list[bytes] = []  # for each combination of levels, the states of all channels, one byte each
        # The times of rows with a change of a level, counted from the first row; a list if a time exceeds 64 bits.
        self._times: array[int] | list[int] = array("q")
        self._kept = array("I")  # for each row with a change of a level, the number of its combination
        self._lines = array("q")  # for each row with a change of a level, its line number
        self.last_line = 0
        self._first = self._last = 0

    def add(self, line: int, row: str) -> None:
        """Add a row. Raise BadCapture if the row is malformed or too early, or if there are too many rows.

        line: the line number of the row in the file, for messages.
        """
        time, _, levels = row.partition(self._separator) if self._timed else ("", "", row)
        try:
            kind = self._kinds.get(levels)
            if kind is None:
                states = bytes([self._states[cell.strip()] for cell in levels.split(self._separator)])
                if len(states) != self._columns:
                    raise ValueError(f"{len(states)} levels")
                kind = self._kinds[levels] = len(self._kinds)
                self._levels.append(states)
            digits, decimals = exact_time(time) if self._timed else (self.count, self.decimals)
        except (KeyError, ValueError):
            raise self.bad(line, repr(row[:80]), self._expected, self._way_out) from None
        if decimals > self.decimals:
            self._refine(decimals)
        elif decimals < self.decimals:
            digits *= 10 ** (self.decimals - decimals)
        if not self.count:
            self._first = digits
        now = digits - self._first
        if now < self._last:
            raise self.bad(line, "a time before that of the row above", "rising times", "export again")
        self.count += 1
        self._last, self.last_line = now, line
        if self._kept and kind == self._kept[-1]:
            return
        if len(self._kept) * (self._columns + 1) >= limits.MOST_EDGES:
            raise self.bad(line, f"more than {limits.MOST_EDGES} cells", "a shorter capture", "export a part of it")
        if now > MOST_POSITION and isinstance(self._times, array):
            self._times = list(self._times)
        self._times.append(now)
        self._kept.append(kind)
        self._lines.append(line)

    def _refine(self, decimals: int) -> None:
        finer = 10 ** (decimals - self.decimals)
        times = [time * finer for time in self._times]
        self._first, self._last, self.decimals = self._first * finer, self._last * finer, decimals
        self._times = times if self._last > MOST_POSITION else array("q", times)

    def times(self) -> Positions:
        """Return the times of the first row, of the rows in which a level changes, and of the last row.

        The result is an array of int64 or, if a time exceeds MOST_POSITION, of Python's integers.
        """
        times = [*self._times, self._last]
        return np.array(times, object if self._last > MOST_POSITION else np.int64)

    def states(self, index: int) -> Levels:
        """Return the state of one channel in the first row and in each row in which the level of any channel changes.

        index: the number of the channel's column, counted from 0 without the column of times.
        """
        return np.array([levels[index] for levels in self._levels], np.uint8)[np.frombuffer(self._kept, np.uint32)]

    def line_of(self, which: int) -> int:
        """Return the line number of the row whose time is `times()[which]`."""
        return self._lines[which] if which < len(self._lines) else self.last_line

    def bad(self, line: int, found: str, expected: str, way_out: str) -> BadCapture:
        return BadCapture(self._path, f"line {line}", found, expected, way_out)
