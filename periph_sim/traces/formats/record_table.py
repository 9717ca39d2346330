"""Records as columns: growing while a run goes on, arrays afterwards.

    Record --> Columns.add --> RecordTable: one numpy array a column, each string once in a table

A record costs 49 bytes here, and one `append` a column while it is collected.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.records import Kind, Record

KINDS = tuple(Kind)
NUMBER_OF = {kind: number for number, kind in enumerate(KINDS)}

# Column, array's type code, numpy's type; the five strings are places in the table of that name.
COLUMNS: dict[str, tuple[str, str]] = {
    "number": ("q", "<i8"),
    "tick": ("q", "<i8"),
    "kind": ("B", "|u1"),
    "where": ("I", "<u4"),
    "what": ("I", "<u4"),
    "value": ("q", "<i8"),
    "text": ("I", "<u4"),
    "cause": ("q", "<i8"),
    "field": ("I", "<u4"),
}
TABLES = ("kind", "where", "what", "text", "field")


class Strings(dict[str, int]):
    """The place of each string; a new one is put at the end."""

    def __missing__(self, text: str) -> int:
        place = len(self)
        self[text] = place
        return place


@dataclass(frozen=True, eq=False)
class RecordTable:
    """Columns of equal length; row i of `where`, `what`, `text`, `field`, `kind` is a place in `names` of that column.

    per_second: ticks a second, None where nobody knows. end: the tick at which it was over.
    modules: the units of the run with their modules; empty for a capture.
    """

    columns: dict[str, NDArray[Any]]
    names: dict[str, tuple[str, ...]]
    per_second: Fraction | None
    end: int
    modules: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.columns["tick"])

    @property
    def number(self) -> NDArray[np.int64]:
        return self.columns["number"]

    @property
    def tick(self) -> NDArray[np.int64]:
        return self.columns["tick"]

    @property
    def value(self) -> NDArray[np.int64]:
        return self.columns["value"]

    @property
    def cause(self) -> NDArray[np.int64]:
        return self.columns["cause"]

    def rows(self, kind: Kind | None = None, where: str | None = None, what: str | None = None) -> NDArray[np.int64]:
        """The rows, in order, of one kind, one place and one thing; None takes all."""
        wanted = np.ones(len(self), bool)
        for column, name in (("kind", kind.value if kind else None), ("where", where), ("what", what)):
            if name is not None:
                places = [place for place, known in enumerate(self.names[column]) if known == name]
                wanted &= np.isin(self.columns[column], places)
        return np.flatnonzero(wanted)

    def texts(self, column: str, rows: NDArray[np.int64] | None = None) -> list[str]:
        """The strings of `kind`, `where`, `what`, `text` or `field`, row by row."""
        places = self.columns[column] if rows is None else self.columns[column][rows]
        names = self.names[column]
        return [names[place] for place in places.tolist()]

    def records(self, rows: NDArray[np.int64] | None = None) -> Iterator[Record]:
        """The records as they were made, a piece at a time, so that a long run costs no second copy."""
        chosen = np.arange(len(self)) if rows is None else rows
        where, what, text, fields = (self.names[name] for name in ("where", "what", "text", "field"))
        kinds = [Kind(name) for name in self.names["kind"]]
        for begin in range(0, len(chosen), 1 << 16):
            piece = chosen[begin : begin + (1 << 16)]
            for n, t, k, w, a, v, x, c, f in zip(
                *(self.columns[name][piece].tolist() for name in COLUMNS), strict=True
            ):
                yield Record(n, t, kinds[k], where[w], what[a], v, text[x], c, fields[f])


class Columns:
    """Collects records; `table` gives them as arrays."""

    def __init__(self) -> None:
        self._columns = {name: array(code) for name, (code, _) in COLUMNS.items()}
        self._strings = {name: Strings() for name in TABLES[1:]}
        self._appends = [column.append for column in self._columns.values()]

    def add(self, record: Record) -> None:
        strings = self._strings
        number, tick, kind, where, what, value, text, cause, field = self._appends
        number(record.number)
        tick(record.tick)
        kind(NUMBER_OF[record.kind])
        where(strings["where"][record.where])
        what(strings["what"][record.what])
        value(record.value)
        text(strings["text"][record.text])
        cause(record.cause)
        field(strings["field"][record.field])

    def __len__(self) -> int:
        return len(self._columns["tick"])

    def table(self, per_second: Fraction, end: int, modules: dict[str, tuple[str, ...]]) -> RecordTable:
        columns = {name: np.frombuffer(self._columns[name], code) for name, (code, _) in COLUMNS.items()}
        names = {"kind": tuple(kind.value for kind in KINDS)}
        names |= {name: tuple(strings) for name, strings in self._strings.items()}
        return RecordTable(columns, names, per_second, end, modules)


def table_of(records: Iterable[Record], per_second: Fraction, end: int) -> RecordTable:
    """The table of given records."""
    columns = Columns()
    for record in records:
        columns.add(record)
    return columns.table(per_second, end, {})
