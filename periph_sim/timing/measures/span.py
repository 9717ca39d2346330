"""Times of named stretches of firmware."""

# core: compiled

from __future__ import annotations

from ...core.records import Kind
from ...core.state import State
from .event_pairing import span_hint
from .measure import Measure


class SpanTime(Measure):
    """Time from the begin of a named stretch of firmware to its end, service routines in between included."""

    STATE = State(ticks="_began")
    kinds = frozenset({Kind.SPAN})

    def __init__(self, name: str) -> None:
        super().__init__()
        self._name = name
        self._began: dict[str, int] = {}
        self._spans: set[str] = set()  # their names, of all that there were
        self._heard: list[tuple[str, str]] = []  # unit and name, by tag

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        self._heard.append((where, what))
        return len(self._heard) - 1

    def on_record(self, tag: int, tick: int, value: int) -> None:
        where, what = self._heard[tag]
        self._spans.add(what)
        if what != self._name:
            return
        if value:
            self._began[where] = tick
        elif where in self._began:
            began = self._began.pop(where)
            self.take(tick - began, began)

    def missing(self) -> str:
        if self._name in self._spans:
            return ""
        return f"there was no span {self._name!r}; {span_hint(self._name, self._spans)}"

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        return [(now - began, began) for began in self._began.values()]

    def unfinished_text(self) -> str:
        return f"span {self._name!r} still lasted when the run ended"
