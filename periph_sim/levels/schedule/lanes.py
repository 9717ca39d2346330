"""Waits and code of many scenarios at once, with the interrupts that meet them: cycles go in, cycles come out.

    wait   fetch r, r + P, r + 2 P ...: it ends with the first at or behind its flag f,

               e = r + ceil(max(0, f - r) / P) * P

           unless an interrupt latched at q <= e - waits comes before: behind fetch
           m = max(0, floor((q - r + waits - 1) / P)), and the passes begin anew at r + (m + 1) P + service
    code   CodeTable, at q - e
    run    work of c cycles from b on: each interrupt latched up to its end makes it longer by `service`

Two interrupts are further apart than a service routine and any code between two waits (`inputs` refuses others).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .clock import Ints
from .code import CodeTable
from .stored import Stored

FAR = 1 << 61  # a cycle that no run reaches


class Interrupts:
    """Those of all scenarios of a call. latches: a row of each, in order; the last one never comes."""

    def __init__(self, latches: Stored, service: int, waits: int) -> None:
        self.latches = latches
        self.scenarios = latches.scenarios
        self.service, self.waits = service, waits

    def lanes(self, places: Ints) -> Lanes:
        """Of scenarios whose next interrupts are these."""
        return Lanes(self, places)


class Lanes:
    """Some of the scenarios. places: of the next interrupt of each. next: its latch."""

    def __init__(self, of: Interrupts, places: Ints) -> None:
        self._of = of
        self.places = places.copy()
        self.next = of.latches.at(places)

    def _take(self, hit: NDArray[np.intp]) -> None:
        self.places[hit] += self._of.scenarios
        self.next[hit] = self._of.latches.at(self.places[hit])

    def wait(self, first: Ints, flag: Ints, poll: int, fetched: int = 0) -> Ints:
        """The fetch that ends the wait. first: that of its first pass.

        fetched: 1 where the pass has fetched another flag before, behind which an interrupt may be taken; else the code
        before has taken each that comes before the first fetch.
        """
        of, first = self._of, first.copy()
        end: Ints = first + -(-np.maximum(flag - first, 0) // poll) * poll
        while True:
            hit = (self.next <= end - of.waits).nonzero()[0]
            if not fetched:
                hit = hit[end[hit] > first[hit]]
            if not hit.size:
                return end
            passes = (self.next[hit] - first[hit] + of.waits - 1) // poll
            first[hit] += (np.maximum(passes, -fetched) + 1) * poll + of.service
            end[hit] = first[hit] + -(-np.maximum(flag[hit] - first[hit], 0) // poll) * poll
            self._take(hit)

    def split(self, first: Ints, flag: Ints, poll: int, second: int, other: Ints) -> tuple[Ints, Ints, Ints]:
        """(the fetch that ends a wait for one of two flags, lanes in which it is the other's, the places there).

        The other is fetched `second` cycles behind the first in each pass. It ends the wait only where an interrupt
        comes between the two fetches of a pass, and both flags rise in it; `other` comes later than `flag` by passes.
        """
        of, first = self._of, first.copy()
        end: Ints = first + -(-np.maximum(flag - first, 0) // poll) * poll
        by_other, places = [], []
        going = np.ones(len(first), np.bool_)
        while True:
            hit = (going & (end > first) & (self.next <= end - of.waits)).nonzero()[0]
            if not hit.size:
                break
            passes = np.maximum((self.next[hit] - first[hit] + of.waits - 1) // poll, 0)
            began = first[hit] + passes * poll
            seen = began + second + of.service
            ends = (self.next[hit] - began <= second - of.waits) & (seen >= other[hit])
            first[hit] = began + poll + of.service
            end[hit] = first[hit] + -(-np.maximum(flag[hit] - first[hit], 0) // poll) * poll
            self._take(hit)
            end[hit[ends]] = seen[ends]
            going[hit[ends]] = False
            by_other.append(hit[ends])
            places.append(self.places[hit[ends]])
        none = np.zeros(0, np.int64)
        return end, np.concatenate([none, *by_other]), np.concatenate([none, *places])

    def back(self, lanes: Ints, places: Ints) -> None:
        """The next interrupts of these lanes are these again."""
        self.places[lanes] = places
        self.next[lanes] = self._of.latches.at(places)

    def code(self, begin: Ints, table: CodeTable) -> tuple[Ints, list[Ints]]:
        """(where it ends, each of its marks)."""
        end = begin + table.length
        marks = [begin + calm for calm, _ in table.marks]
        hit = (self.next <= begin + table.last).nonzero()[0]
        if hit.size:
            place = np.maximum(self.next[hit] - begin[hit], table.first) - table.first
            end[hit] = begin[hit] + table.lengths[place]
            for mark, (_, by_latch) in zip(marks, table.marks, strict=True):
                mark[hit] = begin[hit] + by_latch[place]
            self._take(hit)
        return end, marks

    def run(self, begin: Ints, cycles: Ints) -> Ints:
        """The end of a computation."""
        end = begin + cycles
        while True:
            hit = (self.next <= end).nonzero()[0]
            if not hit.size:
                return end
            end[hit] += self._of.service
            self._take(hit)
