"""What instructions of an image take beside the manual's table: one goes in; cycles before and after it come out.

    stall    waiting in D2 for registers, and for instructions that memory with wait states has not brought yet
    late     waiting for words that were just written, and for program memory that is read as data
    landing  a jump to where two fetches are needed

Rules whose numbers TI does not print are options. Source: SPRU430F 4.3, 4.4; SPRS439M Table 3-5; SPRUFB0D 2.2.
"""

# core: compiled

from __future__ import annotations

from typing import TYPE_CHECKING, final

from ...c28x import flow
from ...c28x.execution.registers import Cpu, Operation
from ...c28x.fetch_queue import DEPTH, FetchQueue
from ...c28x.hazards import hazards
from ...c28x.pipeline import Pipeline
from ...core.state import State
from ...f28335.cpu.interrupts import CpuInterrupts
from ...f28335.descriptor import FLASH
from ...f28335.system.options import SystemOptions
from ...f28335.system.ram import block_at
from .elsewhere import Elsewhere

if TYPE_CHECKING:
    from ...core.options import BoolOption

UNC = 15
BRANCHES = flow.RELATIVE | {"LB", "XB", "XBANZ"}
PREFETCHED = 2  # address bits of a unit: flash with FOPT.ENPIPE
PUSH_FIELD = 0xBD  # *SP++
WITHOUT_WAITS = (range(0x800), range(0x8000, 0xC000), range(0x3F_8000, 0x3F_C000))  # M0, M1, L0 to L3


@final
class InstructionTiming:
    """pipeline: stalls between instructions. queue: instructions that memory brings.

    late: cycles that the present instruction takes in addition.
    conflicts: `conflict` is called for accesses to the block of memory from which the program is fetched.
    """

    STATE = State("pipeline queue conflicts late")

    __slots__ = ("_ahead", "_core", "_elsewhere", "_options", "_shared", "conflicts", "late", "pipeline", "queue")

    _shared: BoolOption
    _ahead: int

    def __init__(self, core: CpuInterrupts, options: SystemOptions, elsewhere: Elsewhere) -> None:
        self.pipeline = Pipeline()
        self.pipeline.enabled = options.stalls.unrecorded()
        self.late = 0
        self.queue = FetchQueue()
        self._core = core
        self._options = options
        self.conflicts = True
        self._shared = options.flash_model.matches("shared_with_reads")
        self._ahead = DEPTH // 2 if options.flash_model.unrecorded() == "two_words_ahead" else DEPTH
        self._elsewhere = elsewhere
        if not self.pipeline.enabled:
            options.stalls.assume(core.touched)  # without stalls it is unknown whether one would have occurred

    def drain(self) -> None:
        """The program goes on elsewhere, by an interrupt or a return from one."""
        self.pipeline.drain()
        self.queue.expected = -1

    def prepare(self, f: Operation) -> None:
        """An instruction was decoded: what is known of its time, and of the bits that it looks at, once and for all."""
        encoding = f.encoding
        f.needs, f.makes = hazards(encoding, f.l, f.n, f.m)
        f.jumps = "PC" in encoding.writes
        f.loops = encoding.mnemonic in BRANCHES
        f.waited = has_waits(f.address)
        f.tested = 1 << f.b if encoding.id == "TBIT_loc16_bit" else f.c if encoding.id == "AND_AX_loc16_16" else 0
        block = block_at(f.address) if f.accesses else None
        f.block, f.block_end = (0, 0) if block is None else (block.base, block.base + block.size)
        if encoding.id == "B_off16_COND" and f.k == UNC:
            f.cycles = self._options.b_unc_cycles.assume(self._core.touched)
        elif encoding.id == "MOVL_loc32_ACC" and f.l == PUSH_FIELD:
            f.cycles = self._options.push_acc_cycles.assume(self._core.touched)

    def stall(self, f: Operation, cpu: Cpu, cycle: int) -> int:
        """The cycles that pass before the instruction can leave D2. A further pass of RPT waits for nothing: N + 1."""
        if cpu.passes:
            return 0
        waits = self._fetch(f, cycle) if f.waited else 0
        if self.pipeline.pending:
            more = self.pipeline.stall(f, cpu.arp)
            if more:
                self._options.stalls.assume(self._core.touched)
            waits += more
        return waits

    def wait_for_word(self, address: int, words: int) -> None:
        """The present instruction reads these words of memory, which an earlier one may be still to write."""
        waits = self.pipeline.read(address, words)
        if waits:
            self._options.stalls.assume(self._core.touched)
            self.late += waits

    def conflict(self) -> None:
        """The present instruction accessed the block of memory from which it was fetched."""
        more = self._options.saram_conflict.assume(self._core.touched)
        self.late += more
        self.conflicts = more > 0

    def landing(self, f: Operation) -> int:
        """The cycles that a jump to this instruction takes in addition; memory with wait states counts them itself."""
        if f.address & 1 and f.next - f.address == 2 and not f.waited:
            return self._options.odd_32bit_target.assume(self._core.touched)
        return 0

    def read(self, code: int, address: int, cycle: int, waits: int) -> int:
        """Data are read where memory has wait states, by the instruction at `code`: for how long they wait for fetches.

        Only in flash, from where fetches go on meanwhile.
        """
        if address in FLASH and code in FLASH and self._shared.assume(self._core.touched):
            return self.queue.read(cycle, waits)
        return 0

    def repeats(self, count: int) -> int:
        """How often RPT repeats, of what it took from a location."""
        if count <= 0xFF:
            return count
        return count & (1 << self._options.rptc_width.assume(self._core.touched)) - 1

    def _fetch(self, f: Operation, cycle: int) -> int:
        if f.address != self.queue.expected:
            bits: int
            first: int
            later: int
            bits, first, later = self._elsewhere.fetches(f.address)
            if bits == PREFETCHED:
                self._options.flash_model.assume(self._core.touched)
            self.queue.begin(cycle, f.address, bits, first, later, self._ahead if bits == PREFETCHED else DEPTH)
        return self.queue.wait(cycle, f.address, f.next)


def has_waits(address: int) -> bool:
    """True if program memory there has wait states."""
    return not any(address in zone for zone in WITHOUT_WAITS)
