"""Waits and code of one scenario, with the interrupts that its host's frames make: cycles go in, cycles come out.

The rules are those of `lanes`, which has many scenarios at once; the frames are those of `frames` and the latches those
of `receiver`, made one after the other as the firmware comes to them. Most of them need no division:

    latch * num  is in  lowest .. lowest + spread - 1        lowest = (begun + edge) * den + ahead * num

so a latch is worked out only where these bounds do not say on which side of an instant it lies. An interrupt within a
wait moves the passes behind it by `service`, modulo a pass, wherever it comes: `wait_from_far` needs no more.
"""

# core: compiled

from __future__ import annotations

from array import array
from typing import final

import numpy as np

from ...form.c_types import Buffer
from .clock import Ints
from .code import CodeTable
from .receiver import Receiver
from .terms import Terms

FAR = 1 << 61  # a cycle that no run reaches
FAR_PART = 1 << 62  # more than any cycle * num
UNKNOWN = -1  # a latch that is not worked out


@final
class Piece:
    """A `CodeTable` for one lane. first_marks, second_marks: by latch; calm_first, calm_second: of no interrupt."""

    length: int
    first: int
    last: int
    calm_first: int
    calm_second: int
    lengths: Buffer[int]
    first_marks: Buffer[int]
    second_marks: Buffer[int]

    def __init__(self, table: CodeTable) -> None:
        self.length, self.first, self.last = table.length, table.first, table.last
        self.lengths = _array(table.lengths.tolist())
        marks = [(calm, by_latch.tolist()) for calm, by_latch in table.marks] + [(0, [0] * len(self.lengths))] * 2
        (self.calm_first, first), (self.calm_second, second) = marks[:2]
        self.first_marks, self.second_marks = _array(first), _array(second)


def _array(numbers: list[int]) -> array[int]:
    return array("q", numbers)


@final
class Lane:
    """One scenario's CPU. lowest: a lower bound of the next latch * num. number: of its frame; begun, before: ticks at
    which that frame begins, and the one before; first_begun: the first one.

    mark, second_mark: of the code that ran last. by_other: the last `split` ended by the other flag.
    """

    service: int
    waits: int
    _ahead: int
    _high: int
    _margin: int
    _edge: int
    _sync: int
    _period: int
    _behind: int

    def __init__(self, terms: Terms, receiver: Receiver) -> None:
        self.service, self.waits = terms.service, terms.waits
        self._high, self._margin = terms.high, terms.margin
        self._edge, self._sync, self._period = receiver.edge, receiver.sync - receiver.phase, receiver.period
        self._behind = receiver.phase + receiver.due * receiver.period + receiver.extra
        self._ahead = receiver.sync + receiver.due * receiver.period + receiver.extra
        self.num = self.den = 1
        self._latch, self._lowest_of_zero, self._spread = FAR, 0, 0
        self.lowest, self.number, self.begun, self.before, self.first_begun = FAR_PART, 0, 0, 0, 0
        self.mark, self.second_mark, self.by_other = 0, 0, False
        self.late = np.zeros(1, np.int64)
        self._late_at, self._jitter, self._frames, self._pause = 0, False, 0, False
        self._due, self._whole, self._rest, self._part, self._parts = 0, 0, 0, 0, 1

    def hosts(self, late: Ints, jitter: bool, pause: bool, frames: int) -> None:
        """What all scenarios have in common. late: draws of their frames, where there is jitter. frames: of each."""
        self.late, self._jitter, self._pause, self._frames = late, jitter, pause, frames

    def host(self, first: int, num: int, den: int, place: int) -> None:
        """Its frames: the first one, and num / den ticks between two. place: of the first draw for them."""
        self._due, self._part, self._parts = first, 0, den
        self._whole = num // den
        self._rest = 0 if self._pause else num - self._whole * den
        self._late_at, self.number = place, 0
        self._lowest_of_zero = self._edge * self.den + self._ahead * self.num
        self._spread = self._period * self.num
        self._make()
        self.first_begun = self.before = self.begun

    def _make(self) -> None:
        """The frame `number`."""
        begun = self._due
        if self._jitter:
            begun += self.late[self._late_at + self.number]
            if self._pause:
                self._due = begun
        self.begun, self._latch = begun, UNKNOWN
        self.lowest = begun * self.den + self._lowest_of_zero

    def latch(self) -> int:
        """The cycle of the next interrupt's latch."""
        if self._latch == UNKNOWN:
            cycle = -(-(self.begun + self._edge) * self.den // self.num)
            self._latch = self._behind - -(cycle + self._sync) // self._period * self._period
        return self._latch

    def calm(self, cycle: int) -> bool:
        """True if the next interrupt comes behind this cycle."""
        return self.lowest > cycle * self.num or self.latch() > cycle

    def take(self) -> None:
        """An interrupt is taken."""
        self.before = self.begun
        self.number += 1
        if self.number >= self._frames:
            self._latch, self.lowest = FAR, FAR_PART
            return
        self._due += self._whole
        self._part += self._rest
        if self._part >= self._parts:
            self._part -= self._parts
            self._due += 1
        self._make()

    def tick(self, cycle: int) -> int:
        return cycle * self.num // self.den

    def cycle_at(self, tick: int) -> int:
        """The first cycle that begins at or after this tick."""
        return -(-tick * self.den // self.num)

    def margin(self, let_go: int, landed: int) -> int:
        """The `margin of I2CDXR` of one byte. let_go: tick at which SCL could rise. landed: cycle of its write."""
        return let_go - self.tick(landed + self._margin)

    # As in `lanes` ------------------------------------------------------------------

    def wait_from_far(self, first: int, flag: int, poll: int) -> int:
        """As `wait`, quicker where no more than one interrupt comes, and that well before the flag.

        `first` is then a fetch that could have been one, a whole number of passes before one that was.
        """
        if first <= flag:
            well_before = flag - 2 * (poll + self.waits + self.service)
            if first <= well_before and self.lowest <= well_before * self.num - self._spread:
                first += self.service
                self.take()
            if self.lowest > (flag + poll) * self.num:
                return flag + (first - flag) % poll
        return self.wait(first, flag, poll, 0)

    def wait(self, first: int, flag: int, poll: int, fetched: int) -> int:
        end = first if flag <= first else first + (flag - first + poll - 1) // poll * poll
        if self.lowest > end * self.num:
            return end
        waits = self.waits
        while True:
            latch, end = self.latch(), first
            if flag > first:
                if latch > flag - waits:  # else it comes before the fetch that ends the wait, whichever that is
                    end += (flag - first + poll - 1) // poll * poll
                    if latch > end - waits:
                        return end
            elif not fetched or latch > end - waits:
                return end
            passes = (latch - first + waits - 1) // poll
            if passes < -fetched:
                passes = -fetched
            first += (passes + 1) * poll + self.service
            self.take()

    def split(self, first: int, flag: int, poll: int, second: int, other: int) -> int:
        self.by_other = False
        end = first if flag <= first else first + (flag - first + poll - 1) // poll * poll
        while end > first and not self.calm(end - self.waits):
            passes = (self.latch() - first + self.waits - 1) // poll
            began = first + (passes * poll if passes > 0 else 0)
            seen = began + second + self.service
            between = self.latch() - began <= second - self.waits
            self.take()
            if between and seen >= other:
                self.by_other = True
                return seen
            first = began + poll + self.service
            end = first if flag <= first else first + (flag - first + poll - 1) // poll * poll
        return end

    def code(self, begin: int, piece: Piece) -> int:
        if self.calm(begin + piece.last):
            self.mark, self.second_mark = begin + piece.calm_first, begin + piece.calm_second
            return begin + piece.length
        place = self.latch() - begin - piece.first
        if place < 0:
            place = 0
        self.mark, self.second_mark = begin + piece.first_marks[place], begin + piece.second_marks[place]
        self.take()
        return begin + piece.lengths[place]

    def run(self, begin: int, cycles: int) -> int:
        end = begin + cycles
        while not self.calm(end):
            end += self.service
            self.take()
        return end
