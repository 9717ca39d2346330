"""What measures of events have in common: matchers go in; how often each event was seen, and which never, come out."""

from __future__ import annotations

from collections.abc import Sequence

from ..core.nearest import near
from ..core.records import Kind, Record, Subjects
from .events import Matcher
from .measures import Measure


class OfEvents(Measure):
    """A measure that knows how often each of its events happened."""

    def __init__(self, *matchers: Matcher) -> None:
        super().__init__()
        self.kinds = frozenset(m.kind for m in matchers)
        self.matchers = matchers
        self.seen = [0] * len(matchers)
        self.spans: set[str] | None = set() if any(m.free for m in matchers) else None  # names that there were

    @property
    def subjects(self) -> Subjects:
        return subjects_of(self.matchers)

    def hear(self, record: Record) -> None:
        """Remember what spans there are: their names are free text, so only the run can tell the right one."""
        if self.spans is not None and record.kind is Kind.SPAN:
            self.spans.add(record.what)

    def missing(self) -> str:
        return self.unmatched([m for m, seen in zip(self.matchers, self.seen, strict=True) if not seen])

    def unmatched(self, never: list[Matcher]) -> str:
        if never:
            hints = [span_hint(m, self.spans) for m in never if m.free and self.spans is not None]
            return "; ".join([f"no event matched {' and '.join(repr(m.text) for m in never)}", *hints[:1]])
        return f"{self.matchers[0].text!r} was seen {self.seen[0]} times, which makes no measurement"


def subjects_of(matchers: Sequence[Matcher]) -> dict[Kind, frozenset[str]]:
    """What the matchers need records of, by kind; without the kinds of which one of them needs all."""
    needed: dict[Kind, frozenset[str]] = {}
    for m in matchers:
        needed[m.kind] = needed.get(m.kind, frozenset()) | m.subjects
    everything = {m.kind for m in matchers if not m.subjects}
    return {kind: subjects for kind, subjects in needed.items() if kind not in everything}


def span_hint(event: Matcher, spans: set[str]) -> str:
    if not spans:
        return "the run had no span"
    hint = near(event.what, sorted(spans))
    return f"the run had spans {hint.removeprefix('it has ')}" if hint.startswith("it has ") else hint
