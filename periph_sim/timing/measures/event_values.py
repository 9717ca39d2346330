"""Measures of events one by one: how many there were, the value of each, or the sum of their values."""

# core: compiled

from __future__ import annotations

from ..language.events import Matcher
from .event_pairing import NO_CLAUSES, Clauses, EventMeasure, span_hint
from .measure import READ


class EventCount(EventMeasure):
    """Number of occurrences of an event. Zero is a value, except for free-text names, which may be misspelled.

    worst is how many there were, worst_at when the first one was. Verdicts show at how many of its occasions it was
    measured, where it has any.
    """

    unit = "count"
    series = False

    def __init__(self, event: Matcher, clauses: Clauses = NO_CLAUSES) -> None:
        super().__init__(event, clauses=clauses)
        self.event = event

    @property
    def silent(self) -> bool:
        return self.ungiven or (self.event.free and not self.count)

    @property
    def counted(self) -> int:
        return self.count if self.occasions is None else self.measured

    def happened(self, place: int, tick: int, value: int) -> None:
        if not self.count:
            self.worst_at = self.least_at = tick
        self.count += 1
        self.worst = self.least = self.count

    def missing(self) -> str:
        if self.ungiven:
            return super().missing()
        return f"no event matched {self.event.text!r}; {span_hint(self.event.what, self.spans or set())}"


class ValueOf(EventMeasure):
    """The value of each event: the words in a FIFO, the age of what is read, a register field whenever it changed."""

    def __init__(self, event: Matcher, clauses: Clauses = NO_CLAUSES) -> None:
        super().__init__(event, clauses=clauses)
        thing = event.thing
        self.unit: str = "value" if thing is None else thing.unit
        self.occurrence: str = READ if thing is not None and thing.by_read else ""

    def happened(self, place: int, tick: int, value: int) -> None:
        self.take(value, tick)


class SumOf(EventMeasure):
    """Sum of the values of events, which are numbers of things, as those of its clauses are.

    count is the sum of what was measured: a run in which nothing was compared proves nothing.
    """

    series = False

    def __init__(self, event: Matcher, clauses: Clauses = NO_CLAUSES) -> None:
        super().__init__(event, clauses=clauses)
        self.weighs = True
        unit = "value" if event.thing is None else event.thing.unit
        self.unit: str = "count" if unit == "value" else unit

    def happened(self, place: int, tick: int, value: int) -> None:
        if not self.worst:
            self.worst_at = self.least_at = tick
        self.worst = self.least = self.worst + value
        if not self._has_measured:
            self.count += 1

    def measured_at(self, tick: int, number: int) -> None:
        self.count += number

    @property
    def measured(self) -> int:
        return self.count
