"""What reads and rounds without an interrupt come to, kept for all that are alike: a START goes in, a `Kept` comes out.

    START = c * num / den - r / den       c: the cycle in which it is seen; r: where in the cycle, 0 <= r < num
    an edge d ticks on is seen in c + whole(d) + (part(d) > r)          d * den = whole(d) * num + part(d)

So what the CPU does, in cycles from c on, is a function of two small numbers, whatever the START: in which of the
intervals between the parts r lies, and where in a pass of the polls the edge of AAS meets the firmware.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, final

from .kept_margins import KeptMargins

EDGES = 128  # of a round, at the most
BYTES = 32  # of a read, at the most
BUCKETS = 128  # in which intervals are looked for
PLACES = 1 << 18  # that are kept at the most


@final
class Kept:
    """of: the clock that it was worked out for; 0: none. In cycles from c on, where it ends, and the marks of the code
    behind it. Of I2CSTR's writes and of waits for a START that is still to come, the largest and smallest part of a
    value, ceil((part - r) / den). landed: of a read, the cycles from c on in which its writes landed.
    """

    landed: Annotated[list[int], BYTES]

    def __init__(self) -> None:
        self.of = self.end = self.off = self.ready = 0
        self.cleared_most = self.cleared_least = 0
        self.asked_most = self.asked_least = 0
        self.margins = KeptMargins()
        self.landed = [0] * BYTES


NOTHING = Kept()  # is never of any clock


@final
class Memory:
    """edges: ticks from a START. poll: cycles of a pass. whole, part: of each edge, with the clock that is set."""

    whole: Annotated[list[int], EDGES]
    part: Annotated[list[int], EDGES]
    _edges: Annotated[list[int], 128]
    _ends: Annotated[list[int], EDGES]
    _buckets: Annotated[list[int], BUCKETS]
    _phases: int

    def __init__(self, edges: Sequence[int], poll: int) -> None:
        assert len(edges) < EDGES  # the last interval ends after the last edge
        self._count, self._nothing = len(edges), NOTHING
        self._edges = [*edges, *[0] * (EDGES - len(edges))]
        self.whole, self.part = [0] * EDGES, [0] * EDGES
        self._ends = [0] * EDGES  # of the intervals
        self._buckets, self._shift = [0] * BUCKETS, 0
        places = (len(edges) + 1) * poll
        self._phases = poll if places <= PLACES else 0  # that are kept
        self._kept: list[Kept | None] = [None] * (places if self._phases else 0)

    def of_clock(self, num: int, den: int) -> None:
        count = self._count
        for place in range(count):
            ticks = self._edges[place] * den
            self.whole[place] = ticks // num
            self.part[place] = ticks - self.whole[place] * num
        end: int
        for place, end in enumerate(sorted([self.part[place] for place in range(count)])):
            self._ends[place] = end
        self._ends[count] = num
        self._shift = 0
        while num >> self._shift >= BUCKETS:
            self._shift += 1
        interval: int = 0
        bucket: int
        for bucket in range(BUCKETS):
            while interval < count and self._ends[interval] <= bucket << self._shift:
                interval += 1
            self._buckets[bucket] = interval

    def find(self, rest: int, phase: int) -> Kept:
        """rest: r. phase: cycles from the flag AAS to the fetch that finds it. NOTHING: such are not kept."""
        if phase >= self._phases:
            return self._nothing
        assert 0 <= rest < self._ends[self._count] and phase >= 0
        interval = self._buckets[rest >> self._shift]
        while self._ends[interval] <= rest:
            interval += 1
        found: Kept | None = self._kept[interval * self._phases + phase]
        return self._new(interval * self._phases + phase) if found is None else found

    def _new(self, place: int) -> Kept:
        self._kept[place] = found = Kept()
        return found
