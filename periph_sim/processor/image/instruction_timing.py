"""Cycles that instructions of an image take in addition to those of the manual's table.

    stall    before execution, in phase D2: waits for registers, and for fetches from memory with wait states
    late     during execution: waits for words that were just written, wait states of data in program memory, and data
             accesses to the memory block that contains the instruction
    landing  after a jump: the second fetch of a 32-bit instruction at an odd address

If TI does not document a number of cycles, an option (`SystemOptions`) selects it.

Source: SPRU430F 4.3, 4.4; SPRS439M Table 3-5; SPRUFB0D 2.2.
"""

# core: compiled

from __future__ import annotations

from typing import TYPE_CHECKING, final

from ...core.state import State
from ...f28335.cpu.interrupts import CpuInterrupts
from ...f28335.descriptor import FLASH
from ...f28335.memory.ram import block_at
from ...f28335.system_options import SystemOptions
from ..c28x.decoder import RELATIVE, UNC
from ..c28x.execution.cpu import Cpu, Operation
from ..c28x.pipeline import DEPTH, PUSHES, FetchQueue, Pipeline, hazards
from .elsewhere import UnmappedMemory

if TYPE_CHECKING:
    from ...core.options import BoolOption

BRANCHES = RELATIVE | {"LB", "XB", "XBANZ"}
PREFETCHED = 2  # flash with FOPT.ENPIPE = 1 is fetched in blocks of 2 ** PREFETCHED words
WITHOUT_WAITS = (range(0x800), range(0x8000, 0xC000), range(0x3F_8000, 0x3F_C000))  # M0, M1; L0 to L3, at two places


@final
class InstructionTiming:
    """The additional cycles of the instructions of an image.

    pipeline: computes stalls between instructions.
    queue: computes waits for fetches from memory with wait states.
    late: the additional cycles of the present instruction.
    conflicts: False if it is known that an access to data in the same memory block as the instruction takes no
        additional cycles.
    """

    STATE = State("pipeline queue conflicts late")

    def __init__(self, core: CpuInterrupts, options: SystemOptions, elsewhere: UnmappedMemory) -> None:
        self.pipeline = Pipeline()
        self.pipeline.enabled = options.stalls.unrecorded()
        self.late = 0
        self.queue = FetchQueue()
        self._core = core
        self._options = options
        self.conflicts = True
        self._shared: BoolOption = options.flash_model.matches("shared_with_reads")
        self._ahead: int = DEPTH // 2 if options.flash_model.unrecorded() == "two_words_ahead" else DEPTH
        self._elsewhere = elsewhere
        if not self.pipeline.enabled:
            options.stalls.assume(core.touched)  # any instruction might have stalled, so the run depends on this option

    def drain(self) -> None:
        """Empty the pipeline and the queue, as an interrupt or a return from an interrupt does."""
        self.pipeline.drain()
        self.queue.expected = -1

    def prepare(self, f: Operation) -> None:
        """Set the properties of a decoded instruction that concern its timing, and the bits that it tests."""
        encoding = f.encoding
        f.needs, f.makes = hazards(encoding, f.l, f.n, f.m)
        f.jumps = "PC" in encoding.writes
        f.loops = encoding.mnemonic in BRANCHES
        f.waited = not any(f.address in zone for zone in WITHOUT_WAITS)
        f.tested = 1 << f.b if encoding.id == "TBIT_loc16_bit" else f.c if encoding.id == "AND_AX_loc16_16" else 0
        block = block_at(f.address) if f.accesses else None
        f.block, f.block_end = (0, 0) if block is None else (block.base, block.base + block.size)
        if encoding.id == "B_off16_COND" and f.k == UNC:
            f.cycles = self._options.b_unc_cycles.assume(self._core.touched)
        elif encoding.id == "MOVL_loc32_ACC" and f.l == PUSHES:
            f.cycles = self._options.push_acc_cycles.assume(self._core.touched)

    def stall(self, f: Operation, cpu: Cpu, cycle: int) -> int:
        """Return the number of cycles that an instruction waits in D2. After RPT, only the first pass waits."""
        if cpu.passes:
            return 0
        waits: int = 0
        if f.waited:
            if f.address != self.queue.expected:
                bits: int
                first: int
                later: int
                bits, first, later = self._elsewhere.fetches(f.address)
                if bits == PREFETCHED:
                    self._options.flash_model.assume(self._core.touched)
                self.queue.begin(cycle, f.address, bits, first, later, self._ahead if bits == PREFETCHED else DEPTH)
            waits = self.queue.wait(cycle, f.address, f.next)
        if self.pipeline.pending:
            more = self.pipeline.stall(f, cpu.arp)
            if more:
                self._options.stalls.assume(self._core.touched)
            waits += more
        return waits

    def wait_for_word(self, address: int, words: int) -> None:
        """Add to `late` the cycles that a read waits for earlier writes of the same words.

        address: the address of the first word. words: the number of words.
        """
        waits = self.pipeline.read(address, words)
        if waits:
            self._options.stalls.assume(self._core.touched)
            self.late += waits

    def conflict(self) -> None:
        """Add to `late` the additional cycles of a data access to the memory block that contains the instruction."""
        more = self._options.saram_conflict.assume(self._core.touched)
        self.late += more
        self.conflicts = more > 0

    def landing(self, f: Operation) -> int:
        """Return the additional cycles of a jump to an instruction of 32 bits at an odd address; 0 for other jumps.

        The result is also 0 in memory with wait states, because there the fetch queue counts these cycles.
        """
        if f.address & 1 and f.next - f.address == 2 and not f.waited:
            return self._options.odd_32bit_target.assume(self._core.touched)
        return 0

    def read(self, code: int, address: int, cycle: int, waits: int) -> int:
        """Return the cycles that a data read of `address` by the instruction at `code` waits for fetches.

        The read waits only if both addresses are in flash, where fetches continue while instructions are executed, and
        the option `flash_model` is "shared_with_reads". Otherwise, return 0.
        waits: the wait states of the read itself.
        """
        if address in FLASH and code in FLASH and self._shared.assume(self._core.touched):
            return self.queue.read(cycle, waits)
        return 0

    def repeats(self, count: int) -> int:
        """Return the repeat count that RPT uses. count: its operand, which may be too large for RPTC."""
        if count <= 0xFF:
            return count
        return count & (1 << self._options.rptc_width.assume(self._core.touched)) - 1
