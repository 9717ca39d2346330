"""Pipeline stalls: cycles that an instruction waits in D2 for earlier ones.

An instruction writes registers in E, three phases after D2, and memory in W. An instruction that needs a register in D2
(`hazards`), or reads a word, still to be written by an earlier one waits: 3 cycles directly after it, one less for each
cycle between. `hazards` gives the cycle in which an instruction of several cycles writes.

    pending, 3 lanes of 10 bits    registers written in 1, 2, 3 cycles
    stored                         the last words written, and until when a read of them waits

Time here excludes wait states of memory, which stop writer and reader alike.
Source: SPRU430F 4.4.1, 4.4.2 with example 4-5; TI wiki "C28x Pipeline Conflicts".
"""

# core: compiled

from __future__ import annotations

from typing import Annotated, final

from ...core.state import State
from .execution.cpu import Operation
from .hazards import BY_ARP

LANE = 10  # bits
REGISTERS, ONCE_EACH = 0x3FF, 0x100401  # a lane; bit 0 of each
BEHIND = 3  # cycles that the next instruction waits
STORES = 4  # stores kept; at most one per cycle, two per instruction
PACKED = 1 + 3 * STORES


@final
class Pipeline:
    """clock: cycles issued. until: from this cycle on no read waits for a word."""

    STATE = State("enabled pending clock until _at _first _last _ready")

    __slots__ = ("_at", "_first", "_last", "_ready", "clock", "enabled", "packed_stores", "pending", "until")

    packed_stores: Annotated[list[int], PACKED]
    _first: Annotated[list[int], STORES]
    _last: Annotated[list[int], STORES]
    _ready: Annotated[list[int], STORES]

    def __init__(self) -> None:
        self.enabled = True
        self._first = [0] * STORES
        self._last = [0] * STORES
        self._ready = [0] * STORES
        self.packed_stores = [0] * PACKED
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
        for rest in range(place, PACKED):
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
