"""Comparison of two captures by the events on the bus.

    Capture A, Capture B --decode--> events --pair--> entries --> TraceDiff

Events are paired in order by their kind and content. Times only decide which of several equal events are paired.
Then the times of each pair are compared.
If an interrupt came 3 us later in B, all events after it are 3 us later. Only the first of them is a change point.

Times are whole ticks of a clock whose rate is a multiple of the rates of both captures. The lateness of an event is its
time in B minus its time in A, minus the same difference for the first event that is in both captures. The subtraction
is needed because the clocks of A and B started at different moments.

A change point is an event whose lateness differs by more than the tolerance from the lateness at the last change point
(from 0 for the first change point). The cause of the change lies just before this event. Later events that are equally
late are no change points.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import lcm
from statistics import median_low
from typing import NamedTuple

from ..capture.capture import Capture
from ..decode.uart import Line
from .matching import Event, Group, Pair, Pairing, i2c_groups, uart_groups

__all__ = ["ChangePoint", "Entry", "TraceDiff", "diff_i2c", "diff_uart"]

I2cLines = tuple[str | int, str | int]


def diff_i2c(
    a: Capture,
    b: Capture,
    lines: I2cLines = ("SCL", "SDA"),
    lines_b: I2cLines | None = None,
    tolerance: Fraction | None = None,
) -> TraceDiff:
    """Return the differences of two I2C captures.

    lines: the names of SCL and SDA in A, and also in B unless `lines_b` is given.
    tolerance: the allowed lateness or earliness in seconds, by default one position of A plus one position of B.

    Raise LookupError if a channel is missing or ambiguous, and ValueError if a capture has no rate.
    """
    return _diff(a, b, i2c_groups(a, *lines), i2c_groups(b, *(lines_b or lines)), tolerance)


def diff_uart(
    a: Capture,
    b: Capture,
    line: Line,
    channel: str | int = "RX",
    channel_b: str | int | None = None,
    tolerance: Fraction | None = None,
) -> TraceDiff:
    """Return the differences of two UART lines.

    line: the rate and the frame format of both lines.
    channel: the name of the line in A, and also in B unless `channel_b` is given.
    tolerance: the allowed lateness or earliness in seconds, by default one position of A plus one position of B.

    Raise LookupError if a channel is missing or ambiguous, and ValueError if a capture has no rate, or fewer than two
    positions per bit.
    """
    other = channel if channel_b is None else channel_b
    return _diff(a, b, uart_groups(a, channel, line), uart_groups(b, other, line), tolerance)


def _diff(a: Capture, b: Capture, of_a: list[Group], of_b: list[Group], tolerance: Fraction | None) -> TraceDiff:
    rates = a.rate_for("differences in time need"), b.rate_for("differences in time need")
    return compared(Pairing(rates).pairs(of_a, of_b), (str(a.path), str(b.path)), rates, tolerance)


class Entry(NamedTuple):
    """A pair of an event in A and an event in B, one of which may be missing.

    number: the index of the entry among all entries.
    a, b: the event in each capture; None if it is missing there.
    later: the lateness in ticks, which is negative if B's event is early; None if an event is missing.
    """

    number: int
    a: Event | None
    b: Event | None
    later: int | None

    @property
    def changed(self) -> bool:
        return self.a is not None and self.b is not None and self.a.word != self.b.word

    @property
    def event(self) -> Event:
        """The event in A or, if A has no such event, the event in B."""
        event = self.a or self.b
        assert event is not None, "an entry has at least one event"
        return event


class ChangePoint(NamedTuple):
    """An entry at which the lateness changes.

    before: the last entry before `entry` whose event is in both captures.
    step: the lateness of `entry` minus the lateness at the last change point, in ticks.
    """

    entry: Entry
    before: Entry
    step: int


@dataclass(frozen=True)
class KindSummary:
    """Summary of the events of one kind.

    both: the number of events in both captures.
    changed: the number of events in both captures whose content differs.
    missing: the number of events that are only in A.
    inserted: the number of events that are only in B.
    median: the median lateness in ticks; None if no event is in both captures.
    worst: the entry whose lateness is furthest from 0; None if no event is in both captures.
    """

    kind: str
    both: int
    changed: int
    missing: int
    inserted: int
    median: int | None
    worst: Entry | None


@dataclass(frozen=True)
class TraceDiff:
    """The result of comparing two captures.

    ticks: the number of ticks per second.
    offset: for the first event that is in both captures, its time in B minus its time in A, in ticks; None if no event
        is in both captures.
    tolerance: the greatest lateness or earliness, in seconds, that does not count as a difference.
    """

    name_a: str
    name_b: str
    rate_a: Fraction
    rate_b: Fraction
    ticks: int
    offset: int | None
    tolerance: Fraction
    entries: tuple[Entry, ...]

    @cached_property
    def missing(self) -> list[Entry]:
        """Entries whose event is only in A."""
        return [entry for entry in self.entries if entry.b is None]

    @cached_property
    def inserted(self) -> list[Entry]:
        """Entries whose event is only in B."""
        return [entry for entry in self.entries if entry.a is None]

    @cached_property
    def changed(self) -> list[Entry]:
        return [entry for entry in self.entries if entry.changed]

    @cached_property
    def late(self) -> list[Entry]:
        """Entries whose event is late or early in B by more than the tolerance."""
        return [entry for entry in self.entries if entry.later is not None and self.beyond(entry.later)]

    @cached_property
    def change_points(self) -> list[ChangePoint]:
        """Entries at which the lateness changes by more than the tolerance."""
        found: list[ChangePoint] = []
        level = 0
        before: Entry | None = None
        for entry in self.entries:
            if entry.later is None:
                continue
            if before is not None and self.beyond(entry.later - level):
                found.append(ChangePoint(entry, before, entry.later - level))
                level = entry.later
            before = entry
        return found

    @property
    def equal(self) -> bool:
        """True if both captures have the same events at the same times, within the tolerance."""
        return not (self.missing or self.inserted or self.changed or self.late)

    @cached_property
    def first(self) -> Entry | None:
        """The first entry that is missing, inserted, changed, or late or early by more than the tolerance, or None."""
        return next((entry for entry in self.entries if self.differs(entry)), None)

    @cached_property
    def kinds(self) -> list[KindSummary]:
        """One summary for each kind of event, in order of first appearance."""
        sorted_out: dict[str, list[Entry]] = {}
        for entry in self.entries:
            sorted_out.setdefault(entry.event.kind, []).append(entry)
        return [_summary(kind, entries) for kind, entries in sorted_out.items()]

    @cached_property
    def _most(self) -> int:
        """The tolerance in whole ticks."""
        return int(self.tolerance * self.ticks)

    def beyond(self, ticks: int) -> bool:
        return abs(ticks) > self._most

    def differs(self, entry: Entry) -> bool:
        return entry.later is None or entry.changed or self.beyond(entry.later)

    def seconds(self, ticks: int) -> Fraction:
        return Fraction(ticks, self.ticks)

    def time_a(self, entry: Entry) -> Fraction | None:
        """Return the time of A's event, in seconds of A's own clock."""
        return None if entry.a is None else entry.a.at / self.rate_a

    def time_b(self, entry: Entry) -> Fraction | None:
        """Return the time of B's event, in seconds of B's own clock."""
        return None if entry.b is None else entry.b.at / self.rate_b


def compared(
    paired: Iterable[Pair],
    names: tuple[str, str],
    rates: tuple[Fraction, Fraction],
    tolerance: Fraction | None = None,
) -> TraceDiff:
    """Compare pairs of events.

    names: the names of captures A and B.
    rates: the numbers of positions per second of A and B.
    tolerance: the allowed lateness or earliness in seconds, by default one position of A plus one position of B.
        Sampling alone can cause this difference.
    """
    rate_a, rate_b = rates
    ticks = lcm(rate_a.numerator, rate_b.numerator)
    per_a, per_b = int(ticks / rate_a), int(ticks / rate_b)  # whole numbers, since `ticks` is a multiple of both rates
    entries: list[Entry] = []
    offset: int | None = None
    for number, (a, b) in enumerate(paired):
        later: int | None = None
        if a is not None and b is not None:
            later = b.at * per_b - a.at * per_a
            offset = later if offset is None else offset
            later -= offset
        entries.append(Entry(number, a, b, later))
    allowed = 1 / rate_a + 1 / rate_b if tolerance is None else tolerance
    return TraceDiff(*names, rate_a, rate_b, ticks, offset, allowed, tuple(entries))


def _summary(kind: str, entries: list[Entry]) -> KindSummary:
    both = [entry for entry in entries if entry.later is not None]
    lateness = [entry.later for entry in both if entry.later is not None]
    return KindSummary(
        kind,
        len(both),
        sum(entry.changed for entry in entries),
        sum(entry.b is None for entry in entries),
        sum(entry.a is None for entry in entries),
        median_low(lateness) if lateness else None,
        max(both, key=lambda entry: abs(entry.later or 0)) if both else None,
    )
