"""Reader of CSV files in which the title of each column has a name and a unit, and all cells are numbers.

    time [s],phi [deg],ax [g]
    0.00,1.5,0.01

The first line contains the titles; every other line that is not blank has one finite number per column.
"""

from __future__ import annotations

import csv
import re
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from math import isfinite, nan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...core.input_files import open_input, similar_file
from ...core.phrases import shorten
from ..capture.capture import BadCapture
from .csv_rows import numbered_rows

Floats = NDArray[np.float64]

LARGEST = 1 << 30  # maximum size of a file in bytes, which is enough for weeks of a sensor's values
TITLE = re.compile(r"\s*(\S[^\[\]]*?)\s*\[\s*([^\[\]]*?)\s*\]\s*")
WRITTEN = "a title such as 'time [s]' or 'phi [deg]' for every column"


@dataclass(frozen=True, eq=False)
class Column:
    """One column: its name and unit from the title, and its numbers."""

    name: str
    unit: str
    values: Floats


def read(path: Path) -> list[Column]:
    """Read the columns in the order of the file. All columns have the same number of rows, which is at least 1.

    Raise BadCapture if the file has errors.
    """
    try:
        with open_input(path, LARGEST) as file:
            head = file.readline().decode("utf-8-sig")
    except OSError as error:
        found, hint = (error.strerror or "an error").lower(), similar_file(path) or "check its name"
        raise BadCapture(path, "the file", found, "a file that can be read", hint) from None
    except UnicodeDecodeError:
        raise _bad(path, 1, "bytes that are not UTF-8", "text") from None
    try:
        titles = [_title(path, cell) for cell in next(csv.reader([head]), [])]
    except csv.Error as error:
        raise _bad(path, 1, str(error), WRITTEN) from None
    names = [name for name, _ in titles]
    for place, name in enumerate(names):
        if name in names[:place]:
            raise _bad(path, 1, f"two columns named {name!r}", "a name of its own for every column")
    if not titles:
        raise _bad(path, 1, "nothing", WRITTEN)
    values = _numbers(path, len(titles))
    return [Column(name, unit, values[:, place]) for place, (name, unit) in enumerate(titles)]


def line_of_row(path: Path, row: int) -> int:
    """Return the line number of a row of numbers.

    row: the number of the row, counted from 0. Blank lines do not count as rows.
    """
    return next(line for number, (line, _) in enumerate(_rows(path)) if number == row)


def _title(path: Path, cell: str) -> tuple[str, str]:
    found = TITLE.fullmatch(cell)
    if found is None:
        raise _bad(path, 1, shorten(repr(cell), 100), WRITTEN)
    return found[1], found[2]


def _numbers(path: Path, columns: int) -> Floats:
    """Return the numbers, all of which are finite, in the shape (rows, columns)."""
    values = array("d")
    for line, cells in _rows(path):
        if len(cells) != columns:
            raise _bad(path, line, f"{len(cells)} cells", f"{columns}, as there are titles")
        for cell in cells:
            value = _number(cell)
            if not isfinite(value):
                raise _bad(path, line, shorten(repr(cell), 100), "a finite number")
            values.append(value)
    if not values:
        raise _bad(path, 2, "nothing", "a row of numbers")
    return np.frombuffer(values).reshape(-1, columns)


def _rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield the line number and the cells of every row after the titles."""
    line = 1
    with path.open(encoding="utf-8-sig", newline="") as file:
        try:
            for line, cells in islice(numbered_rows(path, file, "numbers", "correct the file"), 1, None):
                yield line, cells
        except UnicodeDecodeError:
            raise _bad(path, line + 1, "bytes that are not UTF-8", "numbers") from None


def _number(cell: str) -> float:
    try:
        return nan if "_" in cell else float(cell)
    except ValueError:
        return nan


def _bad(path: Path, line: int, found: str, expected: str) -> BadCapture:
    return BadCapture(path, f"line {line}", found, expected, "correct the file")
