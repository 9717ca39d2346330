"""The instruction fetch queue: cycles that the CPU waits for instructions from memory with wait states.

    program memory --units of 32 or 64 bits, one per `_cycles`--> queue of four --> D2

Fetching continues while instructions execute, until the queue is full; a discontinuity empties it. Only for memory with
wait states: without them one unit arrives per cycle, faster than any instruction needs. A data read in the same memory
may be inserted between two fetches.

Source: SPRU430F 4.2, 4.3; SPRUFB0D 2.2 (flash).
"""

# core: compiled

from __future__ import annotations

from typing import Annotated, final

from ...core.state import State

DEPTH = 4  # units in the queue; for flash with prefetch two of 64 bits, and part of a third
PACKED = 6 + DEPTH
LONG_AGO = 1 << 7  # cycles: older times have no effect; a full queue takes 4 * 17 at most


@final
class FetchQueue:
    """expected: address of the next instruction if there is no discontinuity."""

    STATE = State("expected _bits _cycles _newest _place", cycles="_ready _issued _consumed")

    __slots__ = ("_bits", "_consumed", "_cycles", "_issued", "_newest", "_place", "_ready", "expected", "packed_queue")

    packed_queue: Annotated[list[int], PACKED]
    _consumed: Annotated[list[int], DEPTH]

    def __init__(self) -> None:
        self._consumed = [0] * DEPTH  # cycle when each unit's slot was free again
        self._place = DEPTH - 1  # mask: bits of a unit's number that select its slot
        self._newest = 0  # the last unit needed
        self._ready = 0  # cycle when that unit was available
        self._bits = 1  # address bits within a unit
        self._cycles = 1  # cycles per unit
        self._issued = 0  # cycle when the last instruction left the queue
        self.expected = -1
        self.packed_queue = [0] * PACKED

    def pack(self, cycle: int) -> None:
        """Write the queue's state to `packed_queue`, with times relative to this cycle."""
        self.packed_queue[0], self.packed_queue[1] = self.expected, self._newest
        self.packed_queue[2], self.packed_queue[3] = self._bits, self._cycles
        self.packed_queue[4] = max(self._ready - cycle, -LONG_AGO)
        self.packed_queue[5] = max(self._issued - cycle, -LONG_AGO)
        for place in range(DEPTH):
            self.packed_queue[6 + place] = max(self._consumed[place] - cycle, -LONG_AGO)

    def begin(self, cycle: int, address: int, bits: int, first: int, later: int, depth: int) -> None:
        """Start after a discontinuity, in memory with 2**bits words per unit. first, later: wait states of the units.

        depth: units fetched ahead, a power of 2. cycle: when the instruction there would execute if the memory had no
        wait states.
        """
        assert depth in (1, 2, 4)
        self._bits, self._cycles, self._place = bits, later + 1, depth - 1
        self._newest = address >> bits
        self._ready = cycle + first
        self._issued = cycle
        for place in range(DEPTH):
            self._consumed[place] = 0

    def wait(self, cycle: int, address: int, behind: int) -> int:
        """Return the cycles until the instruction from `address` to `behind` (exclusive) is available."""
        ready = self._need(behind - 1 >> self._bits)
        self.expected = behind
        self._issued = ready if ready > cycle else cycle
        return self._issued - cycle

    def _need(self, unit: int) -> int:
        """Return the cycle when a unit is available. Earlier units have left the queue by then."""
        place = self._place
        while self._newest < unit:
            if self._consumed[self._newest & place] < self._issued:
                self._consumed[self._newest & place] = self._issued
            self._newest += 1
            free = self._consumed[self._newest & place]
            self._ready = (free if free > self._ready else self._ready) + self._cycles
        return self._ready

    def read(self, cycle: int, waits: int) -> int:
        """Read data from this memory: return the cycles that the read waits for a fetch in progress.

        waits: the read's own wait states. The next fetch begins after it.
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
