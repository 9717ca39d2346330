"""Records as columns, which are collected during a run and converted to arrays afterwards.

    record of a topic --> Columns.keep --> RecordTable: one numpy array per column, each string once in a table

Three fields of a record say what it is about: `kind`, such as an access to a register; `where`, the wire, unit or
module; and `what`, such as the register. A topic is a combination of these three. A record takes 53 bytes in the table.
It takes only 44 bytes during the run, because the number of its topic replaces the three fields. Collected records are
stored in blocks of fixed length, so that no object is created for a record and no record is moved.
"""

# core: compiled

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from ...core.records import RECORDED, Kind, Record, RecordSink
from ...form.c_types import Buffer, Text, UInt32

Block = dict[str, "array[int]"]
Clocks = Mapping[str, Sequence[tuple[int, Fraction]]]

KINDS = RECORDED
NUMBER_OF = {kind: number for number, kind in enumerate(KINDS)}

# A dictionary from each column to its type code in `array` and its type in numpy.
# The columns kind, where, what, text and field contain indices into `names`.
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
BLOCK = 2048  # number of records of a block
# A dictionary from each column of collected records to its type code in `array` and its number of bytes.
# The column `topic` has the numbers of topics; a topic is a combination of kind, where and what.
COLLECTED = {"topic": ("I", 4), "number": ("q", 8), "tick": ("q", 8), "value": ("q", 8)}
COLLECTED |= {"cause": ("q", 8), "text": ("I", 4), "field": ("I", 4)}
EMPTY = {name: array(code, bytes(BLOCK * size)) for name, (code, size) in COLLECTED.items()}
TABLES = ("kind", "where", "what", "text", "field")
TOPIC = TABLES[:3]


class Topics(NamedTuple):
    """The topics that occur in a table. A topic is a combination of kind, where and what.

    indices: for each topic, its three indices into the strings of kind, of where and of what (`RecordTable.names`).
    row: for each row of the table, the number of its topic.
    """

    indices: NDArray[np.int64]  # shape (topics, 3)
    row: NDArray[np.uint32]


@dataclass(frozen=True, eq=False)
class RecordTable:
    """Records as columns of equal length.

    columns: a dictionary from the name of each column to its values. The columns `kind`, `where`, `what`, `text` and
        `field` contain indices into the strings of `names`.
    names: a dictionary from the name of each column of strings to its strings.
    per_second: the number of ticks per second; None if unknown.
    end: the last tick of the run; for a capture, its length in positions.
    modules: a dictionary from each unit of the run to its modules; empty for a capture.
    known_topics: the result of `topics` if the topics are already known, otherwise None.
    clocks: a dictionary from each unit to pairs of a tick and the SYSCLKOUT in Hz from this tick on; empty if the
        recording states no clocks.
    """

    columns: dict[str, NDArray[Any]]
    names: dict[str, tuple[str, ...]]
    per_second: Fraction | None
    end: int
    modules: dict[str, tuple[str, ...]] = field(default_factory=dict)
    known_topics: Topics | None = None
    clocks: Clocks = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.columns["tick"])

    def topics(self) -> Topics:
        """Return the topics that occur in the rows."""
        if self.known_topics is not None:
            return self.known_topics
        three = np.stack([self.columns[name].astype(np.int64) for name in TOPIC], axis=1)
        of, row = np.unique(three, axis=0, return_inverse=True)
        return Topics(of, row.reshape(-1).astype(np.uint32))

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
        """Return the numbers of the rows with this kind, where and what, in order. None matches all rows."""
        wanted = np.ones(len(self), bool)
        for column, name in (("kind", kind.value if kind else None), ("where", where), ("what", what)):
            if name is not None:
                places = [place for place, known in enumerate(self.names[column]) if known == name]
                if len(places) == 1:
                    wanted &= self.columns[column] == places[0]
                else:
                    wanted &= np.isin(self.columns[column], places)
        return np.flatnonzero(wanted)

    def texts(self, column: str, rows: NDArray[np.int64] | None = None) -> list[str]:
        """Return the strings of some rows in a column, which is `kind`, `where`, `what`, `text` or `field`.

        rows: the numbers of the rows; None for all.
        """
        places = self.columns[column] if rows is None else self.columns[column][rows]
        names = self.names[column]
        return [names[place] for place in places.tolist()]

    def records(self, rows: NDArray[np.int64] | None = None) -> Iterator[Record]:
        """Yield some rows as records. Columns are converted in pieces, so that a long run is not copied as a whole.

        rows: the numbers of the rows; None for all.
        """
        chosen = np.arange(len(self)) if rows is None else rows
        where, what, text, fields = (self.names[name] for name in ("where", "what", "text", "field"))
        kinds = [Kind(name) for name in self.names["kind"]]
        for begin in range(0, len(chosen), 1 << 16):
            piece = chosen[begin : begin + (1 << 16)]
            for n, t, k, w, a, v, x, c, f in zip(
                *(self.columns[name][piece].tolist() for name in COLUMNS), strict=True
            ):
                yield Record(n, t, kinds[k], where[w], what[a], v, text[x], c, fields[f])


@final
class _Strings:
    """`text` and `field` of the last record of a topic with an even or with an odd value, and their indices.

    The next such record usually has the same string objects, so that no search for the indices is needed.
    """

    __slots__ = ("field", "field_place", "text", "text_place")

    text: Text | None
    field: Text | None
    text_place: UInt32
    field_place: UInt32


class Columns(RecordSink):
    """Collector of records. The method `table` returns the collected records as arrays."""

    _tags: Buffer[UInt32]
    _text_places: Buffer[UInt32]
    _field_places: Buffer[UInt32]
    _numbers: Buffer[int]
    _ticks: Buffer[int]
    _values: Buffer[int]
    _causes: Buffer[int]

    def __init__(self) -> None:
        self._topics: dict[tuple[Kind, str, str], int] = {}
        # Each topic has two entries, for even and for odd values, because the text of an edge depends on its level.
        self._last: list[_Strings] = []
        self.clear()

    def clear(self) -> None:
        """Discard the collected records."""
        self._full: list[Block] = []
        self._texts: dict[str, int] = {}
        self._fields: dict[str, int] = {}
        last: _Strings
        for last in self._last:
            last.text = last.field = None
        self._begin()

    def _begin(self) -> None:
        """Begin an empty block."""
        self._filled = 0
        self._block = {name: column[:] for name, column in EMPTY.items()}
        block = self._block
        self._tags, self._text_places, self._field_places = block["topic"], block["text"], block["field"]
        self._numbers, self._ticks = block["number"], block["tick"]
        self._values, self._causes = block["value"], block["cause"]

    def _column(self, name: str, dtype: str) -> NDArray[Any]:
        """Return a column of all records so far."""
        blocks = [np.frombuffer(block[name], dtype) for block in self._full]
        return np.concatenate([*blocks, np.frombuffer(self._block[name], dtype)[: self._filled]])

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        tag = self._topics.setdefault((kind, where, what), len(self._topics))
        while len(self._last) < 2 * len(self._topics):
            last = _Strings()
            last.text = last.field = None
            self._last.append(last)
        return tag

    def keep(self, tag: int, number: int, tick: int, value: int, text: Text, cause: int, field: Text) -> None:
        row = self._filled
        self._tags[row] = tag
        self._numbers[row] = number
        self._ticks[row] = tick
        self._values[row] = value
        self._causes[row] = cause
        last: _Strings = self._last[2 * tag + (value & 1)]
        if text is not last.text:
            last.text, last.text_place = text, self._place(self._texts, text)
        self._text_places[row] = last.text_place
        if field is not last.field:
            last.field, last.field_place = field, self._place(self._fields, field)
        self._field_places[row] = last.field_place
        self._filled = row = row + 1
        if row == BLOCK:
            self._full.append(self._block)
            self._begin()

    def _place(self, places: dict[str, int], text: Text) -> int:
        """Return the index of a string. A new string is added to `places`."""
        return places.setdefault(text, len(places))

    def add(self, record: Record) -> None:
        """Add a `Record` object. `keep` adds the same data without such an object."""
        number, tick, kind, where, what, value, text, cause, field = record
        self.keep(self.tag_of(kind, where, what), number, tick, value, text, cause, field)

    def __len__(self) -> int:
        return BLOCK * len(self._full) + self._filled

    def table(self, per_second: Fraction, end: int, modules: dict[str, tuple[str, ...]], clocks: Clocks) -> RecordTable:
        """Return the collected records. The arguments are the fields of `RecordTable` with these names."""
        names, topics = self._topics_in_use()
        columns: dict[str, NDArray[Any]] = {
            name: topics.indices[:, place].astype(COLUMNS[name][1])[topics.row] for place, name in enumerate(TOPIC)
        }
        columns |= {name: self._column(name, COLUMNS[name][1]) for name in COLLECTED if name != "topic"}
        names |= {"text": tuple(self._texts), "field": tuple(self._fields)}
        in_order = {name: columns[name] for name in COLUMNS}
        return RecordTable(in_order, names, per_second, end, modules, topics, clocks)

    def _topics_in_use(self) -> tuple[dict[str, tuple[str, ...]], Topics]:
        """Return the strings of the columns kind, where and what, and the topics of the collected records.

        Topics are in the order in which the records first use them.
        """
        tags = self._column("topic", "<u4")
        wheres: dict[str, int] = {}
        whats: dict[str, int] = {}
        known = list(self._topics)
        first = np.full(len(known), len(tags))
        # Assignment is from the last record to the first, so that the index of each topic's first record remains.
        first[tags[::-1]] = np.arange(len(tags))[::-1]
        used = np.flatnonzero(first < len(tags))
        used = used[np.argsort(first[used])]
        of = [
            (NUMBER_OF[kind], wheres.setdefault(where, len(wheres)), whats.setdefault(what, len(whats)))
            for kind, where, what in (known[tag] for tag in used.tolist())
        ]
        renumbered = np.zeros(len(known), np.uint32)
        renumbered[used] = np.arange(len(used))
        names = {"kind": tuple(kind.value for kind in KINDS), "where": tuple(wheres), "what": tuple(whats)}
        return names, Topics(np.array(of, np.int64).reshape(-1, 3), renumbered[tags])
