"""Tables of events: tuples of columns, which are arrays of equal length."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Table = TypeVar("Table", bound=tuple[Any, ...])


def select(table: Table, rows: NDArray[np.int64] | NDArray[np.bool_] | slice) -> Table:
    """Return a table of some rows of a table. rows: the numbers of these rows, a mask or a slice."""
    kind: Any = type(table)
    selected: Table = kind(*(column[rows] for column in table))
    return selected


def joined(tables: Sequence[Table]) -> Table:
    """Concatenate one or more tables."""
    kind: Any = type(tables[0])
    together: Table = kind(*(np.concatenate(columns) for columns in zip(*tables, strict=True)))
    return together
