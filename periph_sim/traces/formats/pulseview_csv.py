"""CSV files of sigrok-cli, PulseView and DSView: comments, then a row for each sample, or a row with a time per change.

    ; Channels (2/8): SCL, SDA        names
    ; Samplerate: 4 MHz               rate; DSView: Sample rate
    SCL,SDA | logic,logic | microseconds,logic,logic | Time,SCL,SDA | Time(s), SCL, SDA | no header
    1,1

Times are counted from the first row, which is the first sample, because libsigrok 0.5 prints times one sample period
late and older versions do not. If the header states no unit of times, the unit is assumed that the programs choose by
default: the coarsest one in which a sample period is at least 1.

Chosen: without a time column, every row is a sample. The separator is the first of comma, tab, semicolon, bar and blank
that occurs in the first row.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from itertools import chain
from math import gcd
from pathlib import Path
from typing import IO

import numpy as np

from ..capture import size_limits as limits
from ..capture.capture import MOST_POSITION, BadCapture, Capture, Positions, channel_of_states, rate_of
from ..capture.sampling import DECIMAL, rescaled
from .csv_rows import Rows

NAME = "PulseView or DSView CSV"
SUFFIXES = (".csv", ".txt")

LEVELS = {"0": 0, "1": 1}
UNITS = {
    "seconds": 0,
    "milliseconds": 3,
    "microseconds": 6,
    "nanoseconds": 9,
    "picoseconds": 12,
    "femtoseconds": 15,
}
SHORT_UNITS = {"s": "seconds", "ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds", "ps": "picoseconds"}
TIME_IN = re.compile(r"time\s*[(\[](s|ms|us|ns|ps)[)\]]")
SEPARATORS = ",\t;| "
FIRST_ROW = re.compile(
    rb'(?:\xef\xbb\xbf)?(;|"?(time|\w*seconds)"?([,\t;|]| (?!\[))|time\([munp]?s\)|[01]([,\t;| ]+[01])*\s*[\r\n])',
    re.IGNORECASE,
)
SALVAGE = ", or read the rows before it with --salvage"


def recognises(path: Path, head: bytes) -> bool:
    return FIRST_ROW.match(head) is not None


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture. `rate` overrides the rate that the file states; times are converted to samples of this rate.

    salvage: True to keep the rows before the first wrong row. A note of the capture says what was left out.

    Raise BadCapture with the line of an error.
    """
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        return _read(path, file, rate, salvage)


Line = tuple[int, str]  # number and text of a line


@dataclass
class Head:
    """Contents of the comments and the header row.

    names: the names of the channels.
    timed: True if rows begin with a time.
    unit: the unit of times, a key of UNITS; None if the header states no unit.
    """

    names: list[str] = field(default_factory=list)
    rate: Fraction | None = None
    separator: str = ","
    timed: bool = False
    unit: str | None = None


def _read(path: Path, file: IO[str], rate: Fraction | None, salvage: bool) -> Capture:
    lines = enumerate(_lines(path, file), 1)
    head, first = _head(path, lines)
    expected = f"{'a time and ' if head.timed else ''}{len(head.names)} levels 0 or 1"
    way_out = "export logic channels only"
    rows = Rows(path, len(head.names), LEVELS, 0, expected, way_out, head.separator, head.timed)
    notes: list[str] = []
    try:
        _add_rows(rows, head.timed, chain(first, lines))
    except BadCapture as bad:
        if not (salvage and rows.count):
            way_out = bad.way_out + SALVAGE if rows.count else bad.way_out
            raise BadCapture(path, bad.place, bad.found, bad.expected, way_out) from None
        notes.append(f"{bad.place} is {bad.found}: it and all later lines are dropped")
    if not rows.count:
        raise BadCapture(path, "the file", "no rows", "the levels of the samples", "export it again")
    try:
        at, positions_a_second = _positions(path, head, rows, rate)
    except OverflowError:
        found, expected = "times that need over 64 bits", "times of one kind"
        raise BadCapture(path, "its times", found, expected, "export again") from None
    lost = int((at[1:-1] == at[:-2]).sum())  # number of rows that have the same sample as the next row
    if lost:
        notes.append(f"rows ignored, since the next row has the same sample: {lost}")
    if not positions_a_second:
        notes.append("the file states no samplerate, so positions have no time")
    length = int(at[-1]) + 1
    channels = tuple(channel_of_states(name, i, at[:-1], rows.states(i), length) for i, name in enumerate(head.names))
    sampled = not head.timed or rate is not None or head.rate is not None
    return Capture(path, positions_a_second, length, channels, sampled, tuple(notes))


def _lines(path: Path, file: IO[str]) -> Iterator[str]:
    for line in iter(partial(file.readline, limits.MOST_METADATA), ""):
        if len(line) == limits.MOST_METADATA:
            raise BadCapture(
                path, "the file", f"a line of over {limits.MOST_METADATA} bytes", "lines of text", "export it again"
            )
        yield line


def _head(path: Path, lines: Iterator[Line]) -> tuple[Head, list[Line]]:
    """Parse the comments and the header. Return their contents, and a list with the first row if there is no header."""
    head = Head()
    for number, line in lines:
        text = line.strip()
        if text.startswith(";"):
            _comment(path, head, number, text)
        elif text:
            is_header = _header(path, head, number, text)
            return head, [] if is_header else [(number, line)]
    return head, []


def _add_rows(rows: Rows, timed: bool, lines: Iterator[Line]) -> None:
    """Add all rows. If rows have no times, a row that equals the previous row is only counted, which is quicker."""
    before = ""
    for number, line in lines:
        if line == before:
            rows.count += 1
            continue
        text = line.strip()
        if text and not text.startswith(";"):
            rows.add(number, text)
            before = "" if timed else line


def _comment(path: Path, head: Head, number: int, line: str) -> None:
    if match := re.match(r";\s*Channels \(\d+/\d+\):?\s*(.*)", line):
        head.names = [name.strip() for name in match[1].split(",")] if match[1] else []
    elif match := re.match(r";\s*Sample ?rate:\s*(.*)", line, re.IGNORECASE):
        try:
            head.rate = rate_of(match[1]) or None
        except ValueError:
            raise BadCapture(path, f"line {number}", repr(match[1][:80]), "a rate such as 4 MHz", "mend it") from None


def _header(path: Path, head: Head, number: int, line: str) -> bool:
    """Set separator, names and time column from the first row. Return True if this row is a header."""
    head.separator = next((mark for mark in SEPARATORS if mark in line), ",")
    if line.count(head.separator) > limits.MOST_CHANNELS:
        found, most = f"{line.count(head.separator) + 1} columns", f"at most {limits.MOST_CHANNELS}"
        raise BadCapture(path, f"line {number}", found, most, "export fewer channels")
    cells = [cell.strip().strip('"') for cell in line.split(head.separator)]
    if all(DECIMAL.fullmatch(cell) for cell in cells) and cells != head.names:
        head.timed = bool(head.names) and len(cells) == len(head.names) + 1
        head.names = head.names or [str(index) for index in range(len(cells))]
        return False
    unit = cells[0].casefold()
    if match := TIME_IN.fullmatch(unit):
        unit = SHORT_UNITS[match[1]]
    head.timed = unit in UNITS or unit == "time"
    head.unit = unit if unit in UNITS else None
    columns = cells[1:] if head.timed else cells
    if not columns:
        raise BadCapture(path, f"line {number}", "no column of levels", "a column a channel", "export it again")
    if head.names and len(columns) != len(head.names):
        found = f"{len(columns)} columns"
        raise BadCapture(path, f"line {number}", found, f"{len(head.names)} as the comment says", "export it again")
    if {column.casefold() for column in columns} != {"logic"}:
        head.names = columns
    elif not head.names:
        head.names = [str(index) for index in range(len(columns))]
    return True


def _positions(path: Path, head: Head, rows: Rows, rate: Fraction | None) -> tuple[Positions, Fraction | None]:
    """Return the positions of the rows with a change and of the last row, and the number of positions per second.

    rate: the sampling rate; None to use the rate that the file states, if any.

    Raise OverflowError if a position exceeds 64 bits.
    """
    times = rows.times()
    if not head.timed:
        times[-1] = rows.count - 1
        return times, rate or head.rate
    if head.unit is not None:
        power = UNITS[head.unit]
    elif head.rate is not None:
        power = next(p for p in UNITS.values() if 10**p >= head.rate or p == 15)
    else:
        raise BadCapture(path, "the header", "times without unit or samplerate", "one of them", "export with comments")
    per_second = Fraction(10 ** (power + rows.decimals))
    rate = rate or head.rate
    if rate is None:
        step = gcd(10**rows.decimals, *times.tolist())
        times, rate = times // step, per_second / step
    else:
        times = rescaled(times, rate / per_second)
    if int(times[-1]) >= MOST_POSITION:
        raise OverflowError
    return times.astype(np.int64), rate
