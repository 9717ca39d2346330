"""Instructions that have not come yet: addresses as they are executed go in; the cycles that the CPU waits come out.

    program memory --units of 32 or 64 bits, one each so many cycles--> queue of four --> D2

Fetching goes on while instructions execute, until the queue is full; a discontinuity empties it. Only for memory with
wait states: without them a unit comes each cycle, which no instruction can outrun. A read of data in the same memory
may take its turn between two fetches.

Source: SPRU430F 4.2, 4.3; SPRUFB0D 2.2 (flash).
"""

# core: compiled

from __future__ import annotations

from typing import Annotated, final

DEPTH = 4  # units: the queue's; of flash with its prefetch two of 64 bits, and what the queue holds of a third
PACKED = 6 + DEPTH
LONG_AGO = 1 << 7  # cycles: nothing waits for what was then; a full queue takes 4 * 17 at most


@final
class FetchQueue:
    """expected: where the next instruction would stand without a discontinuity."""

    __slots__ = ("_bits", "_consumed", "_cycles", "_issued", "_newest", "_place", "_ready", "expected", "packed_queue")

    packed_queue: Annotated[list[int], PACKED]
    _consumed: Annotated[list[int], DEPTH]

    def __init__(self) -> None:
        self._consumed = [0] * DEPTH  # when each unit's place was free again
        self._place = DEPTH - 1  # bits of a unit's number that name its place
        self._newest = 0  # the last unit that was needed
        self._ready = 0  # when that one was there
        self._bits = 1  # of an address within a unit
        self._cycles = 1  # that a unit takes
        self._issued = 0  # when the last instruction was taken out of the queue
        self.expected = -1
        self.packed_queue = [0] * PACKED

    def pack(self, cycle: int) -> None:
        """Write to `packed_queue` what is in the queue, with times counted from this cycle; the past counts no more."""
        self.packed_queue[0], self.packed_queue[1] = self.expected, self._newest
        self.packed_queue[2], self.packed_queue[3] = self._bits, self._cycles
        self.packed_queue[4] = max(self._ready - cycle, -LONG_AGO)
        self.packed_queue[5] = max(self._issued - cycle, -LONG_AGO)
        for place in range(DEPTH):
            self.packed_queue[6 + place] = max(self._consumed[place] - cycle, -LONG_AGO)

    def begin(self, cycle: int, address: int, bits: int, first: int, later: int, depth: int) -> None:
        """A discontinuity, in memory whose units have 2**bits words. first, later: wait states of the units.

        depth: how many units come ahead, a power of 2. cycle: in which the instruction there would be executed, had its
        memory no wait states.
        """
        assert depth in (1, 2, 4)
        self._bits, self._cycles, self._place = bits, later + 1, depth - 1
        self._newest = address >> bits
        self._ready = cycle + first
        self._issued = cycle
        for place in range(DEPTH):
            self._consumed[place] = 0

    def wait(self, cycle: int, address: int, behind: int) -> int:
        """The cycles for which the instruction from `address` to `behind` is still to come in this cycle."""
        ready = self._need(behind - 1 >> self._bits)
        self.expected = behind
        self._issued = ready if ready > cycle else cycle
        return self._issued - cycle

    def _need(self, unit: int) -> int:
        """When a unit is there. What lies before it has been taken out of the queue by then."""
        place = self._place
        while self._newest < unit:
            if self._consumed[self._newest & place] < self._issued:
                self._consumed[self._newest & place] = self._issued
            self._newest += 1
            free = self._consumed[self._newest & place]
            self._ready = (free if free > self._ready else self._ready) + self._cycles
        return self._ready

    def read(self, cycle: int, waits: int) -> int:
        """Data are read from this memory in this cycle: for how long the read waits for a fetch that is under way.

        waits: its own wait states. The next fetch begins behind it.
        """
        place, ready, unit = self._place, self._ready, self._newest + 1
        while ready <= cycle and unit <= self._newest + place:
            free = self._consumed[unit & place]
            if free >= cycle or ready == cycle:
                break
            ready = (free if free > ready else ready) + self._cycles
            unit += 1
        begins = ready if ready > cycle else cycle
        self._consumed[unit & place] = begins + waits + 1
        return begins - cycle
