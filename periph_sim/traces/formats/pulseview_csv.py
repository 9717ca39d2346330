"""CSV files of sigrok-cli, PulseView and DSView: comments, and a row for each sample, or with a time for each change.

    ; Channels (2/8): SCL, SDA        names
    ; Samplerate: 4 MHz               rate; DSView: Sample rate
    SCL,SDA | logic,logic | microseconds,logic,logic | Time,SCL,SDA | Time(s), SCL, SDA | no header
    1,1

Times are counted from the first row, which is the first sample: libsigrok 0.5 prints times one sample period late, and
older versions do not. Their unit is that of the header. If it states none, the unit is the coarsest in which a sample
period is at least 1, which the writer chooses.

Chosen: without a time column, every row is a sample. The separator is the first of comma, tab, semicolon, bar and blank
that occurs in the first row. In a block of regular rows, only the times of the last row and of rows that change a level
are read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import chain
from math import gcd
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ..capture import size_limits as limits
from ..capture.capture import BadCapture, Capture, Channel, Positions, rate_of
from ..capture.grid import nearest
from .csv_rows import NUMBER, BadRow, Rows, Time

NAME = "PulseView or DSView CSV"
SUFFIXES = (".csv", ".txt")

BLOCK = 1 << 20  # number of bytes that are read at once
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
LINE = re.compile(rb"[^\r\n]*(\r\n|\r|\n|\Z)")
BOM = b"\xef\xbb\xbf"
FIRST_ROW = re.compile(
    rb'(?:\xef\xbb\xbf)?(;|"?(time|\w*seconds)"?([,\t;|]| (?!\[))|time\([munp]?s\)|[01]([,\t;| ]+[01])*\s*[\r\n])',
    re.IGNORECASE,
)
SALVAGE = ", or read the rows before it with --salvage"


def recognises(path: Path, head: bytes) -> bool:
    return FIRST_ROW.match(head) is not None


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture. Raise BadCapture with the line of an error. rate: overrides the rate that the file states."""
    with path.open("rb") as file:
        return _read(path, file, rate, salvage)


@dataclass
class Head:
    """Contents of the comments and the header row."""

    names: list[str] = field(default_factory=list)
    rate: Fraction | None = None
    separator: str = ","
    timed: bool = False
    unit: str | None = None
    lines: int = 0  # number of lines of the comments and the header


def _read(path: Path, file: BinaryIO, rate: Fraction | None, salvage: bool) -> Capture:
    blocks = _blocks(path, file)
    head, rest = _head(path, next(blocks, b""))
    rows = Rows(len(head.names), head.timed, head.separator, head.lines)
    notes: list[str] = []
    try:
        for block in chain([rest], blocks):
            rows.feed(block)
    except BadRow as bad:
        way_out = "export again" if "time" in bad.found else "export logic channels only"
        if not (salvage and rows.count):
            way_out += SALVAGE if rows.count else ""
            raise BadCapture(path, f"line {bad.line}", bad.found, bad.expected, way_out) from None
        notes.append(f"line {bad.line} is {bad.found}: it and all later lines are dropped")
    if not rows.count:
        raise _no_rows(path)
    positions_a_second = head.rate
    if head.timed:
        at, length, positions_a_second, levels = _timed(path, head, rows, notes)
    else:
        at, _, levels = rows.changes()
        length = rows.count
    if not rate and not positions_a_second:
        notes.append("the file states no samplerate, so positions have no time")
    channels = tuple(_channel(name, index, at, levels[:, index]) for index, name in enumerate(head.names))
    sampled = not head.timed or head.rate is not None
    return Capture(path, rate or positions_a_second, length, channels, sampled, tuple(notes))


def _channel(name: str, index: int, at: Positions, levels: np.ndarray[tuple[int], np.dtype[np.uint8]]) -> Channel:
    """Build a channel from its levels at some positions. The first of them is the level at position 0."""
    turned = np.flatnonzero(levels[1:] != levels[:-1]) + 1
    return Channel(name, index, int(levels[0]), at[turned])


def _blocks(path: Path, file: BinaryIO) -> Iterator[bytes]:
    """Yield blocks of whole lines with about BLOCK bytes each."""
    rest = b""
    while piece := file.read(BLOCK):
        rest += piece
        end = rest.rfind(b"\n") + 1 or rest[:-1].rfind(b"\r") + 1
        if end:
            yield rest[:end]
            rest = rest[end:]
        if len(rest) > limits.MOST_METADATA:
            found, most = f"a line of over {limits.MOST_METADATA} bytes", "lines of text"
            raise BadCapture(path, "the file", found, most, "export it again")
    if rest:
        yield rest


def _head(path: Path, block: bytes) -> tuple[Head, bytes]:
    """Parse the comments and the header, all of which are in the first block. Return them and the rest of the block."""
    head = Head()
    at = len(BOM) if block.startswith(BOM) else 0
    while at < len(block):
        line = LINE.match(block, at)
        assert line is not None
        text = line[0].decode("utf-8", "replace").strip()
        head.lines += 1
        if text.startswith(";"):
            _comment(path, head, text)
        elif text:
            is_header = _header(path, head, text)
            head.lines -= not is_header
            return head, block[line.end() if is_header else at :]
        at = line.end()
    raise _no_rows(path)


def _comment(path: Path, head: Head, line: str) -> None:
    if match := re.match(r";\s*Channels \(\d+/\d+\):?\s*(.*)", line):
        head.names = [name.strip() for name in match[1].split(",")] if match[1] else []
    elif match := re.match(r";\s*Sample ?rate:\s*(.*)", line, re.IGNORECASE):
        try:
            head.rate = rate_of(match[1]) or None
        except ValueError:
            place = f"line {head.lines}"
            raise BadCapture(path, place, repr(match[1][:80]), "a rate such as 4 MHz", "mend it") from None


def _header(path: Path, head: Head, line: str) -> bool:
    """Set separator, names and time column from the first row. Return True if it is a header, False for samples."""
    head.separator = next((mark for mark in SEPARATORS if mark in line), ",")
    if line.count(head.separator) > limits.MOST_CHANNELS:
        found, most = f"{line.count(head.separator) + 1} columns", f"at most {limits.MOST_CHANNELS}"
        raise BadCapture(path, f"line {head.lines}", found, most, "export fewer channels")
    cells = [cell.strip().strip('"') for cell in line.split(head.separator)]
    if all(NUMBER.fullmatch(cell.encode()) for cell in cells) and cells != head.names:
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
        raise BadCapture(path, f"line {head.lines}", "no column of levels", "a column a channel", "export it again")
    if head.names and len(columns) != len(head.names):
        found = f"{len(columns)} columns"
        place, expected = f"line {head.lines}", f"{len(head.names)} as the comment says"
        raise BadCapture(path, place, found, expected, "export it again")
    if {column.casefold() for column in columns} != {"logic"}:
        head.names = columns
    elif not head.names:
        head.names = [str(index) for index in range(len(columns))]
    return True


def _timed(
    path: Path, head: Head, rows: Rows, notes: list[str]
) -> tuple[Positions, int, Fraction, np.ndarray[tuple[int, int], np.dtype[np.uint8]]]:
    """Convert rows with times. Return (positions of rows with a change, length, positions per second, levels)."""
    if head.rate is None and head.unit is None:
        raise BadCapture(path, "the header", "times without unit or samplerate", "one of them", "export with comments")
    if head.unit is not None:
        per_second = Fraction(10 ** UNITS[head.unit])
    else:
        assert head.rate is not None
        per_second = Fraction(10 ** next(p for p in UNITS.values() if 10**p >= head.rate or p == 15))
    try:
        at, decimals, levels = rows.changes()
        decimals, at, last = _since_first(at, decimals, rows.last)
        if head.rate is None:
            finest = 10**decimals
            step = gcd(finest, last, int(np.gcd.reduce(at)))
            positions, length, rate = at // step, last // step + 1, per_second * finest / step
        else:
            rate = head.rate
            ratio = rate / (per_second * 10**decimals)
            positions = nearest(np.append(at, last), ratio).astype(np.int64)
            positions, length = positions[:-1], int(positions[-1]) + 1
    except OverflowError:
        raise BadCapture(
            path, "its times", "times that need over 64 bits", "times of one kind", "export again"
        ) from None
    counts = np.append(positions[1:] != positions[:-1], True)  # if several rows are of one sample, the last one counts
    if not counts.all():
        lost = len(counts) - int(counts.sum())
        notes.append(f"rows ignored, since the next row has the same sample: {lost}")
    return positions[counts], length, rate, levels[counts]


def _since_first(at: Positions, decimals: int, last: Time) -> tuple[int, Positions, int]:
    """Return a common number of decimals, and the times and the last time with it, counted from the first time.

    Raise OverflowError beyond 64 bits.
    """
    finer = max(last.decimals - decimals, 0)
    first = int(at[0]) * 10**finer
    end = last.scaled(decimals + finer) - first
    if end >= 1 << 62 or abs(first) >= 1 << 62:
        raise OverflowError
    return decimals + finer, at * 10**finer - first, end


def _no_rows(path: Path) -> BadCapture:
    return BadCapture(path, "the file", "no rows", "the levels of the samples", "export it again")
