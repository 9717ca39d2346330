"""Reader of rows of levels, with or without a time before them. It keeps the rows that change a level.

    1,0\\n  2360,1,0\\n --> if all rows look like the first: compare whole rows --> changed rows: time, levels
                       --> otherwise: read line by line

A block whose rows all look like the first is compared as arrays; any other is read line by line, which
allows comments, blank lines and mixed line ends, and reports errors with their line number.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..capture import size_limits as limits
from ..capture.capture import Levels, Positions

LEVELS = {b"0": 0, b"1": 1}
NUMBER = re.compile(rb"([-+]?\d+)(?:\.(\d*))?(?:[eE]([-+]?\d\d?))?", re.ASCII)
IN_TIMES = np.isin(np.arange(256), np.frombuffer(b"0123456789.+-eE", np.uint8))
BELOW_64_BITS = 1 << 62


class BadRow(ValueError):
    """A row cannot be read. It has the line, what was found and what was expected."""

    def __init__(self, line: int, found: str, expected: str) -> None:
        super().__init__(f"line {line}: found {found}, expected {expected}")
        self.line = line
        self.found = found
        self.expected = expected


class Time(NamedTuple):
    """digits / 10**decimals, exactly."""

    digits: int
    decimals: int

    def scaled(self, decimals: int) -> int:
        return int(self.digits * 10 ** (decimals - self.decimals))


@dataclass(frozen=True)
class Form:
    """The common form of a block's rows after the time.

    mask, bytes: each byte of a row, and-ed with its mask, equals the corresponding one of `bytes`.
    cells: the places of the levels.
    """

    bytes: NDArray[np.uint8]
    mask: NDArray[np.uint8]
    cells: NDArray[np.intp]


class Rows:
    """Reader of blocks of whole lines. count, line: the numbers of rows and of lines so far."""

    def __init__(self, columns: int, timed: bool, separator: str, line: int) -> None:
        self.count = 0
        self.line = line
        self._columns = columns
        self._timed = timed
        self._separator = separator.encode()
        self._before: bytes | None = None  # levels of the last row, one byte each
        self.last = Time(0, 0)
        self._held = 0
        self._places: list[Positions] = []  # row numbers, or the digits of times
        self._decimals: list[int] = []
        self._levels: list[Levels] = []

    def feed(self, block: bytes) -> None:
        """Read a block. Raise BadRow if a row cannot be read; the rows before it are kept."""
        if not self._quickly(block):
            self._line_by_line(block)

    def changes(self) -> tuple[Positions, int, Levels]:
        """Return the rows that change a level as (places, decimals, levels).

        Places are row numbers, or times with this number of decimals. Raise OverflowError if the times need over 64
        bits.
        """
        decimals = max(self._decimals, default=0)
        scaled = [
            places if of == decimals else _times_ten_to(places, decimals - of)
            for places, of in zip(self._places, self._decimals, strict=True)
        ]
        levels = np.concatenate(self._levels) if self._levels else np.zeros((0, self._columns), np.uint8)
        return np.concatenate([*scaled, np.zeros(0, np.int64)]), decimals, levels

    # Whole blocks ------------------------------------------------------------------

    def _quickly(self, block: bytes) -> bool:
        """Read a block if all its rows have the form of the first. Return False if they do not."""
        first = block[: block.find(b"\n") + 1]
        tail = first[first.find(self._separator) :] if self._timed else first
        form = _form(tail, self._columns)
        if form is None or not block.endswith(b"\n"):
            return False
        width = len(form.bytes)
        data = np.frombuffer(block, np.uint8)
        if self._timed:
            ends = np.flatnonzero(data == ord("\n")) + 1
            begins = np.concatenate(([0], ends[:-1]))
            if (ends - begins <= width).any():
                return False
            places = ends[:, None] + np.arange(-width, 0)
            in_times = np.ones(len(data), np.bool_)
            in_times[places] = False
            if not IN_TIMES[data[in_times]].all():
                return False
            rows = data[places]
        elif len(data) % width:
            return False
        else:
            rows = data.reshape(-1, width)
        if ((rows & form.mask) != form.bytes).any():
            return False
        changed = np.flatnonzero(rows[1:] != rows[:-1]) // width + 1
        changed = self._with_first(changed[np.flatnonzero(np.diff(changed, prepend=0))], rows[0][form.cells])
        at, decimals = changed + self.count, 0
        if self._timed:
            read = changed if len(changed) and changed[-1] == len(ends) - 1 else np.append(changed, len(ends) - 1)
            cuts = zip(begins[read].tolist(), (ends[read] - width).tolist(), strict=True)
            try:
                digits, decimals = _times([block[begin:end] for begin, end in cuts])
            except (ValueError, OverflowError):
                return False
            if (digits[1:] < digits[:-1]).any() or (self.count and _less(Time(int(digits[0]), decimals), self.last)):
                return False
            at, self.last = digits[: len(changed)], Time(int(digits[-1]), decimals)
        self._keep(at, decimals, np.bitwise_and(rows[changed][:, form.cells], 1))
        self._before = bytes(rows[-1][form.cells] & 1)
        self.count += len(rows)
        self.line += len(rows)
        return True

    def _with_first(self, changed: NDArray[np.intp], levels: Levels) -> NDArray[np.intp]:
        """Return the changed rows, including the first of the block if it differs from the last of the block before."""
        if self._before == bytes(levels & 1):
            return changed
        return np.concatenate((np.zeros(1, np.intp), changed))

    def _keep(self, places: NDArray[np.integer], decimals: int, levels: Levels) -> None:
        if not len(places):
            return
        self._held += len(places)
        if self._held * (8 + self._columns) > 8 * limits.MOST_EDGES:
            most = 8 * limits.MOST_EDGES // (8 + self._columns)
            raise BadRow(self.line + 1, f"over {most} changes", "fewer")
        self._places.append(places.astype(np.int64))
        self._decimals.append(decimals)
        self._levels.append(levels)

    # Line by line -------------------------------------------------------------------

    def _line_by_line(self, block: bytes) -> None:
        places: list[int] = []
        decimals: list[int] = []
        levels: list[bytes] = []
        before = self.count
        try:
            for line in block.splitlines():
                self.line += 1
                row = line.strip()
                if not row or row.startswith(b";"):
                    continue
                now = self._row(row)
                self.count += 1
                if now != self._before:
                    places.append(self.last.digits if self._timed else self.count - 1)
                    decimals.append(self.last.decimals if self._timed else 0)
                    levels.append(now)
                    self._before = now
        finally:
            most = max(decimals, default=0)
            scaled = [Time(place, of).scaled(most) for place, of in zip(places, decimals, strict=True)]
            shaped = np.frombuffer(b"".join(levels), np.uint8).reshape(-1, self._columns)
            try:
                self._keep(np.array(scaled, np.int64), most, shaped)
            except OverflowError:
                self.count = before
                raise BadRow(self.line, "times that need over 64 bits", "times of one kind") from None

    def _row(self, row: bytes) -> bytes:
        """Return the levels of a row, one byte each, and store its time."""
        cells = [cell.strip() for cell in row.split(self._separator)]
        expected = f"{'a time and ' if self._timed else ''}{self._columns} levels 0 or 1"
        time, levels = self.last, b""
        try:
            if self._timed:
                time = _time(cells.pop(0))
            levels = bytes([LEVELS[cell] for cell in cells])
        except (ValueError, KeyError):
            pass
        if len(levels) != self._columns:
            raise BadRow(self.line, repr(row[:80].decode("utf-8", "replace")), expected)
        if self.count and _less(time, self.last):
            raise BadRow(self.line, "a time before that of the row above", "rising times")
        self.last = time
        return levels


def _form(row: bytes, columns: int) -> Form | None:
    """Return the form of rows like this one; None if it does not consist of `columns` levels and single separators."""
    if not re.fullmatch(rb"[,;|\t ]{0,2}[01]([,;|\t ]{1,2}[01])*[ \t]?\r?\n", row):
        return None
    data = np.frombuffer(row, np.uint8)
    level = (data == ord("0")) | (data == ord("1"))
    mask = np.where(level, 0xFE, 0xFF).astype(np.uint8)
    cells = np.flatnonzero(level)
    return Form(data & mask, mask, cells) if len(cells) == columns else None


def _times(texts: list[bytes]) -> tuple[NDArray[np.int64], int]:
    """Parse times. Return their digits and their common number of decimals.

    Raise ValueError if a text is no number, and OverflowError beyond 64 bits.
    """
    joined = b" ".join(texts)
    if b"e" not in joined and b"E" not in joined:
        points = {len(text) - 1 - text.rfind(b".") if b"." in text else 0 for text in texts}
        if len(points) == 1 and joined.count(b".") in (0, len(texts)):
            return np.array(list(map(int, joined.replace(b".", b"").split())), np.int64), points.pop()
    times = [_time(text) for text in texts]
    decimals = max(time.decimals for time in times)
    return np.array([time.scaled(decimals) for time in times], np.int64), decimals


def _time(text: bytes) -> Time:
    """Parse a time. Raise ValueError if it is no number or exceeds 64 bits."""
    if not (match := NUMBER.fullmatch(text)):
        raise ValueError
    part = match[2] or b""
    power = int(match[3] or 0) - len(part)
    digits = int(match[1] + part) * 10 ** max(power, 0)
    if abs(digits) >= BELOW_64_BITS or power < -30:
        raise ValueError
    return Time(digits, max(-power, 0))


def _less(a: Time, b: Time) -> bool:
    decimals = max(a.decimals, b.decimals)
    return a.scaled(decimals) < b.scaled(decimals)


def _times_ten_to(places: Positions, power: int) -> Positions:
    if power > 18 or (len(places) and int(np.abs(places).max()) >= BELOW_64_BITS // 10**power):
        raise OverflowError
    scaled: Positions = places * 10**power
    return scaled
