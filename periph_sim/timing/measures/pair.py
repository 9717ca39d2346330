"""Measures of pairs of events: time from each first event to its second, and number of third events in between.

    A1   A2        B1   B2
    |----+---------|    |      in order: n-th with n-th
         |--------------|
    |--------------|           next: each with the next second one, which may end several
         |---------|
         |---------|           last: only the last one before a second one

If no pairing is given and a second A comes before the first one's B, it is not known which events belong together:
nothing is proven then.
"""

# core: compiled

from __future__ import annotations

from collections import deque

from ...core.state import State
from ...core.time import NO_TIME
from ..language.events import Group, Matcher
from .event_pairing import NO_CLAUSES, Clauses, EventMeasure
from .groups import Groups
from .measured_scene import MeasuredScene

PAIRINGS = ("in order", "next", "last")
FIRST, SECOND, START, STOP = range(4)  # places of a pair's events


class Between(EventMeasure):
    """Time from each event to the event of another kind that belongs to it, or number of third events in between.

    counted: the third event: after the first one, up to the second.
    pairing: one of PAIRINGS; empty if one A at most may wait.
    again: the ticks of two A that waited then; None if there were none.
    group: pairs lie in one transfer or round: a transfer lasts from its START to the next one's, so that what firmware
    does about a STOP belongs to it.
    """

    STATE = State("_rule _stopped _begun _paired _counted _counted_at", ticks="_begun_at _waiting")

    def __init__(
        self,
        begin: Matcher,
        end: Matcher,
        pairing: str,
        group: Group | None = None,
        clauses: Clauses = NO_CLAUSES,
        counted: Matcher | None = None,
    ) -> None:
        inside = () if group is None else (group.begin, group.end)
        extra = () if counted is None else (counted,)
        super().__init__(begin, end, *inside, *extra, order=_order(len(inside), len(extra)), clauses=clauses)
        self.unit: str = "count" if extra else "time"
        self._is_count = bool(extra)
        self.pairing = pairing
        self._extra = FIRST + 2 + len(inside)
        self._rule: Groups | None = None if group is None else Groups(group, 0)
        self._rule_text: str = "" if group is None else f" in the same {group.name}"
        self._stopped = True
        self._unsaid: bool = not pairing
        self._only_last: bool = pairing == "last"
        self._in_order: bool = pairing == "in order"
        self._waiting: deque[int] = deque()  # the ticks of first events that wait
        self._counted_at: deque[int] = deque()  # of each, the number of events in between that came before it
        self.again: tuple[int, int] | None = None
        self._begun = self._paired = False  # in the group under way
        if group is not None:
            self.asked = f"{group.name}s with {begin.text!r}"
            self.occasions = 0
            self._has_measured = True
            self.looks_back = f"this {group.name}"
        self._counted = 0  # events in between, since something waits
        self._begun_at = self._now = NO_TIME
        self._began_at, self._per_second = 0, 1

    def listen(self, scene: MeasuredScene) -> None:
        super().listen(scene)
        self._began_at = scene.began()
        self._per_second = scene.ticks_per_second()
        if self._rule is not None:
            self._rule.listen(scene)

    def happened(self, place: int, tick: int, value: int) -> None:
        if place >= self._extra:
            self._counted += 1
        elif place == START:
            self._started(tick)
        elif place == STOP:
            self._stopped = True
        elif place == SECOND:
            self._second(tick)
        elif self._rule is None or self._rule.inside:
            self._first(tick)

    def _started(self, tick: int) -> None:
        assert self._rule is not None
        self._stopped = False
        if self._rule.begins(tick, True, False):
            self._group_over()
            self._forget()

    def _group_over(self) -> None:
        if self._begun:
            self.occasion(self._begun_at)
            self.measured_at(self._begun_at, int(self._paired))
        self._begun = self._paired = False

    def _first(self, tick: int) -> None:
        if self._rule is not None and not self._begun:
            self._begun, self._begun_at = True, tick
        if self._waiting:
            if self._only_last:
                self._forget()
            elif self._unsaid and self.again is None:
                self.again = (self._waiting[0], tick)
        if not self._waiting:
            self._counted = 0
        self._waiting.append(tick)
        self._counted_at.append(self._counted)

    def _second(self, tick: int) -> None:
        if not self._waiting:
            return
        self._paired = self._rule is not None
        while self._waiting:
            at: int = self._waiting.popleft()
            counted: int = self._counted_at.popleft()
            self.take(self._counted - counted if self._is_count else tick - at, at)
            if self._in_order:
                return

    def _forget(self) -> None:
        """Remove all events that wait."""
        self._waiting.clear()
        self._counted_at.clear()

    def finish(self, now: int) -> None:
        super().finish(now)
        self._now = now
        if self._rule is not None and (self._stopped or self._paired):
            self._group_over()

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        if self._rule is not None and self._stopped:  # in a transfer or round, not every first has a second
            return []
        if self._is_count:
            return [(self._counted - counted, at) for at, counted in zip(self._waiting, self._counted_at, strict=True)]
        return [(self._now - at, at) for at in self._waiting]

    def unfinished_text(self) -> str:
        return f"{self.matchers[FIRST].text!r} still waited for {self.matchers[SECOND].text!r} when the run ended"

    @property
    def silent(self) -> bool:
        return not self.count or self.ungiven or self.again is not None

    def missing(self) -> str:
        first, second = (self.matchers[place].text for place in (FIRST, SECOND))
        if self.again is not None:
            one, other = (f"{(at - self._began_at) / self._per_second:.6f} s" for at in self.again)
            what = f"{first!r} came at {one} and again at {other} before {second!r}"
            return f"{what}; add after a comma which belong together: in order, next or last"
        if self.ungiven or self._clauses.said.nothing is not None:
            return EventMeasure.missing(self)
        if all(self.seen[:2]):
            return f"no {first!r} was followed by {second!r}{self._rule_text}"
        return self.unmatched([self.matchers[place] for place in (FIRST, SECOND) if not self.seen[place]])


def _order(inside: int, extra: int) -> tuple[int, ...]:
    """Return the order of a record's events: START, the counted event, the pair's end, its begin, STOP."""
    starts, stops = ((START,), (STOP,)) if inside else ((), ())
    counted = range(2 + inside, 2 + inside + extra)
    return (*starts, *counted, SECOND, FIRST, *stops)
