"""CSV by sigrok-cli and PulseView: comments and a row a sample (or a change, with a time column) in, edges out.

    ; Channels (2/8): SCL, SDA        names
    ; Samplerate: 4 MHz               rate
    SCL,SDA | logic,logic | microseconds,logic,logic | Time,SCL,SDA | no header
    1,1

Times are counted from the first row: libsigrok 0.5 prints them one sample period late, older ones do
not, and the first row is the first sample either way. Their unit is the header's, else the coarsest
in which a sample period is at least 1, as the writer chooses it.

Chosen: without a time column every row is a sample. The separator is what the first row has of comma,
tab, semicolon, bar and blank, looked for in this order.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import chain
from pathlib import Path

from .capture import BadCapture, Capture, channel_of, rate_of

NAME = "PulseView CSV"
SUFFIXES = (".csv", ".txt")

UNITS = {
    "seconds": 0,
    "milliseconds": 3,
    "microseconds": 6,
    "nanoseconds": 9,
    "picoseconds": 12,
    "femtoseconds": 15,
}
LEVELS = {"0": 0, "1": 1}
SEPARATORS = ",\t;| "
NUMBER = re.compile(r"-?\d+(\.\d*)?([eE][-+]?\d\d?)?")
FIRST_ROW = re.compile(
    rb'(?:\xef\xbb\xbf)?(;|"?(time|\w*seconds)"?([,\t;|]| (?!\[))|[01]([,\t;| ]+[01])*\s*[\r\n])', re.IGNORECASE
)


def recognises(path: Path, head: bytes) -> bool:
    return FIRST_ROW.match(head) is not None


def read(path: Path, rate: Fraction | None = None) -> Capture:
    """The capture; `rate` wins over the file's. BadCapture names the line."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        return _read(path, file, rate)


@dataclass
class Head:
    """What the comments and the header row say."""

    names: list[str] = field(default_factory=list)
    rate: Fraction | None = None
    separator: str = ","
    timed: bool = False
    unit: str | None = None


def _read(path: Path, file: Iterator[str], rate: Fraction | None) -> Capture:
    head = Head()
    lines = ((number, line.strip()) for number, line in enumerate(file, 1))
    first = _comments(path, head, lines)
    rows = chain(_header(path, head, *first), lines)
    width = len(head.names) + head.timed
    levels: list[list[int | None]] = [[] for _ in head.names]
    times: list[Fraction] = []
    before, count = "", 0
    for number, line in rows:
        if not line or line.startswith(";"):
            continue
        if not head.timed:
            count += 1
            if line == before:
                continue
            before = line
        cells = [cell.strip() for cell in line.split(head.separator)]
        try:
            if len(cells) != width or not NUMBER.fullmatch(cells[0]):
                raise ValueError
            times.append(Fraction(cells[0]) if head.timed else Fraction(count - 1))
            for column, cell in zip(levels, cells[head.timed :], strict=True):
                column.append(LEVELS[cell])
        except (ValueError, KeyError):
            expected = f"{'a time and ' if head.timed else ''}{len(head.names)} levels 0 or 1"
            raise BadCapture(path, f"line {number}", repr(line), expected, "export logic channels only") from None
        if len(times) > 1 and times[-1] < times[-2]:
            raise BadCapture(
                path, f"line {number}", "a time before that of the row above", "rising times", "export again"
            )
    if not times:
        raise BadCapture(path, "the file", "no rows", "the levels of the samples", "export it again")
    at, positions_a_second = _positions(path, head, times) if head.timed else ([int(t) for t in times], head.rate)
    length = at[-1] + 1 if head.timed else count
    notes = () if rate or positions_a_second else ("the file states no samplerate, so positions have no time",)
    channels = tuple(channel_of(name, index, at, levels[index], length) for index, name in enumerate(head.names))
    sampled = not head.timed or head.rate is not None
    return Capture(path, rate or positions_a_second, length, channels, sampled, notes)


def _comments(path: Path, head: Head, lines: Iterator[tuple[int, str]]) -> tuple[int, str]:
    """Reads the comments; the first line behind them, with its number."""
    for number, line in lines:
        if not line.startswith(";"):
            if line:
                return number, line
            continue
        if "libsigrok4DSL" in line:
            raise BadCapture(
                path, f"line {number}", "a CSV by DSView", "one by libsigrok", "export VCD or .sr from DSView"
            )
        if match := re.match(r";\s*Channels \(\d+/\d+\):?\s*(.*)", line):
            head.names = [name.strip() for name in match[1].split(",")] if match[1] else []
        elif match := re.match(r";\s*Sample ?rate:\s*(.*)", line, re.IGNORECASE):
            try:
                head.rate = rate_of(match[1]) or None
            except ValueError as error:
                raise BadCapture(path, f"line {number}", repr(match[1]), "a rate such as 4 MHz", "mend it") from error
    raise BadCapture(path, "the file", "no rows", "the levels of the samples", "export it again")


def _header(path: Path, head: Head, number: int, line: str) -> list[tuple[int, str]]:
    """Takes separator, names and time column from the first row; that row again if it is no header."""
    head.separator = next((mark for mark in SEPARATORS if mark in line), ",")
    cells = [cell.strip().strip('"') for cell in line.split(head.separator)]
    if all(NUMBER.fullmatch(cell) for cell in cells) and cells != head.names:
        head.timed = bool(head.names) and len(cells) == len(head.names) + 1
        head.names = head.names or [str(index) for index in range(len(cells))]
        return [(number, line)]
    unit = cells[0].casefold()
    head.timed = unit in UNITS or unit == "time"
    head.unit = unit if unit in UNITS else None
    columns = cells[1:] if head.timed else cells
    if head.names and len(columns) != len(head.names):
        found = f"{len(columns)} columns"
        raise BadCapture(path, f"line {number}", found, f"{len(head.names)} as the comment says", "export it again")
    if {column.casefold() for column in columns} != {"logic"}:
        head.names = columns
    elif not head.names:
        head.names = [str(index) for index in range(len(columns))]
    return []


def _positions(path: Path, head: Head, times: list[Fraction]) -> tuple[list[int], Fraction]:
    """(position of each row counted from the first, positions a second)."""
    if head.rate is None and head.unit is None:
        raise BadCapture(path, "the header", "times without unit or samplerate", "one of them", "export with comments")
    if head.unit is not None:
        per_second = Fraction(10 ** UNITS[head.unit])
    else:
        assert head.rate is not None
        per_second = Fraction(10 ** next(p for p in UNITS.values() if 10**p >= head.rate or p == 15))
    if head.rate is None:
        finest = max(time.denominator for time in times)
        return [int((time - times[0]) * finest) for time in times], per_second * finest
    return [round((time - times[0]) * head.rate / per_second) for time in times], head.rate
