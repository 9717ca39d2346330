"""Measures of the values, the number or the sum of the records that a row names.

value       a record whose value is taken, at its tick; or that is counted
occasion    something to measure, whether it has a value or not
measured    an occasion that was measured, for measures whose values do not show that
required    a record without which nothing is proven
unknown     a record of something that cannot be judged
under way   a value that the end of the run cuts off, at its begin
"""

# core: compiled

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from ...core.counted import counted
from ...core.records import UNWANTED, Kind, Recorder
from .measure import Counter, Measure

# What a record is to a measure, as bits of a tag; in the bits above, which of its `unknown`.
VALUE, OCCASION, MEASURED, REQUIRED, UNDER_WAY, UNKNOWN = (1 << n for n in range(6))


class Unknown(Struct, frozen=True):
    """Records of things that cannot be judged. thing, why: as in "3 reads" and "may carry other frames"."""

    record: str
    thing: str
    why: str


class Row(Struct, frozen=True):
    """A measure as a row of a table. All records are of one kind; each is named by its thing, "" for none.

    about: what it measures, for documentation. takes: "values" of records, their "number", or the "sum" of the values.
    asked: occasions, as a plural. nothing: why nothing was measured. unproven: the same where `required` did not come.
    cut_off: what `under_way` is, as a phrase. needs, unit, occurrence: as of a `Measure`.
    """

    about: str
    kind: Kind
    value: str
    takes: Literal["values", "number", "sum"] = "values"
    unit: str = "time"
    needs: str = ""
    occurrence: str = ""
    occasion: str = ""
    asked: str = ""
    measured: str = ""
    required: str = ""
    unknown: tuple[Unknown, ...] = ()
    under_way: str = ""
    nothing: str = ""
    unproven: str = ""
    cut_off: str = ""

    @property
    def series(self) -> bool:
        """True if it takes one value after the other, so that there are percentiles."""
        return self.takes == "values"

    def make(self, place: str = "") -> RecordedValues:
        """Return the measure. place: the only one whose records count; "" for any."""
        kinds = {"values": RecordedValues, "number": RecordedCount, "sum": RecordedSum}
        return kinds[self.takes](self, place)


class RecordedValues(Measure):
    """Values of records. place: the only one whose records count; "" for any."""

    row: Row
    unit: str
    needs: str
    occurrence: str
    asked: str
    _unknown_counts: list[int]
    _under_way: list[tuple[int, int]]

    def __init__(self, row: Row, place: str = "") -> None:
        self.asked = row.asked
        super().__init__()
        self.row = row
        self.unit = row.unit
        self.needs = row.needs
        self.occurrence = row.occurrence
        self.kinds = frozenset({row.kind})
        self._place = place
        self._measured = 0
        self._required_count = 0
        self._unknown_counts = [0] * len(row.unknown)
        self._under_way: list[tuple[int, int]] = []

    @property
    def measured(self) -> int:
        return self._measured if self.row.measured else self.count

    @property
    def silent(self) -> bool:
        return not self.count or (bool(self.row.required) and not self._required_count)

    def missing(self) -> str:
        row = self.row
        return row.unproven if row.required and not self._required_count else row.nothing

    def subscribe(self, recorder: Recorder) -> None:
        row = self.row
        unknown = [one.record for one in row.unknown]
        named = (row.value, row.occasion, row.measured, row.required, row.under_way, *unknown)
        recorder.subscribe(self.kinds, self, None, {(row.kind, what) for what in named if what})

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        row = self.row
        tag = REQUIRED if what == row.required else 0
        if self._place in ("", where):
            roles = (row.value, VALUE), (row.occasion, OCCASION), (row.measured, MEASURED), (row.under_way, UNDER_WAY)
            tag |= sum([role for name, role in roles if name == what])
            tag |= sum([UNKNOWN << n for n, one in enumerate(row.unknown) if one.record == what])
        return tag or UNWANTED

    def on_record(self, tag: int, tick: int, value: int) -> None:
        if tag & OCCASION:
            self.occasion_of(value, tick)
        if tag & MEASURED and tick >= self.not_before:
            self._measured += 1
        if tag & VALUE:
            self.value(value, tick)
        if tag & REQUIRED:
            self._required_count += 1
        if tag & UNDER_WAY:
            self._under_way.append((value, tick))
        if tag >= UNKNOWN:
            self._count_unknown(tag, value)

    def value(self, value: int, tick: int) -> None:
        """Take the value of a record."""
        self.take(value, tick)

    def occasion_of(self, value: int, tick: int) -> None:
        """Count an occasion."""
        self.occasion(tick)

    def unknown_of(self, value: int) -> int:
        """Return the number of unknown things that a record represents."""
        return 1

    def _count_unknown(self, tag: int, value: int) -> None:
        for place in range(len(self._unknown_counts)):
            if tag & UNKNOWN << place:
                self._unknown_counts[place] += self.unknown_of(value)

    def finish(self, now: int) -> None:
        for one, count in zip(self.row.unknown, self._unknown_counts, strict=True):
            if count and not self.not_judged:
                self.not_judged = f"{counted(count, one.thing)} {one.why}"

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        return self._under_way

    def unfinished_text(self) -> str:
        return self.row.cut_off


class RecordedSum(RecordedValues):
    """Sum of the values of records, which are numbers of things, as those of its other records are.

    count is the sum of its `measured` records: a run in which nothing was compared proves nothing.
    """

    series = False

    @property
    def measured(self) -> int:
        return self.count

    def on_record(self, tag: int, tick: int, value: int) -> None:
        if tag & MEASURED:
            self.count += value
        else:
            RecordedValues.on_record(self, tag, tick, value)

    def value(self, value: int, tick: int) -> None:
        if not self.worst:
            self.worst_at = self.least_at = tick
        self.worst = self.least = self.worst + value

    def occasion_of(self, value: int, tick: int) -> None:
        self.occasion(tick, value)

    def unknown_of(self, value: int) -> int:
        return value


class RecordedCount(RecordedValues, Counter):  # core: python
    """Number of records. Zero is a value, unless the row requires a record that did not come."""

    @property
    def silent(self) -> bool:
        return bool(self.row.required) and not self._required_count

    def value(self, value: int, tick: int) -> None:
        self.one_more(tick)
