"""Waits and code of many scenarios at once, with the interrupts that meet them: cycles go in, cycles come out.

    wait   fetch r, r + P, r + 2 P ...: it ends with the first at or behind its flag f,

               e = r + ceil(max(0, f - r) / P) * P

           unless an interrupt latched at q <= e - waits comes before: behind fetch m = floor((q - r + waits - 1) / P),
           and the passes begin anew at r + (m + 1) P + service
    code   CodeTable, at q - e
    run    work of c cycles from b on: each interrupt latched up to its end makes it longer by `service`

Two interrupts are further apart than a service routine and any code between two waits (`inputs` refuses others).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .clock import Ints
from .code import CodeTable

FAR = 1 << 61  # a cycle that no run reaches


class Interrupts:
    """Those of all scenarios of a call. latches: int64[frames + 1, scenarios], in order, the last one FAR.

    One is named by its place in them, number * scenarios + scenario; the next one is `scenarios` places on.
    """

    def __init__(self, latches: Ints, service: int, waits: int) -> None:
        self.latches = latches.reshape(-1)
        self.scenarios = latches.shape[1]
        self.service, self.waits = service, waits

    def lanes(self, places: Ints) -> Lanes:
        """Of scenarios whose next interrupts are these."""
        return Lanes(self, places)


class Lanes:
    """Some of the scenarios. places: of the next interrupt of each. next: its latch."""

    def __init__(self, of: Interrupts, places: Ints) -> None:
        self._of = of
        self.places = places.copy()
        self.next = of.latches[places]

    def _take(self, hit: NDArray[np.intp]) -> None:
        self.places[hit] += self._of.scenarios
        self.next[hit] = self._of.latches[self.places[hit]]

    def wait(self, first: Ints, flag: Ints, poll: int) -> Ints:
        """The fetch that ends the wait. first: that of its first pass."""
        of, first = self._of, first.copy()
        end: Ints = first + -(-np.maximum(flag - first, 0) // poll) * poll
        while True:
            hit = np.flatnonzero(self.next <= end - of.waits)
            if not hit.size:
                return end
            passes = (self.next[hit] - first[hit] + of.waits - 1) // poll + 1
            first[hit] += passes * poll + of.service
            end[hit] = first[hit] + -(-np.maximum(flag[hit] - first[hit], 0) // poll) * poll
            self._take(hit)

    def code(self, begin: Ints, table: CodeTable) -> tuple[Ints, list[Ints]]:
        """(where it ends, each of its marks)."""
        end = begin + table.length
        marks = [begin + calm for calm, _ in table.marks]
        hit = np.flatnonzero(self.next <= begin + table.last)
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
            hit = np.flatnonzero(self.next <= end)
            if not hit.size:
                return end
            end[hit] += self._of.service
            self._take(hit)
