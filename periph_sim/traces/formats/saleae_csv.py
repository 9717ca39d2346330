"""Saleae's CSV files of digital data: rows of changes, by Logic 2 or Logic 1.x. KingstVIS writes the latter form.

    Time [s],Channel 0,Channel 1      Logic 2: the first row is the start, the last row the end
    Time[s], SCL, SDA                 Logic 1.x: blanks after commas, no row for the end

Chosen: position 0 is the first row, even if its time is not 0. Without a rate, positions are nanoseconds, or finer if a
row needs it. `X` means that the level is unknown.

Captures are written in the form of Logic 2, with a row for the end. Times have nine decimals, or as many as are needed
to be exact. If no number of decimals is exact (24 MHz), times are rounded so finely that a reader that knows the rate
gets the same samples.
"""

from __future__ import annotations

import csv
import re
from array import array
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Protocol

import numpy as np

from ..capture.capture import (
    MOST_DIGITS,
    UNKNOWN,
    BadCapture,
    Capture,
    Levels,
    Positions,
    changes,
    channel_of_states,
)
from ..capture.grid import LEAST_DECIMALS, OffGrid, decimals_for, exact_time, nearest, quantized
from ..capture.sampling import rate_text
from ..capture.size_limits import MOST_EDGES

NAME = "Saleae CSV"
SUFFIXES = (".csv",)

HEADER = re.compile(rb'(?:\xef\xbb\xbf)?"?Time ?\[s\]"?[,\r\n]')
STATES = {"0": 0, "1": 1, "X": UNKNOWN, "x": UNKNOWN}
MOST_CELLS = MOST_EDGES  # maximum number of cells; a cell takes a byte while the file is read
MOST_POSITIONS = 1 << 62
ROUNDED_TO = 10  # minimum units of the last decimal in a sample, if times are not exact
CELLS = "01X"
NO_END = "the format has no row for the end, so the last change is used"


class Rows(Protocol):
    """The interface of csv.reader's result."""

    line_num: int

    def __iter__(self) -> Iterator[list[str]]: ...
    def __next__(self) -> list[str]: ...


def recognises(path: Path, head: bytes) -> bool:
    return HEADER.match(head) is not None


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture on the grid of `rate`, or in ticks of the time stamps.

    Raise BadCapture with the line of an error.
    """
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
        rows = csv.reader(file, skipinitialspace=True)
        try:
            return _read(path, rows, rate, salvage)
        except csv.Error as error:
            raise BadCapture(path, f"line {rows.line_num}", str(error), "rows of cells", "export it again") from error


def write(capture: Capture, path: Path) -> tuple[str, ...]:
    """Write a capture. Return notes on rounded times.

    Raise BadCapture if positions have no time, or one that is too fine.
    """
    decimals, exact = decimals_for(capture, LEAST_DECIMALS, ROUNDED_TO)
    per_second = 10**decimals
    rate = capture.rate or Fraction(per_second)
    at, which, states = changes(capture)
    *times, end = nearest(np.append(at, capture.length - 1), per_second / rate).tolist()
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerow(["Time [s]", *(channel.name for channel in capture.channels)])
        now = ["X"] * len(capture.channels)
        before = 0

        def row(time: int) -> None:
            file.write(f"{time // per_second}.{time % per_second:0{decimals}},{','.join(now)}\n")

        for time, line, state in zip(times, which.tolist(), states.tolist(), strict=True):
            if time != before:
                row(before)
                before = time
            now[line] = CELLS[state]
        for time in sorted({before, end}):
            row(time)
    if exact:
        return ()
    return (f"times are rounded to {decimals} decimals; a reader that uses {rate_text(rate)} gets the same samples",)


class _Table:
    """The rows so far. Each has its time since the first row, in ticks, and the states of the channels."""

    def __init__(self, path: Path, names: list[str]) -> None:
        self._path = path
        self._columns = len(names) + 1
        self.ticks: array[int] | list[int] = array("q")  # a list if a value exceeds 64 bits
        self.lines = array("q")  # the line of each row
        self._kinds: dict[tuple[str, ...], int] = {}  # numbers of the combinations of cells, which are few
        self._states: list[list[int]] = []  # the states of the channels for each combination
        self._rows = array("I")  # the combination of each row
        self.decimals = LEAST_DECIMALS
        self._first = self._last = 0

    def add(self, row: list[str], line: int) -> None:
        """Add a row. Raise BadCapture, with its line, if the row is malformed or its time decreases."""
        if len(row) != self._columns:
            raise self.bad(line, f"{len(row)} columns", f"{self._columns} as in line 1", "export it again")
        try:
            time, *cells = row
            kind = self._kinds.get(key := tuple(cells))
            if kind is None:
                self._states.append([STATES[cell.strip()] for cell in cells])
                kind = self._kinds[key] = len(self._kinds)
            whole, _, part = time.partition(".")
            plain = part.isdecimal() and whole.isdecimal() and time.isascii() and len(time) <= MOST_DIGITS
            digits, decimals = (int(whole + part), len(part)) if plain else exact_time(time)
        except (KeyError, ValueError):
            raise self.bad(line, repr(",".join(row)), "a time and 0, 1 or X", "export digital data") from None
        if decimals != self.decimals:
            if decimals > self.decimals:
                self._finer(decimals)
            digits *= 10 ** (self.decimals - decimals)
        if not self.lines:
            self._first = digits
        now = digits - self._first
        if now < self._last:
            raise self.bad(line, "a time before that of the row above", "rising times", "export again")
        if now > MOST_POSITIONS and isinstance(self.ticks, array):
            self.ticks = list(self.ticks)
        if len(self.lines) * self._columns >= MOST_CELLS:
            raise self.bad(line, f"more than {MOST_CELLS} cells", "a shorter capture", "export a part of it")
        self._last = now
        self.ticks.append(now)
        self.lines.append(line)
        self._rows.append(kind)

    def _finer(self, decimals: int) -> None:
        finer = 10 ** (decimals - self.decimals)
        ticks = [tick * finer for tick in self.ticks]
        self._first, self._last = self._first * finer, self._last * finer
        self.ticks = ticks if self._last > MOST_POSITIONS else array("q", ticks)
        self.decimals = decimals

    def states(self, index: int) -> Levels:
        """Return the state of one channel in each row."""
        return np.array([states[index] for states in self._states], np.uint8)[np.frombuffer(self._rows, np.uint32)]

    def positions(self, rate: Fraction | None) -> tuple[Positions, Fraction]:
        """Return the position of each row, counted from the first row, and the number of positions per second."""
        ticks, decimals = self.ticks, self.decimals
        many = np.array(ticks, object) if isinstance(ticks, list) else np.frombuffer(ticks, np.int64)
        while decimals > LEAST_DECIMALS and not (many % 10).any():
            many, decimals = many // 10, decimals - 1
        per_second = Fraction(10**decimals)
        try:
            at = (many if rate is None else quantized(many, per_second, rate)).astype(np.int64)
        except OffGrid as off:
            line = self.lines[off.which]
            raise self.bad(
                line, "a time between two samples", f"the grid of {rate} Hz", "state the right rate"
            ) from off
        except OverflowError:
            raise self._too_late() from None
        if at[-1] > MOST_POSITIONS:
            raise self._too_late()
        return at, rate or per_second

    def _too_late(self) -> BadCapture:
        return self.bad(self.lines[-1], "a time beyond 64 bits", "a shorter capture", "state the rate")

    def bad(self, line: int, found: str, expected: str, way_out: str) -> BadCapture:
        return BadCapture(self._path, f"line {line}", found, expected, way_out)


def _read(path: Path, rows: Rows, rate: Fraction | None, salvage: bool) -> Capture:
    header = next(rows, [])
    names = [name.strip() for name in header[1:]]
    if not names:
        raise BadCapture(path, "line 1", repr(",".join(header)), "Time [s] and channel names", "export CSV again")
    table = _Table(path, names)
    notes = [NO_END] if header[0].strip() == "Time[s]" else []
    try:
        for row in rows:
            if row:
                table.add(row, rows.line_num)
    except (BadCapture, csv.Error) as error:
        if not salvage or not table.ticks:
            raise
        said = str(error).removeprefix(f"{path}, ")
        notes.append(f"read up to line {table.lines[-1]}: {said}")
    if not table.ticks:
        raise BadCapture(path, "line 2", "no row", "the levels at the start", "export it again")
    at, per_second = table.positions(rate)
    length = int(at[-1]) + 1
    channels = tuple(channel_of_states(name, i, at, table.states(i), length) for i, name in enumerate(names))
    return Capture(path, per_second, length, channels, rate is not None, tuple(notes))
