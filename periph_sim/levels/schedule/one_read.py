"""One read of one scenario: its START goes in; when everything happens in it comes out, as `read` tells it for many.

Wait by wait; or, where no interrupt comes in it, as it was kept of a read that was alike.
"""

# core: compiled

from __future__ import annotations

from typing import Annotated, final

from .kept import BYTES, EDGES, NOTHING, Memory
from .kept_margins import KeptMargins
from .one_lane import FAR, Lane, Piece
from .terms import Terms
from .value_range import ValueRange

AAS, AGAIN, RRDY, SDIR, NEEDS = range(5)  # places of the bus edges


@final
class OneRead:
    """The read of one chip. margins, cleared: take its values.

    After `work`: hung; stop, again: ticks of the STOP and the repeated START; end: of the code behind it, off, ready:
    as its marks; held, response: ticks. let_go: where it hangs, when SCL is let go for ever.
    """

    poll: int
    refused: int
    eighth: int
    _edges: Annotated[list[int], 128]
    _let_gos: Annotated[list[int], BYTES]
    _rises: Annotated[list[int], BYTES]
    _landed: Annotated[list[int], BYTES]
    _seen: int
    _low: int
    _poll_two: int
    _second: int
    _release: int

    def __init__(self, terms: Terms, number: int, lane: Lane, margins: ValueRange, cleared: ValueRange) -> None:
        bus, code = terms.bus[number], terms.reads[number]
        self._lane, self._margins, self._cleared = lane, margins, cleared
        edges = [bus.aas, bus.again, bus.rrdy, bus.sdir, *bus.needs, bus.stop]
        self._edges = [*edges, *[0] * (EDGES - len(edges))]
        self._memory = Memory(edges, terms.poll)
        self._count = len(bus.needs)
        self._pointer, self._clear, self._first = Piece(code.pointer), Piece(code.clear), Piece(code.first)
        self._more, self._after = [Piece(each) for each in code.more], Piece(code.after)
        self._seen, self._low = terms.seen, terms.low
        self.poll, self._poll_two, self._second = terms.poll, terms.poll_two, terms.second
        self._release = terms.release
        self.refused, self.eighth = bus.refused, bus.eighth
        self._let_gos, self._rises, self._landed = [0] * BYTES, [0] * BYTES, [0] * BYTES
        self._clock = 0
        self._kept, self._start, self._cycle = NOTHING, 0, 0  # of the last read; NOTHING: it went wait by wait
        self.written = 0
        self.hung = self.plain = False
        self.stop = self.again = self.end = self.off = self.ready = self.held = self.response = self.let_go = 0

    def of_clock(self, number: int) -> None:
        """The lane has another clock, the number-th, from 1 on."""
        self._clock = number
        self._memory.of_clock(self._lane.num, self._lane.den)

    def _flag(self, place: int, cycle: int, rest: int) -> int:
        """The cycle of the flag that this edge sets."""
        memory = self._memory
        return cycle + memory.whole[place] + self._seen + (1 if memory.part[place] > rest else 0)

    # The read -------------------------------------------------------------------------

    def serve(self, start: int, cycle: int, rest: int, first: int, last: int) -> None:
        """start: tick of the START; cycle, rest: c and r of it, as in `kept`. first: fetch of the AAS wait.

        last: tick at which the run ends; values are taken of reads that are over by then.
        """
        lane = self._lane
        addressed_at = self._flag(AAS, cycle, rest)
        addressed = lane.wait(first, addressed_at, self.poll, 0)
        kept = self._memory.find(rest, addressed - addressed_at)
        stop = start + self._edges[self._count + NEEDS]
        if kept.of == self._clock and lane.calm(cycle + kept.end) and stop <= last:
            self.hung, self.plain, self.held, self.response = False, True, 0, self._low
            self.stop, self.again, self.written = stop, start + self._edges[AGAIN], kept.cleared_most - rest
            self.end, self.off, self.ready = cycle + kept.end, cycle + kept.off, cycle + kept.ready
            self._cleared.take_part(self.written)
            self._kept, self._start, self._cycle = kept, start, cycle
            self._margins.count += self._count
            if self._margins.moved_by(kept.margins.most - rest, kept.margins.least - rest):
                if kept.margins.alone:
                    kept.margins.take(self._margins, lane, start, cycle)
                else:
                    self._restore()
                    self._measure()
            return
        number, self._kept = lane.number, NOTHING
        self._work(start, cycle, rest, addressed, last)
        self.plain = lane.number == number and not self.hung and not self.held and self.response == self._low
        if self.plain and kept is not NOTHING:
            kept.of, kept.end, kept.off, kept.ready = (
                self._clock,
                self.end - cycle,
                self.off - cycle,
                self.ready - cycle,
            )
            kept.cleared_most = self.written + rest
            for byte in range(self._count + 1):
                kept.landed[byte] = self._landed[byte] - cycle
            kept.margins.clear(lane.den)
            self.keep_margins(kept.margins, start, cycle)

    def _work(self, start: int, cycle: int, rest: int, addressed: int, last: int) -> None:
        """Wait by wait, from the fetch that finds AAS on."""
        lane, poll_two, count = self._lane, self._poll_two, self._count
        asked_at = self._flag(SDIR, cycle, rest)
        self.hung = addressed >= self._flag(AGAIN, cycle, rest)
        if self.hung:  # AAS rises again with the read address, and SDIR with it
            addressed = lane.wait(addressed, asked_at, self.poll, 0)
        begun = lane.code(addressed, self._pointer)
        pointer = lane.wait(begun, self._flag(RRDY, cycle, rest), self.poll, 0)
        begun = lane.code(pointer, self._clear)
        self.written = (start + self._edges[SDIR]) * lane.den - lane.second_mark * lane.num
        self._cleared.take_part(self.written)
        self.again = start + self._edges[AGAIN]
        if lane.mark >= asked_at:
            self.hung = True
        if self.hung:
            self.let_go = start + self._edges[NEEDS] + self._low
            return
        begun = lane.code(lane.wait(begun, asked_at, self.poll, 0), self._first)
        landed = lane.mark
        self.held, self.response = 0, self._low
        shift = 0  # by how much SCL was held so far, and with it all that comes
        most, least = -FAR, FAR  # parts of margins
        ready = over_at = 0
        lane.by_other = False
        for byte in range(count):
            needed = start + self._edges[NEEDS + byte] + shift
            from_here = lane.cycle_at(needed) + self._seen if shift else self._flag(NEEDS + byte, cycle, rest)
            let_go = rise = needed + self._low
            if landed >= from_here:
                rise = max(let_go, lane.tick(landed + self._release))
                shift += rise - let_go
                self.held = max(self.held, rise - let_go)
                if not byte:
                    self.response = rise - needed
            part = let_go * lane.den - landed * lane.num
            most, least = max(most, part), min(least, part)
            self._let_gos[byte], self._rises[byte], self._landed[byte] = let_go, rise, landed
            free = max(from_here, landed)
            if byte + 1 < count:
                ready = lane.wait(begun, free, poll_two, 0)
            else:
                self.stop = start + self._edges[NEEDS + count] + shift
                over_at = (lane.cycle_at(self.stop) + self._seen) if shift else self._flag(NEEDS + count, cycle, rest)
                ready = lane.split(begun, free, poll_two, self._second, over_at)
            if lane.by_other:
                landed = ready
            else:
                begun = lane.code(ready, self._more[byte])
                landed = lane.mark
        self._landed[count] = landed
        seen = ready if lane.by_other else lane.wait(begun + self._second, over_at, poll_two, 1)
        self.end = lane.code(seen, self._after)
        self.off, self.ready = lane.mark, lane.second_mark
        if self.stop <= last:
            self._margins.count += count
            if self._margins.moved_by(most, least):
                self._measure()

    # Margins of I2CDXR -------------------------------------------------------------------

    def _measure(self) -> None:
        """Compare those bytes whose margin may be a new worst or least one."""
        lane, margins = self._lane, self._margins
        for byte in range(self._count):
            let_go, landed = self._let_gos[byte], self._landed[byte]
            part = let_go * lane.den - landed * lane.num
            if margins.moved_by(part, part):
                value = lane.margin(let_go, landed)
                margins.take_all(value, value, 0)

    def _restore(self) -> None:
        """Fill in the bytes of the last read, where it went as one that is kept."""
        for byte in range(self._count + 1):
            self._let_gos[byte] = self._rises[byte] = self._start + self._edges[NEEDS + byte] + self._low
            self._landed[byte] = self._cycle + self._kept.landed[byte]

    def keep_margins(self, margins: KeptMargins, start: int, cycle: int) -> None:
        """Add the bytes of the last read, which has no interrupt. start, cycle: of the read or round that is kept."""
        if self._kept is not NOTHING:
            self._restore()
        lane, rest = self._lane, cycle * self._lane.num - start * self._lane.den
        for byte in range(self._count):
            let_go, landed = self._let_gos[byte], self._landed[byte]
            part = let_go * lane.den - landed * lane.num + rest
            margins.add(part, let_go - start, landed - cycle)
