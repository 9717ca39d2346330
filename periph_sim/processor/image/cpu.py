"""The CPU of a unit that runs an image: it makes accesses on the unit's bus, and updates the interrupt logic.

    ImageMemory --loads, stores--> Ram | Bus | UnmappedMemory
    ImageCpu    --ST1, IER, IFR--> CpuInterrupts

Accesses are made in the present cycle of the CPU. Before an access, the program obtains the cycle in which the access
can be made from `access_at`, and advances the CPU to this cycle.
"""

# core: compiled

from __future__ import annotations

from typing import Annotated, Any, final

from ...core.chip import Note
from ...core.state import State
from ...f28335.cpu.interrupts import CONTEXT_SP, EALLOW, INTM, frame_of
from ...f28335.memory.ram import Remainders, block_at
from ...f28335.system_options import SystemOptions
from ..c28x.decoder import Instruction, decode_at
from ..c28x.delay_slots import arrive, delay, late_results, not_kept
from ..c28x.execution.cpu import READS, REGISTER, Cpu, Operation
from ..c28x.execution.engine import PAGE
from ..c28x.execution.operations import operation
from ..c28x.execution.registers import ARP, ARP_MASK, CODE, READ_ONLY, ST1_RESET, IllegalOperation
from ..c28x.pipeline import QUEUE_PACKED, STORES_PACKED
from ..processor import Processor
from .memory import RAM_TO, ImageMemory, first_address, in_plain_ram

TIMING = 38  # index of the first entry of the pipeline in the result of `ImageCpu.state`
PACKED = TIMING + STORES_PACKED + QUEUE_PACKED  # number of entries in the result of `ImageCpu.state`


@final
class ImageCpu(ImageMemory):
    """The CPU that executes an image.

    ended: True if ESTOP0 was reached.
    returning: True from the execution of IRET until `ImageProgram` completes the return.
    idling: True from the execution of IDLE until an interrupt ends it.
    """

    STATE = State("ended returning idling _kept")

    def __init__(self, processor: Processor, options: SystemOptions, skip_polls: bool, keeps_decoded: bool) -> None:
        super().__init__(processor, options, skip_polls)
        self.keeps_decoded = keeps_decoded
        self._processor = processor
        self._options = options
        self._delays = options.fpu_delay_slot.unrecorded() == "old_value"
        self._packed: Annotated[list[int], PACKED] = [0] * PACKED  # the present state, see `state`
        self._kept: Annotated[list[int], PACKED] = [0] * PACKED  # the state at the last call of `is_as_before`
        self.reset()

    def reset(self) -> None:
        """Set the registers to the values that the boot ROM's program leaves. Memory keeps its contents.

        Registers of the frames that are not modelled are reset, too.
        """
        Cpu.__init__(self)
        self.elsewhere.reset()
        self.left = 0
        self.timing.drain()
        self.polls.forget()
        self._core.st1 = ST1_RESET
        self.ended = self.returning = self.idling = False

    # Time ---------------------------------------------------------------------------

    def _decode(self) -> Operation:
        pc = self.pc
        at = first_address(pc)
        if at != pc:
            self._code[at >> PAGE] = 1
        if in_plain_ram(at) and not self._written[at]:
            raise IllegalOperation(f"nothing was loaded to {pc:#08x}, or written there")
        self._decoding = True
        try:
            made = ImageMemory._decode(self)
        finally:
            self._decoding = False
        instruction = Instruction(pc, self.word_at(pc) << 16 | self.word_at(pc + 1), made.encoding)
        self._prepare(made, instruction)
        if made.encoding.kind == "fpu":
            self._look_at_slots(instruction)
        return made

    def _prepare(self, made: Operation, instruction: Instruction) -> None:
        """Set the properties of a decoded instruction that depend on the timing and on FPU delay slots."""
        self.timing.prepare(made)
        if made.encoding.kind == "fpu":
            made.late = late_results(instruction)
        if self._delays:
            delay(made)

    def operation_of(self, address: int, first: int, second: int) -> Operation:
        """Return the operation that these two words encode at an address, ready to execute."""
        found = decode_at(address, first, second)
        assert found is not None
        made = operation(found)
        self._prepare(made, found)
        return made

    def _look_at_slots(self, instruction: Instruction) -> None:
        """Make a note if the instruction in the delay slot of this instruction reads a late result."""
        if instruction.address in self._slots_seen:
            return
        self._slots_seen.add(instruction.address)
        memory: Any = self  # Any, because compiled code would pass an unbound method of a typed object
        for text in not_kept(instruction, memory.word_at):
            self._options.fpu_delay_slot.assume(self._core.touched)
            self._processor.notes.note(self._time.cycle, Note("duty", text, "SPRUEO2A section 3.2"))

    def _repeat(self) -> None:
        wanted = self.repeat
        self.repeat = self.timing.repeats(wanted)
        ImageMemory._repeat(self)
        if wanted and self.left == 1:
            text = f"RPT precedes an instruction that cannot be repeated, at {self.pc:#08x}; it is executed once"
            self._processor.notes.note(self._time.cycle, Note("duty", text, "SPRU430F RPT"))

    def access_at(self, f: Operation, cycle: int) -> int:
        """Return the first cycle from `cycle` on in which all accesses of an operation can be made.

        An operation may access the operand that the field l of its instruction encodes, the operand *(0:16), or both.
        """
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
        if not reads:
            return cycle
        waits = self.elsewhere.read_waits(address)
        return cycle + waits + self.timing.read(self.pc, address, cycle, waits)

    # Status bits that are stored in the interrupt logic -----------------------------

    def whole_st1(self) -> int:
        return self._core.st1 & ~ARP_MASK | self.arp << ARP

    def put_st1(self, value: int) -> None:
        core = self._core
        self.polls.soil()
        core.st1 = (value & ~READ_ONLY | core.st1 & READ_ONLY) & ~ARP_MASK
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
        """Return the registers except PC and IFR, and the state of the pipeline and of the fetch queue.

        The next pass of a loop depends only on this state, memory, modules and interrupts. The first entries are ACC
        and XAR0 to XAR7. The entries from TIMING on are the state of the pipeline and of the fetch queue.
        """
        self._pack()
        return tuple(self._packed)

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return the pipeline and the fetch queue as in `state`, and remainders in place of `_written`.

        See `proof.normal_state`.
        """
        found = Remainders()
        flags: int = 0  # those of 16 words
        place: int
        for place in range(RAM_TO):
            flags = flags << 1 | self._written[place]
            if place & 15 == 15:
                if flags:
                    found.add(place, flags)
                flags = 0
        return {"timing": self.state()[TIMING:], "_kept": None, "_written": found.both()}

    def is_as_before(self) -> bool:
        """Return True if the result of `state` is equal to that at the last call of this method."""
        self._pack()
        same: bool = True
        for place in range(PACKED):
            if self._kept[place] != self._packed[place]:
                self._kept[place] = self._packed[place]
                same = False
        if self.marks is not None and not self.marks.is_as_before():
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
        """Execute TRAP or INTR: save the context at SP, and enter the service routine, regardless of INTM and IER.

        vector: the number of the vector. Raise InterruptFault if the stack or the vector is not in RAM.
        """
        routine = self._processor.fetch_for_trap(self._time.cycle, vector)
        self.hand_over()
        context = self.context()
        saved = self._core.trap(self._time.cycle, vector)
        self.cycles += self._core.vector_waits
        context[8], context[10] = saved.st1, saved.ier
        self._ram.put_words(self._processor.frame(self._time.cycle, saved.sp), context)
        self.begin_routine(routine)

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
        """Write SP and ST1 to the interrupt logic."""
        self._core.sp = self.sp
        self._core.st1 = self.whole_st1()

    def context(self) -> list[int]:
        """Return the 14 words that an interrupt saves on the stack."""
        xar, st1, ier = self.xar, self.whole_st1(), self._core.ier
        return [
            self.st0(), self.t(), self.acc & 0xFFFF, self.acc >> 16, self.p & 0xFFFF, self.p >> 16, xar[0] & 0xFFFF,
            xar[1] & 0xFFFF, st1, self.dp, ier, self.dbgstat, self.pc & 0xFFFF, self.pc >> 16,
        ]  # fmt: skip

    def begin_routine(self, address: int) -> None:
        """Enter the service routine at an address. In RB, copy bit RA to bit RAS, and clear RA."""
        self.timing.drain()
        self.polls.soil()
        self.polls.routines += 1
        if self.due or self.due_flags:
            arrive(self)
        self.sp = self._core.sp
        if self.marks is not None:
            self.marks.entered(frame_of(self.sp - CONTEXT_SP & 0xFFFF))
        for below in range(1, CONTEXT_SP + 1):
            self._written[self.sp - below & 0xFFFF] = 1
        self.rb = self.rb & 0x3FFF_FFFF | (self.rb >> 30 & 1) << 31
        self.pc = address

    def restore(self, words: list[int]) -> None:
        """Restore the context from the 14 words that IRET has read from the stack."""
        self.polls.soil()
        for address in range(frame_of(self._core.sp), frame_of(self._core.sp) + len(words)):
            self._unwritten(address)
        if self.marks is not None:
            self.marks.returned(frame_of(self._core.sp), self.pc)
        self._core.st1 &= ~ARP_MASK  # this field is in `arp`
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
