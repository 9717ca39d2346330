"""Saleae's CSV of digital data, Logic 2 and Logic 1.x (KingstVIS writes the latter): rows of changes in, edges out.

    Time [s],Channel 0,Channel 1      Logic 2: the first row is the start, the last row the end
    Time[s], SCL, SDA                 Logic 1.x: blanks after commas, no row for the end

Chosen: position 0 is the first row, whatever its time. Without a rate, positions are nanoseconds, or as
much finer as some row needs. `X` means that the level is not known.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Protocol

from .capture import BadCapture, Capture, channel_of
from .grid import OffGrid, exact_time, snap, ticks_of

NAME = "Saleae CSV"
SUFFIXES = (".csv",)

HEADER = re.compile(rb'(?:\xef\xbb\xbf)?"?Time ?\[s\]"?[,\r\n]')
LEVELS: dict[str, int | None] = {"0": 0, "1": 1, "X": None, "x": None}
MOST_POSITIONS = 1 << 62
NO_END = "the format has no row for the end, so the last change is taken for it"


class Rows(Protocol):
    """What csv.reader gives."""

    line_num: int

    def __iter__(self) -> Iterator[list[str]]: ...
    def __next__(self) -> list[str]: ...


def recognises(path: Path, head: bytes) -> bool:
    return HEADER.match(head) is not None


def read(path: Path, rate: Fraction | None = None) -> Capture:
    """The capture on the grid of `rate`, or in ticks of the time stamps. BadCapture names the line."""
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
        rows = csv.reader(file, skipinitialspace=True)
        try:
            return _read(path, rows, rate)
        except csv.Error as error:
            raise BadCapture(path, f"line {rows.line_num}", str(error), "rows of cells", "export it again") from error


def _read(path: Path, rows: Rows, rate: Fraction | None) -> Capture:
    header = next(rows, [])
    names = [name.strip() for name in header[1:]]
    if not names:
        raise BadCapture(path, "line 1", repr(",".join(header)), "Time [s] and channel names", "export CSV again")
    times: list[tuple[int, int]] = []
    lines: list[int] = []  # where each time stands
    levels: list[list[int | None]] = [[] for _ in names]
    for row in filter(None, rows):
        if len(row) != len(header):
            found = f"{len(row)} columns"
            raise BadCapture(path, f"line {rows.line_num}", found, f"{len(header)} as in line 1", "export it again")
        try:
            times.append(exact_time(row[0]))
            for column, cell in zip(levels, row[1:], strict=True):
                column.append(LEVELS[cell.strip()])
        except (KeyError, ValueError) as error:
            raise BadCapture(
                path, f"line {rows.line_num}", repr(",".join(row)), "a time and 0, 1 or X", "export digital data"
            ) from error
        lines.append(rows.line_num)
    if not times:
        raise BadCapture(path, "line 2", "no row", "the levels at the start", "export it again")
    at, per_second = _positions(path, times, lines, rate)
    notes = (NO_END,) if header[0].strip() == "Time[s]" else ()
    length = at[-1] + 1
    channels = tuple(channel_of(name, index, at, levels[index], length) for index, name in enumerate(names))
    return Capture(path, per_second, length, channels, rate is not None, notes)


def _positions(
    path: Path, times: list[tuple[int, int]], lines: list[int], rate: Fraction | None
) -> tuple[list[int], Fraction]:
    """(position of each row counted from the first, positions a second)."""
    ticks, per_second = ticks_of(times)
    ticks = [tick - ticks[0] for tick in ticks]
    for line, (before, after) in zip(lines[1:], pairwise(ticks), strict=True):
        if after < before:
            raise BadCapture(
                path, f"line {line}", "a time before that of the row above", "rising times", "export again"
            )
    at, positions_a_second = ticks, Fraction(per_second)
    if rate is not None:
        try:
            at, positions_a_second = snap(ticks, positions_a_second, rate), rate
        except OffGrid as off:
            line = lines[off.which]
            raise BadCapture(
                path, f"line {line}", "a time between two samples", f"the grid of {rate} Hz", "state the right rate"
            ) from off
    if at[-1] > MOST_POSITIONS:
        raise BadCapture(path, f"line {lines[-1]}", "a time beyond 64 bits", "a shorter capture", "state the rate")
    return at, positions_a_second
