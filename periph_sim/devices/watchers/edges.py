"""Expected edges of a wire, one by one: the deviation of each from its expected time.

    wire      ____|~~~~~~|________
    edges      10 ms    20 ms          ["10 ms", "rise"], ["20 ms", "fall"]
    deviation     |-|   ||             the n-th edge against the n-th expected one

The run fails if an edge is missing or of the wrong kind, or if an edge follows the last expected one and `more` is
false.
"""

from __future__ import annotations

from collections.abc import Set
from fractions import Fraction
from typing import Annotated, Literal

from msgspec import Meta

from ...core.table import Duration, Table
from . import EDGE_NAMES, WatchContext

KIND = "edges"


class Settings(Table, frozen=True, kw_only=True):
    """The expected edges of a wire.

    edges: expected edges in order: `[["10 ms", "rise"], ["20 ms", "fall"]]`
    since: the instant from which the times of `edges` count: `"start"` or `"first edge"`
    after: edges up to this time are ignored
    more: `true`: further edges are allowed
    """

    edges: Annotated[tuple[tuple[Duration, Literal["rise", "fall"]], ...], Meta(min_length=1)]
    since: Literal["start", "first edge"] = "start"
    after: Duration = Fraction(0)
    more: bool = False

    def check_together(self, given: Set[str]) -> None:
        times = [at for at, _ in self.edges]
        if times != sorted(times):
            raise ValueError("edges are not in order of time; sort them")
        if self.since == "first edge" and times[0]:
            raise ValueError("'since' is the first edge, so the first time must be 0; give the times since that edge")
        if self.since == "start" and times[0] <= self.after:
            raise ValueError("the first edge is not later than 'after', up to which edges are ignored; lower 'after'")


class Edges:
    def __init__(self, settings: Settings, place: WatchContext) -> None:
        self._place = place
        self._expected = [(place.ticks(at), EDGE_NAMES.index(edge)) for at, edge in settings.edges]
        # The tick from which the expected times count; -1 if they count from the first edge, before this edge.
        self._zero = place.start if settings.since == "start" else -1
        self._after = place.start + place.ticks(settings.after)
        self._more = settings.more
        self._next = 0
        self._lost = False  # True after an edge of the wrong kind: later edges cannot be matched to expected ones
        self._cut = False  # True if the run ended too early to tell that the next expected edge is missing

    def edge(self, now: int, level: int) -> None:
        place = self._place
        if now <= self._after or self._lost:
            return
        if self._next == len(self._expected):
            if not self._more:
                place.refute(f"{self._named(level)} came at {place.at(now)}, after the last expected one", now)
            return
        at, wanted = self._expected[self._next]
        if self._zero < 0:
            self._zero = now
        if level != wanted:
            self._lost = True
            due, came = place.at(self._zero + at), place.at(now)
            place.refute(f"{self._named(wanted)} was expected at {due}; {self._named(level)} came at {came}", now)
            return
        self._next += 1
        place.on_deviation(abs(now - self._zero - at), now)

    def finish(self, now: int) -> None:
        place = self._place
        if self._next == len(self._expected) or self._lost:
            return
        at, wanted = self._expected[self._next]
        due = self._zero + at if self._zero >= 0 else self._after
        if now > due + place.tolerance:
            by = f"at {place.at(due)}" if self._zero >= 0 else f"from {place.at(due)} on"
            place.refute(f"{self._named(wanted)} was expected {by}, and did not come", due)
        else:
            self._cut = True

    def missing(self) -> str:
        return "the run ended before the first edge was due; let it last longer" if self._cut else ""

    def _named(self, level: int) -> str:
        return f"a {EDGE_NAMES[level]} of {self._place.wire}"


def build(settings: Settings, place: WatchContext) -> Edges:
    return Edges(settings, place)
