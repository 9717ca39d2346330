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
    """Those of all scenarios of a call. latches: int64[frames + 1, scenarios], in order, the last one FAR."""

    def __init__(self, latches: Ints, service: int, waits: int) -> None:
        self._latches = latches
        self.service, self.waits = service, waits

    def lanes(self, scenarios: Ints, taken: Ints) -> Lanes:
        return Lanes(self, scenarios, taken)

    def at(self, number: Ints, scenarios: Ints) -> Ints:
        found: Ints = self._latches[number, scenarios]
        return found


class Lanes:
    """Some of the scenarios. taken: interrupts so far. next: the latch of the next one."""

    def __init__(self, of: Interrupts, scenarios: Ints, taken: Ints) -> None:
        self._of, self.scenarios = of, scenarios
        self.taken = taken.copy()
        self.next = of.at(taken, scenarios)

    def _take(self, hit: NDArray[np.intp]) -> None:
        self.taken[hit] += 1
        self.next[hit] = self._of.at(self.taken[hit], self.scenarios[hit])

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
