"""Times of named stretches of firmware."""

from __future__ import annotations

from ...core.records import Kind, Record
from .event_pairing import span_hint
from .measure import Measure


class SpanTime(Measure):
    """From the begin of a named stretch of firmware to its end, service routines in between included."""

    kinds = frozenset({Kind.SPAN})

    def __init__(self, name: str) -> None:
        super().__init__()
        self._name = name
        self._began: dict[str, int] = {}
        self._spans: set[str] = set()  # their names, of all that there were

    def record(self, record: Record) -> None:
        self._spans.add(record.what)
        if record.what != self._name:
            return
        if record.value:
            self._began[record.where] = record.tick
        elif record.where in self._began:
            began = self._began.pop(record.where)
            self.take(record.tick - began, began)

    def missing(self) -> str:
        if self._name in self._spans:
            return ""
        return f"there was no span {self._name!r}; {span_hint(self._name, self._spans)}"

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        return [(now - began, began) for began in self._began.values()]

    def unfinished_text(self) -> str:
        return f"span {self._name!r} still lasted when the run ended"
