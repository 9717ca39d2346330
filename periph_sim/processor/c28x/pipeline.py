"""The pipeline of the C28x: the cycles that an instruction waits in D2, the second phase of decoding.

An instruction waits for registers and words that earlier instructions write, and for its own fetch.

    hazards        the registers that an instruction needs in D2, and those that it writes only in the later phase E
    Pipeline       stalls for registers and memory words that an earlier instruction has not written yet
    FetchQueue     stalls because the instruction itself is fetched from memory with wait states

Source: SPRU430F 4.2 to 4.4, 5.x; SPRUFB0D 2.2 (flash); TI wiki "C28x Pipeline Conflicts"; the columns `reads` and
`writes` of `encodings.toml`.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Annotated, final

from ...core.state import State
from .encodings import SP_FIELD, Encoding
from .execution.cpu import Operation

# Hazards ----------------------------------------------------------------------------------------------------------
#
# Masks of registers: bits 0 to 7 are XAR0 to XAR7, bit 8 is DP, bit 9 is SP, and bit 10 is XAR(ARP), the XARn that the
# field ARP selects.
#
#     needs   registers that an instruction reads or writes in phase D2
#     makes   registers that an instruction writes in phase E, three phases after D2
#
# An instruction of several cycles makes its last access in its last cycle: PUSH loc16 first reads, then writes.
#
# Jumps and calls are an exception: they leave D2 after their first cycle, and the words that a call pushes go on to
# phase W. In the other cycles of a jump or call, the CPU fetches from the target [SPRU430F 4.3.2].
#
# Instructions for which `is_held` is True are another exception: they stay in D2 until their own writes in E or W are
# done, so later instructions need not wait for the results. The cycles of such an instruction include this time:
#
#     NORM after RPT     N + 4 cycles: one for each of N + 1 passes, and three from D2 to E
#     PWRITE after RPT   N + 5 cycles: one for each of N + 1 passes, and four from D2 to W
#     POP DP:ST1         5 cycles: one, and four from D2 to W, because the new ST1 applies to the next instruction

DP, SP, BY_ARP = 1 << 8, 1 << 9, 1 << 10
REGISTERS = 0x3FF  # mask of XAR0 to XAR7, DP and SP
NAMES = (*(f"XAR{n}" for n in range(8)), "DP", "SP")  # of the bits of REGISTERS, from bit 0 on
# For a name in the columns `reads` and `writes`, the mask of the register.
MASKS = {name: 1 << bit for bit, name in enumerate(NAMES)} | {f"AR{n}": 1 << n for n in range(8)}
MASKS |= {"XAR[ARP]": BY_ARP, "AR[ARP]": BY_ARP}
FIELDS = {"ARn": "n", "XARn": "n", "ARm": "m"}
HELD = frozenset(["NORM", "PWRITE"])  # mnemonics for which `is_held` is True; it is also True for POP of ST1
BY_ARP_FROM, PUSHES, POPS, CIRCULAR = 0xAE, 0xBD, 0xBE, 0xBF
MOVING = (0xAE, 0xAF, 0xB9, 0xBA, 0xBB, 0xBC, CIRCULAR)  # values of field l that change XAR(ARP) or XAR6


@cache
def hazards(encoding: Encoding, field: int, n: int, m: int) -> tuple[int, int]:
    """Return the masks (needs, makes) of an instruction. field, n, m: its fields l, n and m; -1 for an absent field."""
    numbers = {"n": n, "m": m}
    needs = registers_in((*encoding.reads, *encoding.writes), numbers, "D2")
    makes = 0 if is_held(encoding) else registers_in(encoding.writes, numbers, "E")
    if field >= 0:
        needs |= addressing(field)
        register = 1 << (field & 7) if 0xA0 <= field < 0xA8 else SP if field == SP_FIELD else 0  # @XARn, @ARn or @SP
        if "r" in encoding.accesses:
            needs |= register
        if "w" in encoding.accesses:
            makes |= register
    return needs, makes & REGISTERS


def is_held(encoding: Encoding) -> bool:
    """Return True if an instruction of this form stays in D2 until its writes are done."""
    return encoding.mnemonic in HELD or (encoding.mnemonic == "POP" and "ST1@D2" in encoding.writes)


def writes_at_once(encoding: Encoding) -> bool:
    """Return True if the memory write of an instruction of this form passes D2 in the first cycle."""
    return "PC" in encoding.writes or is_held(encoding)


def registers_in(places: Iterable[str], numbers: Mapping[str, int], phase: str = "") -> int:
    """Return the mask of the registers among these places.

    places: entries of the columns `reads` and `writes`, such as "XARn@D2".
    numbers: the values of the fields n and m, by "n" and "m".
    phase: the phase of the pipeline, such as "D2", in which the registers are used; "" for all phases.
    """
    mask = 0
    for place in places:
        name, _, when = place.partition("@")
        if phase in ("", when):
            mask |= 1 << numbers[FIELDS[name]] if name in FIELDS else MASKS.get(name, 0)
    return mask


def addressing(field: int) -> int:
    """Return the mask of the registers from which the address of an operand is computed [SPRU430F Table 5-1].

    field: the value of field l, which encodes the operand.
    """
    if field < 0x40:
        return DP
    if field < 0x80 or field in (PUSHES, POPS):
        return SP
    if field >= 0xC0 or 0x80 <= field < 0x90:
        return 1 << (field & 7)
    if field < 0xA0:
        return 1 << (field & 7) | 1 << (field >> 3 & 1)  # AR0 or AR1 is the index
    if field < BY_ARP_FROM:
        return 0
    if field == CIRCULAR:
        return 1 << 6 | 1 << 1
    return BY_ARP | (1 if field in (0xAE, 0xAF, 0xBB, 0xBC) else 0)


# Fetch queue ------------------------------------------------------------------------------------------------------

DEPTH = 4  # largest number of blocks in the fetch queue
QUEUE_PACKED = 6 + DEPTH  # length of `FetchQueue.packed_queue`
LONG_AGO = 1 << 7  # cycles; an older event has no effect, because the queue is filled within 4 * 32 cycles


@final
class FetchQueue:
    """The instruction fetch queue of up to four blocks of 32 or 64 bits. One block arrives every `_cycles` cycles.

    A block contains the words that one fetch reads. Its number is its address divided by its length.

    Fetching continues while instructions execute, until the queue is full; a discontinuity, such as a jump, empties the
    queue. The queue is used only for memory with wait states. From other memory, a block arrives in each cycle, so no
    instruction waits. A data read of the same memory may be inserted between two fetches.

    expected: the address of the next instruction if there is no discontinuity.
    packed_queue: the state that the last call of `pack` has written.
    """

    STATE = State("expected _bits _cycles _newest _place", cycles="_ready _issued _consumed")

    def __init__(self) -> None:
        self._consumed: Annotated[list[int], DEPTH] = [0] * DEPTH  # for each slot, the cycle from which on it is free
        self._place = DEPTH - 1  # mask: the slot of block n is slot `n & _place` of `_consumed`
        self._newest = 0  # the number of the last block that an instruction needed: address >> _bits
        self._ready = 0  # the cycle from which on block `_newest` is available
        self._bits = 1  # number of address bits within a block
        self._cycles = 1  # number of cycles in which one block arrives
        self._issued = 0  # the cycle at which the last instruction left the queue
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
        """Begin to fetch at an address after a discontinuity.

        cycle: the cycle at which the instruction at the address would execute without wait states.
        bits: a block has 2 ** bits words.
        first, later: the wait states of the first block, and of each later one.
        depth: the maximum number of blocks in the queue, 1, 2 or 4.
        """
        assert depth in (1, 2, 4)
        self._bits, self._cycles, self._place = bits, later + 1, depth - 1
        self._newest = address >> bits
        self._ready = cycle + first
        self._issued = cycle
        for place in range(DEPTH):
            self._consumed[place] = 0

    def wait(self, cycle: int, address: int, behind: int) -> int:
        """Return the number of cycles, from `cycle` on, until the instruction at `address` is fetched.

        behind: the address after the instruction.
        """
        ready = self._need(behind - 1 >> self._bits)
        self.expected = behind
        self._issued = ready if ready > cycle else cycle
        return self._issued - cycle

    def _need(self, block: int) -> int:
        """Return the cycle at which a block is available. Remove all earlier blocks from the queue."""
        place = self._place
        while self._newest < block:
            if self._consumed[self._newest & place] < self._issued:
                self._consumed[self._newest & place] = self._issued
            self._newest += 1
            free = self._consumed[self._newest & place]
            self._ready = (free if free > self._ready else self._ready) + self._cycles
        return self._ready

    def read(self, cycle: int, waits: int) -> int:
        """Return the cycles that a data read of this memory waits for the fetch in progress.

        waits: the wait states of the read itself. The next fetch begins after the read.
        """
        place, ready, block = self._place, self._ready, self._newest + 1
        while ready <= cycle and block <= self._newest + place:
            free = self._consumed[block & place]
            if free >= cycle or ready == cycle:
                break
            ready = (free if free > ready else ready) + self._cycles
            block += 1
        begins = ready if ready > cycle else cycle
        self._consumed[block & place] = begins + waits + 1
        return begins - cycle


# Stalls -----------------------------------------------------------------------------------------------------------

LANE = 10  # number of bits of each lane (part) of `Pipeline.pending`; a lane has one bit for each register in REGISTERS
ONCE_EACH = 0x100401  # bit 0 of each of the three lanes of `Pipeline.pending`
BEHIND = 3  # cycles that an instruction waits if it reads a word that the instruction directly before it writes
STORES = 4  # number of stores that are remembered; an instruction makes at most two, and at most one in a cycle
STORES_PACKED = 1 + 3 * STORES  # length of `Pipeline.packed_stores`


@final
class Pipeline:
    """Stalls in D2, in which an instruction waits for a register or word that an earlier instruction writes.

    The wait is 3 cycles directly after the earlier instruction; each cycle between the two instructions makes it one
    cycle shorter. Registers are written in phase E, three phases after D2, and memory in phase W. `clock` excludes the
    wait states of memory, because they stop all instructions in the pipeline.

    enabled: False if no instruction waits for registers and words of earlier instructions.
    pending: three masks of 10 bits, the lanes: the registers that will be written in 1, 2 and 3 cycles. The mask for 1
        cycle is in the lowest bits.
    clock: the number of cycles that instructions have spent in D2.
    until: the value of `clock` from which on no read waits for a word.
    packed_stores: the state that the last call of `pack` has written.
    """

    STATE = State("enabled pending clock until _at _first _last _ready")

    def __init__(self) -> None:
        self.enabled = True
        # For each of the last stores: its first and last address, and the value of `clock` from which on reads of these
        # words do not wait.
        self._first: Annotated[list[int], STORES] = [0] * STORES
        self._last: Annotated[list[int], STORES] = [0] * STORES
        self._ready: Annotated[list[int], STORES] = [0] * STORES
        self.packed_stores: Annotated[list[int], STORES_PACKED] = [0] * STORES_PACKED
        self.clock = self._at = 0
        self.drain()

    def drain(self) -> None:
        """Empty the pipeline, as an interrupt or a return from an interrupt does."""
        self.pending = 0
        self.until = self.clock

    def pack(self) -> None:
        """Write pending registers and stores to `packed_stores`, with times relative to `clock`."""
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
        """Return the cycles that an instruction waits in D2 for registers, and advance by these cycles.

        arp: the value of ARP.
        """
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
        """Advance by the cycles that an instruction spent in D2, and store which registers it will write."""
        self._pass(cycles)
        if self.enabled:
            self.pending |= f.makes << 2 * LANE

    def wrote(self, address: int, words: int, cycle: int) -> None:
        """Store which memory words the current instruction writes.

        cycle: the cycle of the instruction, counted from 1, in which the write passes phase D2.
        """
        if self.enabled:
            at = self._at = self._at + 1 & STORES - 1
            self._first[at], self._last[at] = address, address + words - 1
            self._ready[at] = self.until = self.clock + cycle + BEHIND

    def read(self, address: int, words: int) -> int:
        """Return the cycles that the current instruction waits for the words that it reads; advance by these cycles."""
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
