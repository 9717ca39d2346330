"""Stalls between instructions: each one as it enters D2 goes in; the cycles that it waits there come out.

An instruction writes registers in E, three phases behind D2, and memory in W. Who needs a register in D2 (`hazards`),
or reads a word, that an earlier one is still to write waits: 3 cycles directly behind it, one less for each cycle
between. `hazards` says in which of its cycles an instruction of several writes.

    pending, 3 lanes of 10 bits    registers that come in 1, 2, 3 cycles more
    stored                         the last words that were written, and until when a read of them waits

Time is counted here without wait states of memory, which stop writer and reader alike.
Source: SPRU430F 4.4.1, 4.4.2 with example 4-5; TI wiki "C28x Pipeline Conflicts".
"""

# core: compiled

from __future__ import annotations

from typing import Annotated, final

from .execution.registers import Operation
from .hazards import BY_ARP

LANE = 10  # bits
REGISTERS, ONCE_EACH = 0x3FF, 0x100401  # a lane; bit 0 of each
BEHIND = 3  # cycles that the next instruction waits
STORES = 4  # that are remembered; a cycle has one, an instruction two at most
PACKED = 1 + 3 * STORES


@final
class Pipeline:
    """clock: cycles that have been issued. until: behind this one no read waits for a word."""

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
        """Nothing is under way any more: an interrupt, or a return from one."""
        self.pending = 0
        self.until = self.clock

    def pack(self) -> None:
        """Write to `packed_stores` what is under way, with times counted from now."""
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
        """An instruction enters D2: the cycles that it waits there for registers."""
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
        """It has been in D2 for so many cycles."""
        self._pass(cycles)
        if self.enabled:
            self.pending |= f.makes << 2 * LANE

    def wrote(self, address: int, words: int, cycle: int) -> None:
        """The present instruction writes these words. cycle: which of its cycles, from 1 on, left D2 with them."""
        if self.enabled:
            at = self._at = self._at + 1 & STORES - 1
            self._first[at], self._last[at] = address, address + words - 1
            self._ready[at] = self.until = self.clock + cycle + BEHIND

    def read(self, address: int, words: int) -> int:
        """The present instruction reads these words: the cycles that it waits for earlier writes of any of them."""
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
