"""Measures of pairs of events: the time from the first event to the second, or the number of third events between.

    A1   A2        B1   B2
    |----+---------|    |      in order: the n-th A with the n-th B
         |--------------|
    |--------------|           next: each A with the next B, which may end several pairs
         |---------|
         |---------|           last: each B with only the last A since the previous B; B2 has no such A

If none of these rules is given and another A comes before the B of the first A, it is not known which events belong
together, so the budget is not judged. With the rule `same unit`, only events of the same unit are paired. A third event
is an event of another kind that is counted between A and B. A period is the time from an event to the next event of the
same kind.
"""

# core: compiled

from __future__ import annotations

from collections import deque

from ...core.records import UNWANTED, Kind
from ...core.state import State
from ...core.time import NO_TIME
from ..language.matcher import Group, Matcher
from .event import NO_CLAUSES, Clauses, EventMeasure
from .groups import Groups
from .measure import MeasuredScene

FIRST, SECOND, START, STOP = range(4)  # indices of `matchers`: both events of a pair; start and end of a group


class _Waiting:
    """First events that wait for their second event, with the number of third events before each of them.

    oldest: the tick of the event that has waited longest; NO_TIME if no event waits.
    oldest_counted: the value of `counted` at the tick `oldest`.
    since, counted_at: the ticks of all other waiting events, in order, and the values of `counted` at these ticks.
    counted: the number of third events since the last time at which no event waited.
    """

    STATE = State("oldest_counted counted counted_at", ticks="oldest since", made=True)
    __slots__ = ("counted", "counted_at", "oldest", "oldest_counted", "since")

    def __init__(self) -> None:
        self.oldest = NO_TIME
        self.oldest_counted = 0
        self.since: deque[int] = deque()
        self.counted_at: deque[int] = deque()
        self.counted = 0

    def add(self, tick: int) -> None:
        """Add an event that waits."""
        if self.oldest == NO_TIME:
            self.oldest, self.oldest_counted, self.counted = tick, 0, 0
        else:
            self.since.append(tick)
            self.counted_at.append(self.counted)

    def take_oldest(self) -> None:
        """Remove the event that has waited longest."""
        self.oldest = NO_TIME
        if self.since:
            self.oldest, self.oldest_counted = self.since.popleft(), self.counted_at.popleft()

    def all(self) -> list[tuple[int, int]]:
        """Return (tick, number of third events counted before it) of each waiting event."""
        if self.oldest == NO_TIME:
            return []
        return [(self.oldest, self.oldest_counted), *zip(self.since, self.counted_at, strict=True)]

    def clear(self) -> None:
        """Remove all first events that wait for their second event."""
        self.oldest = NO_TIME
        self.since.clear()
        self.counted_at.clear()


class Between(EventMeasure):
    """Time from each first event to the second event that belongs to it, or number of third events between the two.

    counted: the third event, which is counted between the two events of a pair; None to measure the time.
    pairing: "in order", "next" or "last"; empty if only one first event may wait at a time.
    by_unit: True if both events of a pair must be of the same unit.
    again: without a pairing, the ticks of two first events that waited at the same time; None if there were none.
    group: the transfer or round that must contain both events of a pair; None if they may be anywhere. A transfer lasts
        from its START to the START of the next transfer, so that it contains the firmware's reaction to its STOP.
    """

    STATE = State("_rule _stopped _begun _paired _of_unit", ticks="_begun_at")

    def __init__(
        self,
        begin: Matcher,
        end: Matcher,
        pairing: str,
        group: Group | None = None,
        clauses: Clauses = NO_CLAUSES,
        counted: Matcher | None = None,
        by_unit: bool = False,
    ) -> None:
        inside = () if group is None else (group.begin, group.end)
        extra = () if counted is None else (counted,)
        starts, stops = ((START,), (STOP,)) if inside else ((), ())
        order = (*starts, *range(2 + len(inside), 2 + len(inside) + len(extra)), SECOND, FIRST, *stops)
        super().__init__(begin, end, *inside, *extra, order=order, clauses=clauses)
        self.unit = "count" if extra else "time"
        self._is_count = bool(extra)
        self.pairing = pairing
        self._extra = FIRST + 2 + len(inside)
        self._rule: Groups | None = None if group is None else Groups(group, 0)
        self._rule_text: str = "" if group is None else f" in the same {group.name}"
        self._stopped = True
        self._unsaid: bool = not pairing
        self._only_last: bool = pairing == "last"
        self._in_order: bool = pairing == "in order"
        self._waiting = _Waiting()  # the waiting first events; with `by_unit`, those of the present record's unit
        self._of_unit: dict[str, _Waiting] = {} if by_unit else {"": self._waiting}
        self._by_unit = by_unit
        self._of_tag: list[_Waiting] = []
        self.again: tuple[int, int] | None = None
        # `_begun` is True if the present group contains a first event, and `_paired` if it contains a pair.
        self._begun = self._paired = False
        if group is not None:
            self.asked = f"{group.name}s with {begin.text!r}"
            self.occasions = 0
            self._has_measured = True
            self.looks_back = f"this {group.name}"
        self._begun_at = NO_TIME
        self._began_at, self._per_second = 0, 1

    def listen(self, scene: MeasuredScene) -> None:
        super().listen(scene)
        self._began_at = scene.began
        self._per_second = scene.ticks_per_second
        if self._rule is not None:
            self._rule.listen(scene)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        tag: int = EventMeasure.tag_of(self, kind, where, what)
        if self._by_unit and tag != UNWANTED:
            self._of_tag.append(self._of_unit.setdefault(where.partition(".")[0], _Waiting()))
        return tag

    def on_record(self, tag: int, tick: int, value: int) -> None:
        if self._by_unit:
            self._waiting = self._of_tag[tag]
        EventMeasure.on_record(self, tag, tick, value)

    def happened(self, place: int, tick: int, value: int) -> None:
        if place >= self._extra:
            self._waiting.counted += 1
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
            self._waiting.clear()

    def _group_over(self) -> None:
        if self._begun:
            self.occasion(self._begun_at)
            self.measured_at(self._begun_at, int(self._paired))
        self._begun = self._paired = False

    def _first(self, tick: int) -> None:
        if self._rule is not None and not self._begun:
            self._begun, self._begun_at = True, tick
        waiting = self._waiting
        if waiting.oldest != NO_TIME and self._only_last:
            waiting.clear()
        elif waiting.oldest != NO_TIME and self._unsaid and self.again is None:
            self.again = (waiting.oldest, tick)
        waiting.add(tick)

    def _second(self, tick: int) -> None:
        waiting = self._waiting
        if waiting.oldest == NO_TIME:
            return
        self._paired = self._rule is not None
        while waiting.oldest != NO_TIME:
            at, counted = waiting.oldest, waiting.oldest_counted
            waiting.take_oldest()
            self.take(waiting.counted - counted if self._is_count else tick - at, at)
            if self._in_order:
                return

    def finish(self, now: int) -> None:
        super().finish(now)
        if self._rule is not None and (self._stopped or self._paired):
            self._group_over()

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        # If the run ends after a STOP, the group counts as complete, and a first event that still waits is not cut off.
        if self._rule is not None and self._stopped:
            return []
        found: list[tuple[int, int]] = []
        for waiting in self._of_unit.values():
            for at, counted in waiting.all():
                found.append((waiting.counted - counted if self._is_count else now - at, at))
        return found

    def unfinished_text(self) -> str:
        first, second = self.matchers[FIRST].text, self.matchers[SECOND].text
        return self._clauses.said.cut_off or f"{first!r} still waited for {second!r} when the run ended"

    @property
    def silent(self) -> bool:
        return not self.count or self.ungiven or self.again is not None

    def why_silent(self) -> str:
        first, second = (self.matchers[place].text for place in (FIRST, SECOND))
        if self.again is not None:
            one, other = (f"{(at - self._began_at) / self._per_second:.6f} s" for at in self.again)
            what = f"{first!r} came at {one} and again at {other} before {second!r}"
            return f"{what}; add after a comma which belong together: in order, next or last"
        if self.ungiven or self._clauses.said.nothing is not None:
            return EventMeasure.why_silent(self)
        if self.seen(FIRST) and self.seen(SECOND) and first != second:
            return f"no {first!r} was followed by {second!r}{self._rule_text}"
        return self.unmatched([self.matchers[place] for place in (FIRST, SECOND) if not self.seen(place)])
