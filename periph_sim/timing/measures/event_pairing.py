"""What measures of events have in common: records go in; which of its events happened, and in which order, comes out.

    record --matchers--> event that counts at once ---------------------.
                   '---> "last ... of transfer": known when that is over -+--in order--> happened(place, record)

Of two events at one time the one recorded first is the earlier one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from ...core.records import Kind, Record, Subjects
from ...core.suggest import did_you_mean
from ..language.events import Matcher
from .groups import Groups
from .measure import Measure, SceneEvents


@dataclass
class _Seen:
    """An event that happened. counts: None as long as a later one may take its place."""

    place: int
    record: Record
    counts: bool | None


class EventMeasure(Measure):
    """A measure that knows how often each of its events happened.

    order: which of its events comes first where one record is several of them; places in `matchers`.
    """

    def __init__(self, *matchers: Matcher, order: Sequence[int] = ()) -> None:
        super().__init__()
        self.matchers = matchers
        self.seen = [0] * len(matchers)
        self.spans: set[str] | None = set() if any(m.free for m in matchers) else None  # names that there were
        self._order = order or range(len(matchers))
        self._groups = [None if m.group is None else Groups(m.group, m.nth) for m in matchers]
        self._queue: deque[_Seen] = deque()
        self._newest: dict[int, _Seen] = {}  # the last of its group so far, by place
        starts = [one for groups in self._groups if groups is not None for one in groups.matchers]
        each = [one for m in (*matchers, *starts) for one in m.each]
        self.kinds = frozenset(one.kind for one in each)
        self.names = frozenset(one.what for one in each)  # a record of another name is passed over
        self._needed = subjects_of([*matchers, *starts])

    @property
    def subjects(self) -> Subjects:
        return self._needed

    def listen(self, scene: SceneEvents) -> None:
        for groups in self._groups:
            if groups is not None:
                groups.listen(scene)
        if any(matcher.is_stuck for matcher in self.matchers):
            scene.on_stuck(lambda at: None)  # so that the wires are watched; the record says it

    def record(self, record: Record) -> None:
        if self.spans is not None:
            self.hear(record)
        if record.what not in self.names:
            return
        for place in self._order:
            groups = self._groups[place]
            if groups is not None and groups.begins(record):
                self._settle(place)
            if not self.matchers[place].fits(record):
                continue
            if groups is None:
                self.seen[place] += 1
                self._queued(_Seen(place, record, True))
            elif groups.nth < 0:
                self._settle(place, counts=False)
                if groups.inside:
                    self._newest[place] = _Seen(place, record, None)
                    self._queued(self._newest[place])
            elif groups.is_nth():
                self.seen[place] += 1
                self._queued(_Seen(place, record, True))
        self._drain()

    def _settle(self, place: int, counts: bool = True) -> None:
        """No later one of its group can take the place of the last one that was seen, or one does."""
        newest = self._newest.pop(place, None)
        if newest is not None:
            newest.counts = counts
            self.seen[place] += counts

    def _queued(self, seen: _Seen) -> None:
        if self._queue or seen.counts is None:
            self._queue.append(seen)
        else:
            self.happened(seen.place, seen.record)

    def _drain(self) -> None:
        queue = self._queue
        while queue and queue[0].counts is not None:
            seen = queue.popleft()
            if seen.counts:
                self.happened(seen.place, seen.record)

    def happened(self, place: int, record: Record) -> None:
        """Called for each of its events, in order. What only wants their counts leaves it as it is."""

    def finish(self, now: int) -> None:
        for place in list(self._newest):
            self._settle(place)
        self._drain()

    def hear(self, record: Record) -> None:
        """Remember what spans there are: their names are free text, so only the run can tell the right one."""
        if self.spans is not None and record.kind is Kind.SPAN:
            self.spans.add(record.what)

    def missing(self) -> str:
        return self.unmatched([m for m, seen in zip(self.matchers, self.seen, strict=True) if not seen])

    def unmatched(self, never: list[Matcher]) -> str:
        if never:
            hints = [span_hint(m.what, self.spans) for m in never if m.free and self.spans is not None]
            return "; ".join([f"no event matched {' and '.join(repr(m.text) for m in never)}", *hints[:1]])
        return f"{self.matchers[0].text!r} was seen {self.seen[0]} times, which makes no measurement"


def subjects_of(matchers: Sequence[Matcher]) -> dict[Kind, frozenset[str]]:
    """What the matchers need records of, by kind; without the kinds of which one of them needs all."""
    needed: dict[Kind, frozenset[str]] = {}
    each = [one for m in matchers for one in m.each]
    for m in each:
        needed[m.kind] = needed.get(m.kind, frozenset()) | m.subjects
    everything = {m.kind for m in each if not m.subjects}
    return {kind: subjects for kind, subjects in needed.items() if kind not in everything}


def span_hint(name: str, spans: set[str]) -> str:
    """A phrase that names the spans that a run had, or those of them whose names are near."""
    if not spans:
        return "the run had no span"
    hint = did_you_mean(name, sorted(spans))
    return f"the run had spans {hint.removeprefix('it has ')}" if hint.startswith("it has ") else hint
