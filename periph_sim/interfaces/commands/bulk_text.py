"""Bulk formatting of columns of numbers and words as bytes, without a Python statement for each line.

    columns of numbers, texts, ... --> one array of characters with a row for each line --> bytes

A value that is shorter than its column is padded: with blanks in columns that are aligned, otherwise with NULs.
Finally, all NULs are removed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Characters = NDArray[np.uint8]
Numbers = NDArray[np.int64]

AT_ONCE = 1 << 15  # number of lines that are formatted at a time; their characters fit into the processor's cache
BLANK, NONE = b" ", b"\0"
MAX_TABLE = 1 << 24  # the largest code for which `numbered` uses a table; if a code is larger, it sorts the codes

# The four digits of each number below 10,000, as one machine word.
# Selecting many machine words from an array is ten times as fast as selecting many rows of four bytes.
_FOUR = (np.arange(10_000)[:, None] // (1000, 100, 10, 1) % 10 + ord("0")).astype(np.uint8).view(np.uint32)[:, 0]


class Literal:
    """A column with the same text in every line."""

    def __init__(self, text: str) -> None:
        self._text = np.frombuffer(text.encode(), np.uint8)
        self.width = len(self._text)

    def fill(self, into: Characters, lines: slice) -> None:
        into[:] = self._text


class Digits:
    """A column of non-negative integers, right-aligned. The last `decimals` digits are after a decimal point.

    pad: the character that fills the column before the first digit: BLANK, or NONE (a NUL, which is removed later).
    width: the minimum width of the column.
    """

    def __init__(self, values: Numbers, decimals: int = 0, pad: bytes = BLANK, width: int = 0) -> None:
        largest = int(values.max()) if len(values) else 0
        self._values = values
        self._decimals = decimals
        self._pad = pad
        self._digits = max(len(str(largest)), decimals + 1)
        self.width = max(self._digits + (decimals > 0), width)

    def fill(self, into: Characters, lines: slice) -> None:
        values = self._values[lines]
        groups = -(-self._digits // 4)
        written = np.empty((len(values), groups), np.uint32)
        rest = values
        for group in range(groups - 1, 0, -1):
            less = rest // 10_000
            written[:, group] = _FOUR[rest - less * 10_000]
            rest = less
        written[:, 0] = _FOUR[rest]
        digits = written.view(np.uint8)[:, 4 * groups - self._digits :]
        whole = self._digits - self._decimals
        for place in range(whole - 1):  # leading zeros become padding
            np.copyto(digits[:, place], self._pad[0], where=values < 10 ** (self._digits - 1 - place))
        free = self.width - self._digits - (self._decimals > 0)
        into[:, :free] = self._pad[0]
        into[:, free : free + whole] = digits[:, :whole]
        if self._decimals:
            into[:, free + whole] = ord(".")
            into[:, free + whole + 1 :] = digits[:, whole:]


class Words:
    """A column with one of a few texts in each line.

    codes: the code of the text in each line, an integer of 0 or more.
    text_of: a function that returns the text of a code.
    pad: the character that fills the column after a text: BLANK, or NONE (a NUL, which is removed later).
    """

    def __init__(self, codes: Numbers, text_of: Callable[[int], str], pad: bytes = NONE) -> None:
        used, self._place = numbered(codes)
        texts = [text_of(code).encode() for code in used.tolist()]
        self.width = max(map(len, texts), default=0)
        joined = b"".join(text.ljust(self.width, pad) for text in texts)
        self._book = np.frombuffer(joined, np.uint8).reshape(len(texts), self.width)

    def fill(self, into: Characters, lines: slice) -> None:
        np.take(self._book, self._place[lines], axis=0, out=into, mode="clip")


class Sparse:
    """Columns that are empty in most lines.

    columns: the columns; each has one value for each element of `where`.
    where: the numbers of the lines that are not empty, in increasing order.
    """

    def __init__(self, columns: Sequence[Column], where: Numbers) -> None:
        self._columns = columns
        self._where = where
        self.width: int = sum(column.width for column in columns)

    def fill(self, into: Characters, lines: slice) -> None:
        into[:] = NONE[0]
        begin, end = np.searchsorted(self._where, [lines.start, lines.stop]).tolist()
        page = np.empty((end - begin, self.width), np.uint8)
        left = 0
        for column in self._columns:
            column.fill(page[:, left : left + column.width], slice(begin, end))
            left += column.width
        into[self._where[begin:end] - lines.start] = page


# A column has the same width in every line. Its method `fill` writes some lines of the column into an array that has
# a row for each of these lines and `width` characters in each row.
Column: TypeAlias = "Literal | Digits | Words | Sparse"


def numbered(codes: Numbers) -> tuple[Numbers, Numbers]:
    """Return the different codes in increasing order, and the index of each element of `codes` in this array.

    codes: integers of 0 or more, each the code of a text.
    """
    if len(codes) and int(codes.max()) > MAX_TABLE:
        return np.unique(codes, return_inverse=True)
    there = np.zeros(int(codes.max()) + 1 if len(codes) else 0, bool)
    there[codes] = True
    used = np.flatnonzero(there)
    places = np.zeros(len(there), np.int64)
    places[used] = np.arange(len(used))
    return used, places[codes]


def text(columns: Sequence[Column], lines: int) -> Iterator[bytes]:
    """Yield the lines of a text as bytes, AT_ONCE lines at a time. lines: the number of lines of the whole text."""
    bounds = np.cumsum([0, *(column.width for column in columns)]).tolist()
    for begin in range(0, lines, AT_ONCE):
        some = slice(begin, min(begin + AT_ONCE, lines))
        page = np.empty((some.stop - begin, bounds[-1]), np.uint8)
        for column, left, right in zip(columns, bounds[:-1], bounds[1:], strict=True):
            column.fill(page[:, left:right], some)
        yield page[page != NONE[0]].tobytes()
