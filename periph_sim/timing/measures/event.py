"""Measures of events that the text of a measure names: how often they happen, and with which values.

    topic  --tag_of--> tests of whether a record of this topic is an event, by its value; made once for each topic
    record --on_record--> event that counts immediately ------------------.
                   '---> "last ... of transfer": known when it is over ---+--in order--> happened(place, tick, value)
                                                                          '--> occasions, things that cannot be judged

Events are counted in the order of their records. Of two events with the same tick, the event that was recorded first
counts as the earlier event.
"""

# core: compiled

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from msgspec import Struct

from ...core.phrases import counted, did_you_mean
from ...core.records import UNWANTED, Kind, Recorder, Subjects
from ...core.state import State
from ..language.matcher import ANYTHING, Matcher
from .groups import Groups
from .measure import READ, Measure, MeasuredScene
from .registry import UNNAMED, Sentence


class _QueuedEvent:
    """An event that happened, in the queue of events to be measured.

    place: the index of the event in the measure.
    counts: 1 if the event is measured, 0 if it is ignored. WAITS while this is not known: for "last ... of
        transfer", a later event of the same transfer may take the place of this event.
    """

    STATE = State("place value counts", ticks="tick", made=True)
    __slots__ = ("counts", "place", "tick", "value")

    def __init__(self, place: int, tick: int, value: int, counts: int) -> None:
        self.place = place
        self.tick = tick
        self.value = value
        self.counts = counts


WAITS = -1
FOR_EACH, MEASURED_AT, GIVEN, UNLESS, UNFINISHED = range(5)  # the kinds of clauses, as roles of the events in them


class Clauses(Struct, frozen=True):
    """The events in clauses, such as "given EVENT", of a measure, and their roles. said: phrases for verdicts."""

    matchers: tuple[Matcher, ...] = ()
    roles: tuple[int, ...] = ()
    said: Sentence = UNNAMED


NO_CLAUSES = Clauses()


class ValueTest:
    """Test of a record's value. A value fits if `value & mask == want`, or if it fits the alternative test `others`."""

    __slots__ = ("mask", "others", "want")

    def __init__(self, mask: int, want: int, others: ValueTest | None) -> None:
        self.mask = mask
        self.want = want
        self.others = others

    def fits(self, value: int) -> bool:
        test: ValueTest | None = self
        while test is not None:
            if value & test.mask == test.want:
                return True
            test = test.others
        return False


class TopicTests:
    """Tests of whether a record of one topic is an event of a measure, or begins or ends a group of such events.

    place: the index of the event in the measure.
    test: the test of whether a record is the event; None if no record of the topic can be the event.
    groups: the groups, such as transfers, in which the event is counted; None if every event counts.
    begins, ends: the tests of whether a record begins or ends such a group; None if no record of the topic does.
    """

    __slots__ = ("begins", "ends", "groups", "place", "test")

    def __init__(
        self,
        place: int,
        test: ValueTest | None,
        groups: Groups | None,
        begins: ValueTest | None,
        ends: ValueTest | None,
    ) -> None:
        self.place = place
        self.test = test
        self.groups = groups
        self.begins = begins
        self.ends = ends


class EventMeasure(Measure):
    """Measure of the occurrences of an event. The argument `form` says what is measured:

    count   the number of events. `worst` is that number, `worst_at` the tick of the first event. A count of 0 is a
            measured value, too. But if the event's name is free text, the name may be misspelled, and a count of 0
            proves nothing. If the measure has occasions, verdicts show how many of them were measured.
    value   the value of each event: the words in a FIFO, the age of data that was read, a register field at a change
    level   the last value of the second event, at each occurrence of the first event
    sum     the sum of the events' values, which are numbers of things. `count` is the number of things in the clause
            `measured at`, or without it the number of events: a sum of 0 proves nothing if nothing was measured.
    ""      the values that a subclass takes in `happened`

    order: indices of `matchers`. If a record fits several matchers, their events are handled in this order.
    weighs: True for a sum. An event in a clause `for each`, `measured at` or `unless` then counts as many times as the
        value of its record says.
    """

    STATE = State("_groups _queue _queued _newest _level")

    def __init__(
        self, *matchers: Matcher, form: str = "", order: Sequence[int] = (), clauses: Clauses = NO_CLAUSES
    ) -> None:
        self.asked: str = clauses.said.asked
        super().__init__()
        thing = matchers[0].thing if matchers else None
        self.needs: str = "" if thing is None else thing.needs
        self.looks_back = clauses.said.looks_back
        self.counts: bool = form == "count"
        self.weighs: bool = form == "sum"
        self.series: bool = not (self.counts or self.weighs)
        self.unit: str = "time"
        if form:
            self.unit = "value" if thing is None or self.counts else thing.unit
            if self.unit == "value" and not self.series:
                self.unit = "count"
            self.occurrence = READ if self.series and thing is not None and thing.by_read else ""
        self._is_level: bool = form == "level"
        self._level = 0
        self._clauses: Clauses = clauses
        self._roles: list[int] = list(clauses.roles)
        self._own = len(matchers)
        self._measured = self._given = 0
        self._has_measured: bool = MEASURED_AT in clauses.roles
        self._has_given: bool = GIVEN in clauses.roles
        self._unknown_counts: list[int] = [0] * len(clauses.said.unknown)
        self._unfinished: list[tuple[int, int]] = []
        self.matchers: tuple[Matcher, ...] = matchers
        order = order or range(self._own)
        matchers = (*matchers, *clauses.matchers)
        self._seen_places = 0  # mask of the events that happened; bit i is event i of `matchers`
        self.first_seen = 0  # number of occurrences of the first event
        self.spans: set[str] | None = set() if any(m.free for m in matchers) else None  # names of the run's spans
        self._order: Sequence[int] = [*order, *range(self._own, len(matchers))]
        self._all_matchers: tuple[Matcher, ...] = matchers
        self._groups = [None if m.group is None else Groups(m.group, m.nth) for m in matchers]
        self._queue: deque[_QueuedEvent] = deque()
        self._queued = False  # True if an event waits in `_queue`
        # `_newest` maps the index of an event to its last occurrence in the present group.
        self._newest: dict[int, _QueuedEvent] = {}
        starts = [one for groups in self._groups if groups is not None for one in groups.matchers]
        each = [one for m in (*matchers, *starts) for one in m.each]
        self.kinds = frozenset(one.kind for one in each)
        self._wanted = {(one.kind, one.what) for one in each}
        # `_every` has the kinds of records that are needed whatever their `what` is.
        self._every: set[Kind] = {one.kind for one in each if one.what == ANYTHING}
        if self.spans is not None:  # all spans are needed, so that the right name can be suggested
            self._every.add(Kind.SPAN)
        self._needed: dict[Kind, frozenset[str]] = subjects_of([*matchers, *starts])
        self._plans: list[list[TopicTests]] = []  # for each tag, the tests for records with this tag
        self._names: list[str] = []  # for each tag, the name of the span; "" if the records are not about a span

    @property
    def subjects(self) -> Subjects:
        return self._needed

    def subscribe(self, recorder: Recorder) -> None:
        recorder.subscribe(self.kinds - self._every, self, self.subjects, self._wanted)
        recorder.subscribe(self._every, self, self.subjects)

    def listen(self, scene: MeasuredScene) -> None:
        for groups in self._groups:
            if groups is not None:
                groups.listen(scene)
        if self._is_level:
            (place,) = self.matchers[1].where or ("",)
            self._level = scene.value_of(place, self.matchers[1].what)

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        if kind not in self._every and (kind, what) not in self._wanted:
            return UNWANTED
        plan = [one for place in self._order if (one := self._tests(place, kind, where, what)) is not None]
        name = what if self.spans is not None and kind is Kind.SPAN else ""
        if not plan and not name:
            return UNWANTED
        self._plans.append(plan)
        self._names.append(name)
        return len(self._plans) - 1

    def _tests(self, place: int, kind: Kind, where: str, what: str) -> TopicTests | None:
        """Return the tests of a topic for event number `place`; None if its records are irrelevant for this event."""
        groups = self._groups[place]
        test = _test(self._all_matchers[place], kind, where, what)
        begins = ends = None
        if groups is not None:
            begins, ends = (_test(one, kind, where, what) for one in groups.matchers)
        return None if test is begins is ends is None else TopicTests(place, test, groups, begins, ends)

    def on_record(self, tag: int, tick: int, value: int) -> None:
        if self.spans is not None and self._names[tag]:
            self.spans.add(self._names[tag])
        plan = self._plans[tag]
        one: TopicTests
        for one in plan:
            if one.groups is not None:
                self._handle_grouped(one, tick, value)
            elif one.test is not None and one.test.fits(value):
                self._counts(one.place, tick, value)
        if self._queued:
            self._drain()

    def _counts(self, place: int, tick: int, value: int) -> None:
        """Report an event that counts, or queue it if earlier events are still in the queue."""
        if self._queued:
            self._queue.append(_QueuedEvent(place, tick, value, 1))
        else:
            self._report(place, tick, value)

    def _report(self, place: int, tick: int, value: int) -> None:
        if place >= self._own:
            self._handle_clause(place - self._own, tick, value)
        else:
            self._seen_places |= 1 << place
            self.first_seen += place == 0
            self.happened(place, tick, value)

    def _handle_clause(self, clause: int, tick: int, value: int) -> None:
        """Count or store an event that a clause of the measure, such as "given EVENT", names. clause: its index."""
        role: int = self._roles[clause]
        number = value if self.weighs else 1
        if role == FOR_EACH:
            self.occasion(tick, number)
        elif role == MEASURED_AT:
            self.measured_at(tick, number)
        elif role == GIVEN:
            self._given += 1
        elif role == UNLESS:
            self._unknown_counts[self._roles[:clause].count(UNLESS)] += number
        else:
            self._unfinished.append((value, tick))

    def measured_at(self, tick: int, number: int) -> None:
        """Count `number` values as measured at tick `tick`."""
        if self.weighs:
            self.count += number
        elif tick >= self.not_before:
            self._measured += number

    def _handle_grouped(self, one: TopicTests, tick: int, value: int) -> None:
        """Handle a record that may begin or end an event's group, or be the event that counts in it."""
        groups, place = one.groups, one.place
        assert groups is not None
        begins = one.begins is not None and one.begins.fits(value)
        if groups.begins(tick, begins, one.ends is not None and one.ends.fits(value)):
            self._settle(place, 1)
        if one.test is None or not one.test.fits(value):
            return
        if groups.nth < 0:
            self._settle(place, 0)
            if groups.inside:
                self._newest[place] = _QueuedEvent(place, tick, value, WAITS)
                self._queue.append(self._newest[place])
                self._queued = True
        elif groups.is_nth():
            self._counts(place, tick, value)

    def _settle(self, place: int, counts: int) -> None:
        """Decide whether the last occurrence so far of event number `place` in its group counts.

        counts: 1 if this event counts, 0 if a later event of its group replaces it.
        """
        newest: _QueuedEvent | None = self._newest.pop(place, None)
        if newest is not None:
            newest.counts = counts

    def _drain(self) -> None:
        queue = self._queue
        while queue and queue[0].counts != WAITS:
            seen: _QueuedEvent = queue.popleft()
            if seen.counts:
                self._report(seen.place, seen.tick, seen.value)
        self._queued = bool(queue)

    def happened(self, place: int, tick: int, value: int) -> None:
        """Handle an occurrence of event number `place` of `matchers`. Called for each event in order."""
        if place:
            self._level = value
        elif self.series:
            self.take(self._level if self._is_level else value, tick)
        else:
            if not self.worst:
                self.worst_at = self.least_at = tick
            self.worst = self.least = self.worst + (value if self.weighs else 1)
            if self.counts or not self._has_measured:
                self.count += 1

    def finish(self, now: int) -> None:
        for place in list(self._newest):
            self._settle(place, 1)
        self._drain()
        for (thing, why), count in zip(self._clauses.said.unknown, self._unknown_counts, strict=True):
            if count and not self.not_judged:
                self.not_judged = f"{counted(count, thing)} {why}"

    @property
    def measured(self) -> int:
        return self._measured if self._has_measured and not (self.weighs or self.is_jitter) else self.count

    @property
    def counted(self) -> int:
        return self.measured if self.counts and self.occasions is not None else self.count

    @property
    def proves_no_zero(self) -> bool:
        """True if a count of 0 proves nothing: the name of the counted event is free text and may be misspelled."""
        return self.counts and self.matchers[0].free

    @property
    def ungiven(self) -> bool:
        """True if the measure has clauses `given` and none of their events happened, so that nothing is proven."""
        return self._has_given and not self._given

    @property
    def silent(self) -> bool:
        return self.ungiven or not (self.count or (self.counts and not self.proves_no_zero))

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        return self._unfinished

    def unfinished_text(self) -> str:
        return self._clauses.said.cut_off

    def why_silent(self) -> str:
        said = self._clauses.said
        if self.ungiven:
            clauses = zip(self._clauses.matchers, self._roles, strict=True)
            return said.unproven or self.unmatched([m for m, role in clauses if role == GIVEN])
        if said.nothing is not None and self.spans is not None:
            return "" if self.first_seen else f"{said.nothing}; {span_hint(self.matchers[0].what, self.spans)}"
        if said.nothing is not None:
            return said.nothing
        needed = self.matchers[:1] if self._is_level else self.matchers
        return self.unmatched([m for place, m in enumerate(needed) if not self.seen(place)])

    def seen(self, place: int) -> bool:
        """Return True if event number `place` of `matchers` happened."""
        return self._seen_places >> place & 1 == 1

    def unmatched(self, never: list[Matcher]) -> str:
        if never:
            hints = [span_hint(m.what, self.spans) for m in never if m.free and self.spans is not None]
            texts = dict.fromkeys(repr(m.text) for m in never)
            return "; ".join([f"no event matched {' and '.join(texts)}", *hints[:1]])
        return f"{self.matchers[0].text!r} was seen {counted(self.first_seen, 'time')}, which makes no measurement"


def _test(matcher: Matcher, kind: Kind, where: str, what: str) -> ValueTest | None:
    """Return the test of whether a record of a topic is the event; None if no record of the topic can be."""
    test: ValueTest | None = None
    for one in reversed(matcher.each):
        if one.may_be(kind, where, what):
            test = ValueTest(one.mask, one.want, test)
    return test


def subjects_of(matchers: Sequence[Matcher]) -> dict[Kind, frozenset[str]]:
    """Return a dictionary from a kind of records to the wires or registers (the subjects) that the matchers need.

    A kind is left out if any matcher needs the records of all subjects.
    """
    needed: dict[Kind, frozenset[str]] = {}
    each = [one for m in matchers for one in m.each]
    for m in each:
        needed[m.kind] = needed.get(m.kind, frozenset()) | m.subjects
    everything = {m.kind for m in each if not m.subjects}
    return {kind: subjects for kind, subjects in needed.items() if kind not in everything}


def span_hint(name: str, spans: set[str]) -> str:
    """Return a phrase with the names of spans in a run: similar names if there are any, otherwise all names."""
    if not spans:
        return "the run had no span"
    hint = did_you_mean(name, sorted(spans))
    return f"the run had spans {hint.removeprefix('it has ')}" if hint.startswith("it has ") else hint
