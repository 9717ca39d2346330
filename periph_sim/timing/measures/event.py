"""Measures of named events.

Of two events at one tick the one recorded first is the earlier one.
"""

from __future__ import annotations

from ...core.records import UNWANTED, Kind, Recorder
from ...core.state import State
from ...core.time import NO_TIME
from ..language.events import Matcher
from .event_pairing import EventMeasure
from .measure import Measure
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
        (self._unit,) = entered.where or ("",)
        self._asked_at = NO_TIME
        self._inside = False

    def subscribe(self, recorder: Recorder) -> None:
        recorder.subscribe(self.kinds, self, self.subjects)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        if kind is not Kind.ACCESS:
            return super().tag_of(kind, where, what)
        return OF_UNIT if where == self._unit else UNWANTED

    def on_record(self, tag: int, tick: int, value: int) -> None:
        if tag != OF_UNIT:
            super().on_record(tag, tick, value)
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
        self.of = of
        self.unit, self.needs, self.kinds = of.unit, of.needs, of.kinds
        self._before: int | None = None
        of.tap = self._took

    def listen(self, scene: MeasuredScene) -> None:
        self.of.listen(scene)

    def subscribe(self, recorder: Recorder) -> None:
        self.of.subscribe(recorder)

    def finish(self, now: int) -> None:
        self.of.finish(now)
        self.occasions = None if self.of.occasions is None else max(0, self.of.occasions - 1)

    def _took(self, value: int, at: int) -> None:
        before, self._before = self._before, value
        if before is not None:
            self.take(abs(value - before), at)

    def missing(self) -> str:
        return self.of.missing() if self.of.silent else "there was one value, which has none before it"
