"""The C28x of an image on a unit's bus: executes instructions, makes accesses, and updates the interrupt logic.

    Engine --load16, store16--> Ram | Bus | UnmappedMemory: flash, and frames that are not modelled
           --ST1, IER, IFR----> CpuInterrupts

Accesses are made in the present cycle; `access_at` returns beforehand the cycle for an operand.
"""

# core: compiled

from __future__ import annotations

from typing import Annotated, Protocol, final

from ...c28x.decoder import decode_at
from ...c28x.delay_slots import late_results, not_kept
from ...c28x.execution.engine import PAGE, Engine
from ...c28x.execution.fpu_pipeline import arrive, delay
from ...c28x.execution.operations import operation
from ...c28x.execution.registers import (
    ARP,
    ARP_MASK,
    CODE,
    READ_ONLY,
    READS,
    REGISTER,
    ST1_RESET,
    Cpu,
    IllegalOperation,
    Operation,
)
from ...c28x.fetch_queue import PACKED as QUEUE_PACKED
from ...c28x.pipeline import PACKED as STORES_PACKED
from ...core.chip import Note
from ...core.state import State
from ...f28335.cpu.interrupts import CONTEXT_SP, EALLOW, INTM, frame_of
from ...f28335.memory.address_space import Content, area_at
from ...f28335.memory.ram import Ram, block_at
from ...f28335.pie.register_map import VECTOR_TABLE
from ...f28335.system_control import register_map as clocks_map
from ...f28335.system_options import SystemOptions
from ...form.c_types import UInt16
from ..processor import Processor
from .elsewhere import BOOT_ROM, UnmappedMemory
from .instruction_timing import InstructionTiming
from .polls import PollSkipper
from .variable_records import VariableRecords

WATCHDOG_KEY = clocks_map.BASE + clocks_map.WDKEY.offset
RAM_FROM, RAM_TO = 0x8000, 0x1_0000  # without waits, as M0 and M1 below
LOW_RAM = 0x800
STACK_FIELDS, BEHIND_STACK_FIELDS = 0x40, 0x80  # operand fields *-SP[n]
PUSHES, POPS = 0xBD, 0xBE  # *SP++, *--SP
TIMING = 38  # index in a state at which the pipeline's part begins
PACKED = TIMING + STORES_PACKED + QUEUE_PACKED
WAITED_FROM = 0xC000  # L4 to L7, as program memory
L0_AGAIN, L4_AGAIN = 0x3F_8000, 0x3F_C000  # second addresses of L0 to L3
MIRROR = L0_AGAIN - 0x8000


class UnwrittenReads(Protocol):
    """A subscriber to the first read of each unwritten word."""

    def read_unwritten(self, address: int) -> None: ...


def in_plain_ram(address: int) -> bool:  # core: noexcept
    return address < LOW_RAM or RAM_FROM <= address < RAM_TO


@final
class ImageCpu(Engine):
    """watched: receives writes to some words of memory. reads_unwritten: receives reads of unwritten words.

    ended: ESTOP0 was reached.

    returning, idling: IRET or IDLE was executed, which the program completes.
    """

    STATE = State("elsewhere timing polls ended returning idling _tested _kept _written _slots_seen watched")

    elsewhere: UnmappedMemory
    _packed: Annotated[list[int], PACKED]
    _kept: Annotated[list[int], PACKED]
    _written: Annotated[list[UInt16], RAM_TO]

    def __init__(
        self, processor: Processor, options: SystemOptions, skip_polls: bool = True, keeps_decoded: bool = True
    ) -> None:
        self._core = processor.interrupts.core
        super().__init__()
        self.keeps_decoded = keeps_decoded
        self._slots_seen: set[int] = set()  # addresses of FPU instructions whose delay slots were checked
        self._processor = processor
        self._time = processor.time
        self._bus = processor.bus
        self._ram: Ram = processor.bus.ram
        self.elsewhere = UnmappedMemory(self._core, processor.notes)
        self.timing = InstructionTiming(self._core, options, self.elsewhere)
        self._pipeline = self.timing.pipeline
        self._options = options
        self._delays = options.fpu_delay_slot.unrecorded() == "old_value"
        self._decoding = False
        self._tested = 0  # bits that the present instruction tests in its operand
        self._written = [0] * RAM_TO  # 1 for a word that was written
        self._packed = [0] * PACKED  # the present state, see `state`
        self._kept = [0] * PACKED  # the state at the last call of `is_as_before`
        self.watched: VariableRecords | None = None
        self.polls = PollSkipper(self._time, self._core, skip_polls)
        self.reads_unwritten: UnwrittenReads | None = None
        self.reset()

    def reset(self) -> None:
        """Set the registers as the boot ROM leaves them; memory keeps its contents."""
        Cpu.__init__(self)
        self.left = 0
        self.timing.drain()
        self.polls.forget()
        self._core.st1 = ST1_RESET
        self.ended = self.returning = self.idling = False

    # Memory -------------------------------------------------------------------------

    def fill(self, address: int, value: int) -> None:
        """Set a word before the program begins."""
        if L0_AGAIN <= address < L4_AGAIN:
            address -= MIRROR
        if block_at(address) is not None:
            self._ram.put(address, value)
            self._written[address] = 1
        else:
            self.elsewhere.fill(address, value)

    def load16(self, address: int) -> int:
        if in_plain_ram(address):
            if self._pipeline.clock < self._pipeline.until:
                self.timing.wait_for_word(address, 1)
            value = self._ram.word(address)
            if not value and not self._written[address]:
                self._unwritten(address)
            return value
        return self._load(address, 16)

    def load32(self, address: int) -> int:
        if address & 1:
            address = self._even(address, "read from")
        if in_plain_ram(address):
            if self._pipeline.clock < self._pipeline.until:
                self.timing.wait_for_word(address, 2)
            value = self._ram.word32(address)
            if not value and not (self._written[address] and self._written[address + 1]):
                self._unwritten(address)
                self._unwritten(address + 1)
            return value
        return self._load(address, 32)

    def _load(self, address: int, width: int) -> int:
        bus, cycle, polls = self._bus, self._time.cycle, self.polls
        operand = bus.find(address, width)
        if operand is None:
            if block_at(address) is not None:
                return bus.read(cycle, address, width)
            if L0_AGAIN <= address < L4_AGAIN:
                return self.load16(address - MIRROR) if width == 16 else self.load32(address - MIRROR)
        if polls.replaying and polls.answer(cycle):
            return polls.answered()
        if operand is None:
            return self._load_elsewhere(address, width)
        if operand.meets:
            self._time.meet()
        if operand.recorded and self._tested and width == 16:
            value = bus.fetch(cycle, bus.naming(operand, self._tested)) >> operand.shift
        else:
            value = bus.load(cycle, operand, width)
        if polls.tracking:
            polls.note(operand, value)
        return value

    def _load_elsewhere(self, address: int, width: int) -> int:
        """Return words outside of the bus: flash, ROM, frames that are not modelled."""
        cycle = self._time.cycle
        value: int = self.elsewhere.read(cycle, address)
        if width == 32:
            value |= self.elsewhere.read(cycle, address + 1) << 16
        if self.polls.tracking:
            self.polls.note_elsewhere(address, value)
        return value

    def store16(self, address: int, value: int) -> None:
        if in_plain_ram(address):
            if self.polls.tracking and self._ram.word(address) != value:
                self.polls.changes(address, self._ram.word(address))
            self._pipeline.wrote(address, 1, self.written_in)
            self._ram.put(address, value)
            self._written[address] = 1
            if self._code[address >> PAGE] or self.watched is not None:
                self.written(address)
        else:
            self._store(address, value, 16)

    def store32(self, address: int, value: int) -> None:
        if address & 1:
            address = self._even(address, "written to")
        if in_plain_ram(address):
            if self.polls.tracking and self._ram.word32(address) != value:
                self.polls.changes(address, self._ram.word(address))
                self.polls.changes(address + 1, self._ram.word(address + 1))
            self._pipeline.wrote(address, 2, self.written_in)
            self._ram.put_word32(address, value)
            self._written[address] = self._written[address + 1] = 1
            if self._code[address >> PAGE] or self.watched is not None:
                self.written(address)
                self.written(address + 1)
        else:
            self._store(address, value, 32)

    def _even(self, address: int, how: str) -> int:
        """Return the even address of a 32-bit access [SPRU430F 5.11]. Raise IllegalOperation except on the stack."""
        on_stack = STACK_FIELDS <= self.field < BEHIND_STACK_FIELDS or self.field in (PUSHES, POPS)
        if self.ea == address and not on_stack:
            raise IllegalOperation(
                f"32 bits are {how} the odd address {address:#08x}; on the chip, {address & ~1:#08x}"
            )
        return address & ~1

    def _unwritten(self, address: int) -> None:
        if not self._written[address]:
            self._written[address] = 1
            if self.reads_unwritten is not None:
                self.reads_unwritten.read_unwritten(address)

    def _store(self, address: int, value: int, width: int) -> None:
        if address == WATCHDOG_KEY:
            self.polls.restart()
        else:
            self.polls.soil()
        operand = self._bus.find(address, width)
        if operand is not None:
            self._bus.save(self._time.cycle, operand, value, width)
        elif L0_AGAIN <= address < L4_AGAIN:
            if width == 16:
                self.store16(address - MIRROR, value)
            else:
                self.store32(address - MIRROR, value)
        elif block_at(address) is not None:
            self._bus.write(self._time.cycle, address, value, width)
        else:
            self._keep(address, value & 0xFFFF)
            if width == 32:
                self._keep(address + 1, value >> 16)

    def written(self, address: int) -> None:
        Engine.written(self, address)
        self._slots_seen.difference_update((address - 1, address))
        if self.polls.counting:
            self.polls.soil()  # it may be an instruction of the loop
        if L0_AGAIN <= address + MIRROR < L4_AGAIN:
            Engine.written(self, address + MIRROR)
            self._slots_seen.difference_update((address + MIRROR - 1, address + MIRROR))
        if self.watched is not None and address in self.watched.addresses:
            self.polls.soil()
            self.watched.written(address, self._time.cycle)

    def program16(self, address: int) -> int:
        if not self._decoding and (address >= WAITED_FROM or not in_plain_ram(address)):
            waits = self.elsewhere.fetches(address)[1]
            self.timing.late += waits + self.timing.read(self.pc, address, self._time.cycle, waits)
        if in_plain_ram(address):
            return self._ram.word(address)
        if L0_AGAIN <= address < L4_AGAIN:
            return self._ram.word(address - MIRROR)
        area = area_at(address)
        if area is None or area.content is Content.REGISTERS:
            raise IllegalOperation(f"code is fetched from {address:#08x}, where there is no memory")
        if address in BOOT_ROM:
            raise IllegalOperation(f"code is fetched from {address:#08x}: routines of the boot ROM are not modelled")
        return self.elsewhere.read(self._time.cycle, address)

    def word_at(self, address: int) -> int:
        """Return a word of code, without cost."""
        if L0_AGAIN <= address < L4_AGAIN:
            address -= MIRROR
        return self._ram.word(address) if in_plain_ram(address) else self.elsewhere.peek(address)

    def _keep(self, address: int, value: int) -> None:
        if self.elsewhere.write(self._time.cycle, address, value):
            self.written(address)

    # Time ---------------------------------------------------------------------------

    def _decode(self) -> Operation:
        pc = self.pc
        at = pc - MIRROR if L0_AGAIN <= pc < L4_AGAIN else pc
        if at != pc:
            self._code[at >> PAGE] = 1
        if in_plain_ram(at) and not self._written[at]:
            raise IllegalOperation(f"nothing was loaded to {pc:#08x}, or written there")
        self._decoding = True
        try:
            made = Engine._decode(self)
        finally:
            self._decoding = False
        self._prepare(made, self.word_at(made.address), self.word_at(made.address + 1))
        if made.encoding.kind == "fpu":
            self._look_at_slots(made)
        return made

    def _prepare(self, made: Operation, first: int, second: int) -> None:
        """Complete a decoded instruction of these words for execution."""
        self.timing.prepare(made)
        if made.encoding.kind == "fpu":
            found = decode_at(made.address, first, second)
            assert found is not None
            made.late = late_results(found)
        if self._delays:
            delay(made)

    def operation_of(self, address: int, first: int, second: int) -> Operation:
        """Return the instruction of these words at this address as `fetch` does; nothing is noted or kept."""
        found = decode_at(address, first, second)
        assert found is not None
        made = operation(found)
        self._prepare(made, first, second)
        return made

    def _look_at_slots(self, f: Operation) -> None:
        """Note each FPU result that the program does not wait for."""
        if f.address in self._slots_seen:
            return
        self._slots_seen.add(f.address)
        found = decode_at(f.address, self.word_at(f.address), self.word_at(f.address + 1))
        assert found is not None
        for text in not_kept(found, self.word_at):
            self._options.fpu_delay_slot.assume(self._core.touched)
            self._processor.notes.note(self._time.cycle, Note("duty", text, "SPRUEO2A section 3.2"))

    def _repeat(self) -> None:
        wanted = self.repeat
        self.repeat = self.timing.repeats(wanted)
        Engine._repeat(self)
        if wanted and self.left == 1:
            text = f"RPT precedes an instruction that cannot be repeated, at {self.pc:#08x}; it is executed once"
            self._processor.notes.note(self._time.cycle, Note("duty", text, "SPRU430F RPT"))

    def access_at(self, f: Operation, cycle: int) -> int:
        """Return the first cycle from this one in which the operand, or the one of *(0:16), can be accessed."""
        if self.ea != REGISTER and f.accesses and not in_plain_ram(self.ea):
            self._tested = f.tested
            cycle = self._access_at(cycle, self.ea, f.accesses & READS != 0, f.wide)
        if f.absolute and not in_plain_ram(f.c):
            self._tested = 0
            cycle = self._access_at(cycle, f.c + self.passes, f.absolute == READS, f.wide)
        return cycle

    def _access_at(self, cycle: int, address: int, reads: bool, wide: bool) -> int:
        operand = self._bus.find(address, 32 if wide else 16)
        if operand is not None:
            return self._bus.fetches_at(cycle, operand) if reads else self._bus.posts_at(cycle, operand)
        block = block_at(address)
        if block is not None:
            return cycle + (block.read_waits if reads else block.write_waits)
        return self._read_elsewhere_at(cycle, address) if reads else cycle

    def _read_elsewhere_at(self, cycle: int, address: int) -> int:
        waits = self.elsewhere.read_waits(address)
        return cycle + waits + self.timing.read(self.pc, address, cycle, waits)

    # Status held by the interrupt logic --------------------------------------------

    def whole_st1(self) -> int:
        return self._core.st1 & ~ARP_MASK | self.arp << ARP

    def put_st1(self, value: int) -> None:
        core = self._core
        self.polls.soil()
        core.st1 = value & ~READ_ONLY | core.st1 & READ_ONLY
        self.arp = value >> ARP & 7

    def whole_ier(self) -> int:
        return self._core.ier

    def put_ier(self, value: int) -> None:
        self.polls.soil()
        self._core.ier = value & 0xFFFF

    def whole_ifr(self) -> int:
        self.polls.soil()
        self._core.wake(self._time.cycle)
        return self._core.ifr

    def put_ifr(self, value: int) -> None:
        self.polls.soil()
        self._core.wake(self._time.cycle)
        self._core.ifr = value & 0xFFFF

    def and_ifr(self, mask: int) -> None:
        self.polls.soil()
        self._core.and_ifr(self._time.cycle, mask)

    def change_st1(self, mask: int, on: bool) -> None:
        cycle = self._time.cycle
        core = self._core
        if mask & INTM:
            self.polls.soil()
            if on:
                core.setc_intm(cycle)
            else:
                core.clrc_intm(cycle)
        if mask == EALLOW:
            core.set_eallow(cycle, on)
        elif on:
            core.st1 |= mask & ~INTM
        else:
            core.st1 &= ~(mask & ~INTM)

    def state(self) -> tuple[int, ...]:
        """Return all that a next instruction depends on, except memory and the chip: ACC, XAR0 to XAR7, others.

        From TIMING on: pending entries of the pipeline and the fetch queue.
        """
        self._pack()
        return tuple(self._packed)

    def is_as_before(self) -> bool:
        """Return True if the state is that of the last call."""
        self._pack()
        same: bool = True
        for place in range(PACKED):
            if self._kept[place] != self._packed[place]:
                self._kept[place] = self._packed[place]
                same = False
        return same

    def _pack(self) -> None:
        """Write the state to `_packed`."""
        self._packed[0] = self.acc
        for n in range(8):
            self._packed[1 + n], self._packed[9 + n], self._packed[17 + n] = self.xar[n], self.r[n], self.shadow_r[n]
        self._packed[25], self._packed[26], self._packed[27], self._packed[28] = self.p, self.xt, self.dp, self.sp
        self._packed[29], self._packed[30], self._packed[31] = self.rpc, self.st0(), self.whole_st1()
        self._packed[32], self._packed[33], self._packed[34] = self._core.ier, self.dbgier, self.dbgstat
        self._packed[35], self._packed[36], self._packed[37] = self.stf, self.shadow_stf, self.rb
        pipeline, queue = self._pipeline, self.timing.queue
        pipeline.pack()
        for place in range(STORES_PACKED):
            self._packed[TIMING + place] = pipeline.packed_stores[place]
        queue.pack(self._time.cycle)
        for place in range(QUEUE_PACKED):
            self._packed[TIMING + STORES_PACKED + place] = queue.packed_queue[place]

    # Control ------------------------------------------------------------------------

    def enter(self, vector: int) -> None:
        """Execute TRAP or INTR regardless of masks, with the context at SP."""
        self.hand_over()
        context = self.context()
        saved = self._core.trap(self._time.cycle, vector)
        self.cycles += self._core.vector_waits
        context[8], context[10] = saved.st1, saved.ier
        self._ram.put_words(frame_of(saved.sp), context)
        self.begin_routine(self._ram.word32(VECTOR_TABLE.start + 2 * vector) & CODE)

    def intr_clears_flag(self, bit: int) -> bool:
        core = self._core
        return bool(core.ifr >> bit & 1) and self._options.intr_clears_ifr.assume(core.touched)

    def leave(self) -> None:
        self.returning = True

    def idle(self) -> None:
        self.polls.soil()
        self.idling = True

    def stop(self) -> None:
        self.ended = True

    def hand_over(self) -> None:
        """Pass SP and ST1 to the interrupt logic."""
        self._core.sp = self.sp
        self._core.st1 = self.whole_st1()

    def context(self) -> list[int]:
        """Return the 14 words that an entry stores."""
        xar, st1, ier = self.xar, self.whole_st1(), self._core.ier
        return [
            self.st0(), self.t(), self.acc & 0xFFFF, self.acc >> 16, self.p & 0xFFFF, self.p >> 16, xar[0] & 0xFFFF,
            xar[1] & 0xFFFF, st1, self.dp, ier, self.dbgstat, self.pc & 0xFFFF, self.pc >> 16,
        ]  # fmt: skip

    def begin_routine(self, address: int) -> None:
        """Enter the service routine; RPTB's RA is saved in RAS."""
        self.timing.drain()
        self.polls.soil()
        self.polls.routines += 1
        if self.due or self.due_flags:
            arrive(self)
        self.sp = self._core.sp
        for below in range(1, CONTEXT_SP + 1):
            self._written[self.sp - below & 0xFFFF] = 1
        self.rb = self.rb & 0x3FFF_FFFF | (self.rb >> 30 & 1) << 31
        self.pc = address

    def restore(self, words: list[int]) -> None:
        """Restore the context from the words that IRET read."""
        self.polls.soil()
        if self.polls.routines:
            self.polls.routines -= 1
        self.timing.drain()
        self.put_st0(words[0])
        self.put_t(words[1])
        self.dp, self.dbgstat = words[9], words[11]
        self.acc, self.p = words[2] | words[3] << 16, words[4] | words[5] << 16
        self.put_ar(0, words[6])
        self.put_ar(1, words[7])
        self.arp = words[8] >> 13
        self.pc = (words[12] | words[13] << 16) & CODE
        self.sp = self._core.sp
        self.rb = self.rb & 0x3FFF_FFFF | (self.rb >> 31) << 30
