"""The pipeline of the C28x: cycles that an instruction waits in D2 for earlier ones, and for its own fetch.

    hazards        registers that an instruction needs early or writes late
    Pipeline       stalls for registers and words that an earlier instruction has not written yet
    FetchQueue     stalls for instructions from memory with wait states

Source: SPRU430F 4.2 to 4.4, 5.x; SPRUFB0D 2.2 (flash); TI wiki "C28x Pipeline Conflicts"; the columns `reads` and
`writes` of `encodings.toml`.
"""

# core: compiled

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Annotated, final

from ...core.state import State
from .encodings import SP_FIELD, Encoding
from .execution.cpu import Operation

# Hazards ----------------------------------------------------------------------------------------------------------
#
# Two masks: XAR0 to XAR7 are bits 0 to 7, DP is 8, SP 9; 10 is XAR(ARP).
#
#     needs   read, or written, in phase D2
#     makes   written in phase E, three phases after D2
#
# An instruction of several cycles does its last operation in the last of them (PUSH loc16 reads, then writes), with two
# exceptions. A jump or call passes D2 once, in its first cycle; in the others the CPU fetches from the target
# [SPRU430F 4.3.2], while the pushed words go on to W. And some instructions stay in D2 until they have left phase E or
# W themselves, as their cycles show: NORM takes N + 4 for N + 1 passes, one per pass and the three phases from D2 to
# E; POP DP:ST1 takes 5, D2 to W, since ST1 applies from the next instruction on; PWRITE takes N + 5, one per pass and
# the four phases to W. After these nothing waits.

DP, SP, BY_ARP = 1 << 8, 1 << 9, 1 << 10
REGISTERS = 0x3FF  # without XAR(ARP)
NUMBERED = re.compile(r"X?AR([0-7])$")
FIELDS = {"ARn": "n", "XARn": "n", "ARm": "m"}
HELD = frozenset(["NORM", "PWRITE"])  # mnemonics; and POP of ST1
BY_ARP_FROM, PUSHES, POPS, CIRCULAR = 0xAE, 0xBD, 0xBE, 0xBF


@cache
def hazards(encoding: Encoding, field: int, n: int, m: int) -> tuple[int, int]:
    """Return (needs, makes) for the values of fields l, n and m, -1 if absent."""
    numbers = {"n": n, "m": m}
    needs = _in_phase("D2", (*encoding.reads, *encoding.writes), numbers)
    makes = 0 if is_held(encoding) else _in_phase("E", encoding.writes, numbers)
    if field >= 0:
        needs |= addressing(field)
        register = 1 << (field & 7) if 0xA0 <= field < 0xA8 else SP if field == SP_FIELD else 0  # if it names one
        if "r" in encoding.accesses:
            needs |= register
        if "w" in encoding.accesses:
            makes |= register
    return needs, makes & REGISTERS


def is_held(encoding: Encoding) -> bool:
    """Return True if it stays in D2 until its writes are done."""
    return encoding.mnemonic in HELD or (encoding.mnemonic == "POP" and "ST1@D2" in encoding.writes)


def writes_at_once(encoding: Encoding) -> bool:
    """Return True if its memory write leaves D2 in the first of its cycles."""
    return "PC" in encoding.writes or is_held(encoding)


def _in_phase(phase: str, places: Iterable[str], numbers: Mapping[str, int]) -> int:
    """Return the registers used in a phase, from places of the table."""
    mask = 0
    for place in places:
        name, _, when = place.partition("@")
        if when != phase:
            continue
        numbered = NUMBERED.match(name)
        if numbered:
            mask |= 1 << int(numbered[1])
        elif name in FIELDS:
            mask |= 1 << numbers[FIELDS[name]]
        elif name in ("XAR[ARP]", "AR[ARP]"):
            mask |= BY_ARP
        elif name in ("DP", "SP"):
            mask |= DP if name == "DP" else SP
    return mask


def addressing(field: int) -> int:
    """Return the registers that an operand's address depends on [SPRU430F Table 5-1]."""
    if field < 0x40:
        return DP
    if field < 0x80 or field in (PUSHES, POPS):
        return SP
    if field >= 0xC0 or 0x80 <= field < 0x90:
        return 1 << (field & 7)
    if field < 0xA0:
        return 1 << (field & 7) | 1 << (field >> 3 & 1)  # AR0 or AR1 as index
    if field < BY_ARP_FROM:
        return 0
    if field == CIRCULAR:
        return 1 << 6 | 1 << 1
    return BY_ARP | (1 if field in (0xAE, 0xAF, 0xBB, 0xBC) else 0)


# Fetch queue ------------------------------------------------------------------------------------------------------

DEPTH = 4  # units in the queue; for flash with prefetch two of 64 bits, and part of a third
QUEUE_PACKED = 6 + DEPTH
LONG_AGO = 1 << 7  # cycles: older times have no effect; a full queue takes 4 * 17 at most


@final
class FetchQueue:
    """The instruction fetch queue of four units of 32 or 64 bits, one of which arrives each `_cycles`.

    Fetching continues while instructions execute, until the queue is full; a discontinuity empties it. Only for memory
    with wait states: without them one unit arrives per cycle, faster than any instruction needs. A data read in the
    same memory may be inserted between two fetches.

    expected: address of the next instruction if there is no discontinuity.
    """

    STATE = State("expected _bits _cycles _newest _place", cycles="_ready _issued _consumed")

    def __init__(self) -> None:
        self._consumed: Annotated[list[int], DEPTH] = [0] * DEPTH  # cycle when each unit's slot was free again
        self._place = DEPTH - 1  # mask: bits of a unit's number that select its slot
        self._newest = 0  # the last unit needed
        self._ready = 0  # cycle when that unit was available
        self._bits = 1  # address bits within a unit
        self._cycles = 1  # cycles per unit
        self._issued = 0  # cycle when the last instruction left the queue
        self.expected = -1
        self.packed_queue: Annotated[list[int], QUEUE_PACKED] = [0] * QUEUE_PACKED

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


# Stalls -----------------------------------------------------------------------------------------------------------

LANE = 10  # bits of `pending`, as many as REGISTERS has
ONCE_EACH = 0x100401  # bit 0 of each lane
BEHIND = 3  # cycles that the next instruction waits
STORES = 4  # stores kept; at most one per cycle, two per instruction
STORES_PACKED = 1 + 3 * STORES


@final
class Pipeline:
    """Stalls in D2: 3 cycles directly after the write of a register or word, one less for each cycle between.

    An instruction writes registers in E, three phases after D2, and memory in W; `hazards` gives the cycle in which one
    of several cycles writes. Time here excludes wait states of memory, which stop writer and reader alike.

    pending: 3 lanes of 10 bits, the registers written in 1, 2, 3 cycles.
    clock: cycles issued. until: from this cycle on no read waits for a word.
    """

    STATE = State("enabled pending clock until _at _first _last _ready")

    def __init__(self) -> None:
        self.enabled = True
        self._first: Annotated[list[int], STORES] = [0] * STORES
        self._last: Annotated[list[int], STORES] = [0] * STORES
        self._ready: Annotated[list[int], STORES] = [0] * STORES
        self.packed_stores: Annotated[list[int], STORES_PACKED] = [0] * STORES_PACKED
        self.clock = self._at = 0
        self.drain()

    def drain(self) -> None:
        """Empty the pipeline: at an interrupt, or a return from one."""
        self.pending = 0
        self.until = self.clock

    def pack(self) -> None:
        """Write pending registers and stores to `packed_stores`, with times relative to now."""
        self.packed_stores[0] = self.pending
        place: int = 1
        for at in range(STORES):
            if self._ready[at] > self.clock:
                self.packed_stores[place] = self._first[at]
                self.packed_stores[place + 1] = self._last[at]
                self.packed_stores[place + 2] = self._ready[at] - self.clock
                place += 3
        for rest in range(place, STORES_PACKED):
            self.packed_stores[rest] = 0

    def stall(self, f: Operation, arp: int) -> int:
        """Return the cycles that an instruction waits in D2 for registers."""
        needs = f.needs & REGISTERS
        if f.needs & BY_ARP:
            needs |= 1 << arp
        pending = self.pending
        if not needs * ONCE_EACH & pending:
            return 0
        if needs << 2 * LANE & pending:
            waits: int = 3
        elif needs << LANE & pending:
            waits = 2
        else:
            waits = 1
        self._pass(waits)
        return waits

    def issued(self, f: Operation, cycles: int) -> None:
        """Advance by the cycles that an instruction spent in D2."""
        self._pass(cycles)
        if self.enabled:
            self.pending |= f.makes << 2 * LANE

    def wrote(self, address: int, words: int, cycle: int) -> None:
        """Record words written by the current instruction. cycle: which of its cycles left D2 with them, from 1."""
        if self.enabled:
            at = self._at = self._at + 1 & STORES - 1
            self._first[at], self._last[at] = address, address + words - 1
            self._ready[at] = self.until = self.clock + cycle + BEHIND

    def read(self, address: int, words: int) -> int:
        """Return the cycles that the current instruction, reading these words, waits for earlier writes."""
        waits = 0
        at: int
        for at in range(STORES):
            if self._first[at] < address + words and address <= self._last[at]:
                more = self._ready[at] - self.clock
                if more > waits:
                    waits = more
        if waits > 0:
            self._pass(waits)
            return waits
        return 0

    def _pass(self, cycles: int) -> None:
        self.clock += cycles
        self.pending = self.pending >> LANE * cycles if cycles < 3 else 0
