"""Measures of the time in a state or a span: each time, or the sum of all.

    wire SCL low   ──┐______┌──────┐___┌──     each: 6 and 3      time in: 9

A state that holds as the run begins belongs to the sum. It is no "each", since its
begin is not known, unless it lasts to the end of the run.
"""

# core: compiled

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from ...core.records import Kind
from ...core.state import State
from ...core.time import NO_TIME
from ..language.events import EVERYTHING, Matcher
from .event_pairing import EventMeasure
from .measured_scene import MeasuredScene

if TYPE_CHECKING:
    from .event_pairing import Hearing


class StateEvents(Struct, frozen=True):
    """A state by its events. enters: what begins it. leaves: what ends it, unless that is one of `enters`, too."""

    text: str
    enters: tuple[Matcher, ...]
    leaves: tuple[Matcher, ...]

    def holds(self, scene: MeasuredScene) -> bool:
        """Return True if a scene in which nothing has happened yet is in this state."""
        first = self.enters[0]
        (place, *_) = first.where or ("",)
        if first.kind is Kind.EDGE:
            return scene.level_of(place) == first.want
        if first.kind is Kind.FLAG:
            return first.mask == EVERYTHING and scene.value_of(place, first.what) == first.want
        return first.kind is Kind.BUS and first.what == "STOP"  # no START yet: the bus is free


class TimeIn(EventMeasure):
    """Each time in a state, from its begin to its end, or the sum of all; of a span, service routines included.

    each: take each time, unless its begin was not seen, since the run began in the state.
    """

    STATE = State("_whole", ticks="_since")

    def __init__(self, state: StateEvents, each: bool) -> None:
        super().__init__(*state.enters, *state.leaves)
        self.state = state
        self.series: bool = each
        self._enters = len(state.enters)  # the first ones of `matchers`
        self._since = NO_TIME
        self._whole = False  # the begin of the present time was seen

    @property
    def silent(self) -> bool:
        """True if a span was never entered: its name may be misspelled. Other states may have lasted no time at all."""
        return not self.count and (self.series or self.state.enters[0].free)

    def listen(self, scene: MeasuredScene) -> None:
        if self.state.holds(scene):
            self._begins(scene.began(), False)

    def on_record(self, tag: int, tick: int, value: int) -> None:
        """Follow the state. A record that both enters and leaves it enters it. Its events belong to no group."""
        if self.spans is not None and self._names[tag]:
            self.spans.add(self._names[tag])
        plan = self._plans[tag]
        enters = leaves = False
        one: Hearing
        for one in plan:
            if one.test is not None and one.test.fits(value):
                if one.place < self._enters:
                    enters = True
                else:
                    leaves = True
        if enters:
            if self._since == NO_TIME:
                self._begins(tick, True)
        elif leaves and self._since != NO_TIME:
            self._ends(tick)

    def _begins(self, at: int, seen: bool) -> None:
        self._since, self._whole = at, seen
        if not self.series:
            if not self.count:
                self.worst_at = self.least_at = at
            self.count += 1

    def _ends(self, at: int) -> None:
        """End a time in the state: it was left, or the run ended in it."""
        since, self._since = self._since, NO_TIME
        if not self.series:
            self.worst = self.least = self.worst + at - since
        elif self._whole:
            self.take(at - since, since)

    def finish(self, now: int) -> None:
        if self._since != NO_TIME and not self.series:
            self._ends(now)

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        return [] if self._since == NO_TIME else [(now - self._since, self._since)]

    def unfinished_text(self) -> str:
        return f"{self.state.text!r} still lasted when the run ended"

    def why_silent(self) -> str:
        if self.state.enters[0].free:
            return self.unmatched(list(self.state.enters[:1]))
        return f"{self.state.text!r} was never entered and left"
