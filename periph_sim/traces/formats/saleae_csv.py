"""Saleae's CSV files of digital data, with a row for each change. KingstVIS writes the form of Logic 1.x, too.

    Time [s],Channel 0,Channel 1      Logic 2: the first row is the start, the last row the end
    Time[s], SCL, SDA                 Logic 1.x: blanks after commas, no row for the end

Chosen: position 0 is the first row, even if its time is not 0. Without a rate, positions are nanoseconds, or finer if a
time has more decimals. `X` means that the level is unknown.

Captures are written in the form of Logic 2, with a row for the end. Times have nine decimals, or more if nine are not
exact. If no number of decimals is exact (for example at 24 MHz), times are rounded so finely that a reader that knows
the rate gets the same samples.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import numpy as np

from ..capture.capture import MOST_POSITION, UNKNOWN, BadCapture, Capture, Positions, changes, channel_of_states
from ..capture.sampling import LEAST_DECIMALS, OffGrid, decimals_for, quantized, rate_text, rescaled
from .csv_rows import Rows, numbered_rows

NAME = "Saleae CSV"
SUFFIXES = (".csv",)

HEADER = re.compile(rb'(?:\xef\xbb\xbf)?"?Time ?\[s\]"?[,\r\n]')
STATES = {"0": 0, "1": 1, "X": UNKNOWN, "x": UNKNOWN}
ROUNDED_TO = 10  # if times cannot be exact, a sample period is at least this number of units of the last decimal
CELLS = "01X"
NO_END = "the format has no row for the end, so the last change is used"


def recognises(path: Path, head: bytes) -> bool:
    return HEADER.match(head) is not None


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the capture in samples of `rate` or, without a rate, in ticks of the time stamps.

    salvage: True to keep the rows before the first wrong row. A note of the capture says what was left out.

    Raise BadCapture with the line of an error.
    """
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
        return _read(path, numbered_rows(path, file, "rows of cells", "export it again"), rate, salvage)


def write(capture: Capture, path: Path) -> tuple[str, ...]:
    """Write a capture. Return notes on rounded times.

    Raise BadCapture if the capture has no rate, or a rate that is too high.
    """
    decimals, exact = decimals_for(capture, LEAST_DECIMALS, ROUNDED_TO)
    per_second = 10**decimals
    rate = capture.rate or Fraction(per_second)
    at, which, states = changes(capture)
    *times, end = rescaled(np.append(at, capture.length - 1), per_second / rate).tolist()
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


def _positions(rows: Rows, rate: Fraction | None) -> tuple[Positions, Fraction]:
    """Return the position of each time, counted from the first row, and the number of positions per second.

    Raise BadCapture if a time is between two samples of `rate`, or if a position exceeds 64 bits.
    """
    times, decimals = rows.times(), rows.decimals
    while decimals > LEAST_DECIMALS and not (times % 10).any():
        times, decimals = times // 10, decimals - 1
    per_second = Fraction(10**decimals)
    too_late = rows.bad(rows.last_line, "a time beyond 64 bits", "a shorter capture", "state the rate")
    try:
        at = (times if rate is None else quantized(times, per_second, rate)).astype(np.int64)
    except OffGrid as off:
        raise rows.bad(
            rows.line_of(off.which), "a time between two samples", f"the grid of {rate} Hz", "state the right rate"
        ) from off
    except OverflowError:
        raise too_late from None
    if at[-1] > MOST_POSITION:
        raise too_late
    return at, rate or per_second


def _read(path: Path, table: Iterator[tuple[int, list[str]]], rate: Fraction | None, salvage: bool) -> Capture:
    _, header = next(table, (1, [""]))
    names = [name.strip() for name in header[1:]]
    if not names:
        raise BadCapture(path, "line 1", repr(",".join(header)), "Time [s] and channel names", "export CSV again")
    rows = Rows(path, len(names), STATES, LEAST_DECIMALS, "a time and 0, 1 or X", "export digital data")
    notes = [NO_END] if header[0].strip() == "Time[s]" else []
    try:
        for line, row in table:
            if len(row) != len(header):
                raise rows.bad(line, f"{len(row)} columns", f"{len(header)} as in line 1", "export it again")
            rows.add(line, ",".join(row))
    except BadCapture as error:
        if not salvage or not rows.count:
            raise
        said = str(error).removeprefix(f"{path}, ")
        notes.append(f"read up to line {rows.last_line}: {said}")
    if not rows.count:
        raise BadCapture(path, "line 2", "no row", "the levels at the start", "export it again")
    at, per_second = _positions(rows, rate)
    length = int(at[-1]) + 1
    channels = tuple(channel_of_states(name, i, at[:-1], rows.states(i), length) for i, name in enumerate(names))
    return Capture(path, per_second, length, channels, rate is not None, tuple(notes))
