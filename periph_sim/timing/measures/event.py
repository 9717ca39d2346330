"""Measures of one named event: its number, values, distances and what there was at it.

Of two events at one tick the one recorded first is the earlier one.
"""

# core: compiled

from __future__ import annotations

from ...core.records import UNWANTED, Kind, Recorder
from ...core.state import State
from ...core.time import NO_TIME
from ..language.events import Matcher
from .event_pairing import NO_CLAUSES, Clauses, EventMeasure, span_hint
from .measure import READ, Measure
from .measured_scene import MeasuredScene

OF_UNIT = 1 << 30  # the tag of an access of the unit; those of its events are below


class Period(EventMeasure):
    """Time from an event to the next of its kind."""

    STATE = State(ticks="_last")

    def __init__(self, event: Matcher) -> None:
        super().__init__(event)
        self.looks_back = "the occurrence before"
        self._last = NO_TIME

    def happened(self, place: int, tick: int, value: int) -> None:
        last, self._last = self._last, tick
        if last != NO_TIME:
            self.take(tick - last, last)

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        return [] if self._last == NO_TIME else [(now - self._last, self._last)]

    def unfinished_text(self) -> str:
        return f"{self.matchers[0].text!r} did not come again before the run ended"


class LevelAt(EventMeasure):
    """Value of a register field whenever an event happens."""

    STATE = State("_value")
    unit = "value"

    def __init__(self, event: Matcher, change: Matcher) -> None:
        super().__init__(event, change, order=(1, 0))
        self._value = 0

    def listen(self, scene: MeasuredScene) -> None:
        super().listen(scene)
        (place,) = self.matchers[1].where or ("",)
        self._value = scene.value_of(place, self.matchers[1].what)

    def happened(self, place: int, tick: int, value: int) -> None:
        if place:
            self._value = value
        else:
            self.take(self._value, tick)

    def missing(self) -> str:
        return self.unmatched(list(self.matchers[:1]))


class ToFirstAccess(EventMeasure):
    """Time from an interrupt's request to the first access of its service routine, after the context is saved."""

    STATE = State("_inside", ticks="_asked_at")

    def __init__(self, asked: Matcher, entered: Matcher) -> None:
        super().__init__(asked, entered)
        self.kinds |= {Kind.ACCESS}
        self._unit: str = next(iter(entered.where or ("",)))
        self._asked_at = NO_TIME
        self._inside = False

    def subscribe(self, recorder: Recorder) -> None:
        recorder.subscribe(self.kinds, self, self.subjects)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        if kind is not Kind.ACCESS:
            return EventMeasure.tag_of(self, kind, where, what)
        return OF_UNIT if where == self._unit else UNWANTED

    def on_record(self, tag: int, tick: int, value: int) -> None:
        if tag != OF_UNIT:
            EventMeasure.on_record(self, tag, tick, value)
        elif self._inside:
            self._inside = False
            if self._asked_at != NO_TIME:
                self.take(tick - self._asked_at, self._asked_at)
                self._asked_at = NO_TIME

    def happened(self, place: int, tick: int, value: int) -> None:
        if place:
            self._inside = True
        else:
            self._asked_at = tick

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        return [] if self._asked_at == NO_TIME else [(now - self._asked_at, self._asked_at)]

    def unfinished_text(self) -> str:
        return f"{self.matchers[0].text!r} still waited for an access of its routine when the run ended"


class Jitter(Measure):
    """Difference between a value of another measure and the one before (cycle-to-cycle jitter)."""

    STATE = State("of _before")
    looks_back = "the occurrence before"

    def __init__(self, of: Measure) -> None:
        super().__init__()
        self.of: Measure = of
        self.unit: str = of.unit
        self.needs: str = of.needs
        self.kinds: frozenset[Kind] = of.kinds
        self._before: int | None = None
        of.tap = self._took

    def listen(self, scene: MeasuredScene) -> None:
        self.of.listen(scene)

    def subscribe(self, recorder: Recorder) -> None:
        self.of.subscribe(recorder)

    def finish(self, now: int) -> None:
        self.of.finish(now)
        self.occasions = None if self.of.occasions is None else max(0, self.of.occasions - 1)

    def _took(self, value: int, at: int) -> None:  # core: python
        before, self._before = self._before, value
        if before is not None:
            self.take(abs(value - before), at)

    def missing(self) -> str:
        return self.of.missing() if self.of.silent else "there was one value, which has none before it"


class OfEvents(EventMeasure):
    """The occurrences of an event, measured in a form of the language of budgets.

    count   how many there were: worst is their number, worst_at when the first one was. Zero is a value, except for
            free-text names, which may be misspelled. Verdicts show at how many of its occasions it was measured, where
            it has any.
    value   the value of each: the words in a FIFO, the age of what is read, a register field whenever it changed
    sum     the sum of their values, which are numbers of things, as those of its clauses are: count is the sum of what
            was measured, since a run in which nothing was compared proves nothing
    """

    def __init__(self, form: str, event: Matcher, clauses: Clauses = NO_CLAUSES) -> None:
        super().__init__(event, clauses=clauses)
        self.event = event
        self.counts: bool = form == "count"
        self.series: bool = form == "value"
        self.weighs: bool = form == "sum"
        unit = "value" if event.thing is None or self.counts else event.thing.unit
        self.unit: str = "count" if unit == "value" and not self.series else unit
        self.occurrence: str = READ if self.series and event.thing is not None and event.thing.by_read else ""

    @property
    def silent(self) -> bool:
        return self.ungiven or not (self.count or (self.counts and not self.event.free))

    @property
    def counted(self) -> int:
        return self.measured if self.counts and self.occasions is not None else self.count

    def happened(self, place: int, tick: int, value: int) -> None:
        if self.series:
            self.take(value, tick)
            return
        if not self.worst:
            self.worst_at = self.least_at = tick
        self.worst = self.least = self.worst + (value if self.weighs else 1)
        if self.counts or not self._has_measured:
            self.count += 1

    def measured_at(self, tick: int, number: int) -> None:
        if self.weighs:
            self.count += number
        else:
            EventMeasure.measured_at(self, tick, number)

    @property
    def measured(self) -> int:
        return self._measured if self._has_measured and not self.weighs else self.count

    def missing(self) -> str:
        if self.ungiven or not self.counts:
            return super().missing()
        return f"no event matched {self.event.text!r}; {span_hint(self.event.what, self.spans or set())}"
