"""The CPU's interrupt logic: it decides from requests and instructions which interrupt is taken, and when.

    raise_line --IFR_DELAY--> IFR --IER, INTM--> next_taken --> enter --> vector chosen --> first ISR instruction
                                                   ^              |
                                  instruction boundary        context saved; iret restores it

`CpuInterrupts` executes no instructions and stores no context. Its owner, the model of the processor, stores the result
of `enter` in memory. At IRET the owner passes the words of ST1 and IER at this place in memory to `iret`. For an
instruction such as CLRC INTM the owner calls the method of the same name at the cycle at which the instruction begins.
It calls `next_taken` at each boundary between two instructions. There is no boundary inside an RPT loop, and an
instruction that has reached pipeline stage D2 completes. If an interrupt is taken at the boundary in cycle b:

    b                        enter(b, number): context saved, ST1 changed; if maskable, IFR and IER bits cleared
    b + vector_delay         the owner gets the vector from the PIE
    b + entry_cycles         first instruction of the service routine

With the default latency and a CPU that can be interrupted at once, a request in cycle t sets the IFR bit at t + 4. Its
vector is chosen at t + 5, and the first instruction of its service routine begins at t + 14.

Source: SPRU430F chapter 3 and the instructions' pages; SPRUFB0D section 8; SPRZ272N sections 3.1.1, 3.1.2.

Chosen:
- Every maskable request reaches the IFR after IFR_DELAY, whether it comes from the PIE, from a write of PIEACK that
  unblocks a group, or from timers 1 and 2.
- INTM changes at the start of CLRC INTM and SETC INTM. No interrupt is taken during the 2 cycles of these instructions.
- An interrupt that is already flagged and enabled in IER wakes the CPU from IDLE like a new one.
- Real-time emulation mode is not modelled.
"""

# core: compiled

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from ...core.chip import NEVER, Note
from ...core.state import State
from ..system_options import SystemOptions
from . import code_costs as cpu_costs
from .code_costs import IFR_DELAY, VECTOR_AND_SAVE

# Bits of ST1 (SPRU430F section 2.4).
INTM = 1 << 0
DBGM = 1 << 1
VMAP = 1 << 3
LOOP = 1 << 5
EALLOW = 1 << 6
IDLESTAT = 1 << 7
OBJMODE = 1 << 9
M0M1MAP = 1 << 11

ST1_RESET = INTM | DBGM | VMAP | M0M1MAP
SP_RESET = 0x400
NOT_RESTORED = LOOP | IDLESTAT | M0M1MAP  # bits of ST1 that IRET does not restore

# Interrupt numbers are vector numbers (SPRUFB0D Table 112); 1 to 14 are INT1 to INT14.
DLOGINT, RTOSINT, EMUINT, NMI = range(15, 19)
MASKABLE = 16  # interrupts 1 to 16 can be masked: interrupt n has bit n - 1 in IFR and IER

# The context: ST0, T, AL, AH, PL, PH, AR0, AR1, ST1, DP, IER, DBGSTAT, PC low, PC high (SPRU430F Table 3-4).
CONTEXT_WORDS = 14
CONTEXT_SP = 1 + CONTEXT_WORDS  # number of words by which SP rises when the context is saved
ST1_WORD, IER_WORD = 8, 10  # indices of ST1 and IER among the words of the context


def frame_of(sp: int) -> int:
    """Return the address of the first word of the context that is saved when SP has the value `sp`.

    SP first rises by 1. Then 32-bit words are stored; a store at an odd address goes to the even address before it.
    """
    return sp + 1 & 0xFFFE


def int13_source(xnmicr: int) -> str:
    """Return the source of INT13: "XNMI_XINT13" if XNMICR.SELECT (bit 1) is set, else "TINT1" (SPRUFB0D Table 123)."""
    return "XNMI_XINT13" if xnmicr & 2 else "TINT1"


class Context(NamedTuple):
    """Context that is saved when an interrupt is taken or TRAP is executed.

    number: the number of the interrupt or, after TRAP, of the vector.
    sp, st1, ier: the values of these registers before that.
    """

    number: int
    sp: int
    st1: int
    ier: int


class CpuInterrupts:
    """Interrupt logic of the CPU. Times are SYSCLKOUT cycles, and must not decrease from call to call."""

    STATE = State(
        "ifr ier st1 sp nested owes_instruction _latched _nonmaskable",
        cycles="next_wake ready _coming _latched_at _pieack_end _returned_at",
        expires="ready _latched_at _pieack_end _returned_at",
    )

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """For comparisons of states, leave out SP. See `proof.normal_state`.

        The model that executes an image (machine code) sets SP before each interrupt and each IRET.
        """
        return {"sp": None}

    def __init__(self, options: SystemOptions) -> None:
        latency = options.int_latency.unrecorded() - IFR_DELAY
        # Wait states of the vector fetch, in cycles. They lengthen the entry of an interrupt, and TRAP and INTR.
        self.vector_waits: int = options.vector_fetch_waits.unrecorded()
        # Cycles from the instruction boundary to the first instruction of the service routine.
        self.entry_cycles: int = latency + self.vector_waits
        # Cycles from the instruction boundary to the fetch of the vector.
        self.vector_delay: int = latency - VECTOR_AND_SAVE
        self.notes: list[Note] = []
        self.touched: set[str] = set()
        self._options = options
        # Requests that have not reached the IFR yet: (cycle at which it sets the IFR bit, mask of this bit).
        self._coming: deque[tuple[int, int]] = deque()
        self._latched_at = -1
        self._returned_at = -1  # cycle at which the latest IRET ends; -1 if there was none
        self.reset(0)

    def reset(self, now: int) -> None:
        """Set every register to its value after a hardware reset. No interrupt is pending, and no routine is active."""
        self.ifr = self.ier = 0
        self.st1 = ST1_RESET
        self.sp = SP_RESET
        self.nested = 0  # number of service routines that were entered, also by TRAP, and have not returned
        self.ready = now  # no interrupt is taken before this cycle
        # True if one more instruction must be executed after an IRET before an interrupt is taken. The owner sets it
        # to False when this instruction has been executed.
        self.owes_instruction = False
        self.next_wake = NEVER  # cycle at which the next request reaches the IFR
        self._coming.clear()
        self._latched = 0  # IFR bits that hardware set in the cycle `_latched_at`
        self._nonmaskable = 0  # pending nonmaskable interrupts: bit 0 is EMUINT, which has priority; bit 1 is NMI
        self._pieack_end = -1  # cycle at which the latest instruction that wrote PIEACK ends; -1 if there was none

    # Status -------------------------------------------------------------------

    @property
    def intm(self) -> int:
        return self.st1 & INTM

    @property
    def eallow(self) -> int:
        return self.st1 >> 6 & 1

    @property
    def idlestat(self) -> int:
        return self.st1 >> 7 & 1

    # Inputs from outside the CPU ------------------------------------------------

    def raise_line(self, now: int, number: int) -> None:
        """Accept a request pulse. number: 1 to 14 for INT1 to INT14, or DLOGINT, RTOSINT, EMUINT or NMI."""
        self.wake(now)
        if number in (EMUINT, NMI):
            self._nonmaskable |= 1 << number - EMUINT
        else:
            self._coming.append((now + IFR_DELAY, 1 << number - 1))
            if now + IFR_DELAY <= self._returned_at:
                self._options.irq_after_iret.assume(self.touched)
            self.next_wake = self._coming[0][0]

    def wrote_pieack(self, now: int) -> None:
        """Record that the present instruction writes PIEACK.

        If CLRC INTM follows directly in a service routine, `clrc_intm` adds a note (SPRZ272N section 3.1.1).
        """
        self._pieack_end = now + cpu_costs.SIMPLE

    # Entry and exit ---------------------------------------------------------------

    def next_taken(self, now: int) -> int:
        """Return the number of the interrupt to take at the instruction boundary in cycle `now`; 0 if there is none."""
        self.wake(now)
        if now < self.ready or self.owes_instruction:
            return 0
        if self._nonmaskable:
            return EMUINT if self._nonmaskable & 1 else NMI
        pending = self.ifr & self.ier
        if not pending or self.st1 & INTM:
            return 0
        if pending >> RTOSINT - 1:
            return RTOSINT
        return (pending & -pending).bit_length()

    def earliest(self) -> int:
        """Return the first cycle at which INTM, IER and the present requests allow an interrupt; NEVER if they do not.

        If one more instruction must be executed after an IRET, it is counted as one cycle, the minimum.
        """
        ready = self.ready + self.owes_instruction
        if self._nonmaskable:
            return ready
        if self.st1 & INTM:
            return NEVER
        if self.ifr & self.ier:
            return ready
        if self.next_wake < NEVER:
            for cycle, bit in self._coming:
                if bit & self.ier:
                    return max(cycle, ready)
        return NEVER

    def enter(self, now: int, number: int) -> Context:
        """Take interrupt `number`, which `next_taken` has returned, at the boundary `now`. Return the saved context."""
        self.wake(now)
        self._options.int_latency.assume(self.touched)
        self._options.vector_fetch_waits.assume(self.touched)
        if number > MASKABLE:
            self._nonmaskable &= ~(1 << number - EMUINT)
            return self.save(number, now + self.entry_cycles)
        bit = 1 << number - 1
        self.ifr &= ~bit
        context = self.save(number, now + self.entry_cycles)
        self.ier &= ~bit
        return context

    def trap(self, now: int, number: int) -> Context:
        """Execute TRAP #number: enter the routine of vector `number`, 0 to 31, even if the interrupt is masked.

        IFR and IER keep their values.
        """
        self.wake(now)
        return self.save(number, now + cpu_costs.TRAP + self._options.vector_fetch_waits.assume(self.touched))

    @property
    def returning_sp(self) -> int:
        """The value that SP would have after an IRET now. `frame_of` of this value is the address of the context."""
        return self.sp - CONTEXT_SP & 0xFFFF

    def iret(self, now: int, st1: int, ier: int) -> None:
        """Execute IRET. st1, ier: the words of ST1 and IER in the saved context, which firmware may have changed."""
        self.wake(now)
        if not self.st1 & INTM:
            self.notes.append(
                Note(
                    "duty",
                    "IRET was reached with INTM = 0; a routine that enabled interrupts must disable them before its "
                    "end",
                    "SPRZ272N section 3.1.2",
                )
            )
        self.nested = max(0, self.nested - 1)
        self.st1 = st1 & ~NOT_RESTORED | self.st1 & NOT_RESTORED
        self.ier = ier
        self.sp = self.returning_sp
        self._next_boundary(now + cpu_costs.IRET)
        self.owes_instruction = self._options.irq_after_iret.unrecorded() == "after_one_instruction"
        self._returned_at = self.ready
        if self.ifr & self.ier or self._coming:
            self._options.irq_after_iret.assume(self.touched)

    # Instructions -------------------------------------------------------------------

    def clrc_intm(self, now: int) -> None:
        """Execute CLRC INTM, which is the same instruction as EINT."""
        self.wake(now)
        self.st1 &= ~INTM
        self._next_boundary(now + cpu_costs.CLRC_INTM)
        if now <= self._pieack_end and self.nested:
            self.notes.append(
                Note(
                    "duty",
                    "interrupts were enabled directly after a write of PIEACK; if a nested interrupt clears PIEIER "
                    "bits of its group, line 1 of that group may interrupt without a request. A NOP between the two "
                    "prevents it",
                    "SPRZ272N section 3.1.1",
                )
            )

    def setc_intm(self, now: int) -> None:
        """Execute SETC INTM, which is the same instruction as DINT."""
        self.wake(now)
        self.st1 |= INTM
        self._next_boundary(now + cpu_costs.SETC_INTM)

    def set_eallow(self, now: int, on: bool) -> None:
        """Execute EALLOW if `on`, else EDIS."""
        self.wake(now)
        self.st1 = self.st1 & ~EALLOW | (EALLOW if on else 0)
        self._next_boundary(now + cpu_costs.EALLOW)

    def and_ifr(self, now: int, mask: int) -> None:
        """Execute AND IFR, #mask. A bit that hardware sets in this cycle stays set."""
        self.wake(now)
        self.ifr = self.ifr & mask | (self._latched if self._latched_at == now else 0)
        self._next_boundary(now + cpu_costs.AND_IFR)

    def and_ier(self, now: int, mask: int) -> None:
        self.wake(now)
        self.ier &= mask
        self._next_boundary(now + cpu_costs.AND_IER)

    def or_ier(self, now: int, mask: int) -> None:
        self.wake(now)
        self.ier |= mask & 0xFFFF
        self._next_boundary(now + cpu_costs.OR_IER)

    def idle(self, now: int) -> None:
        """Execute IDLE. From now + code_costs.IDLE on, the owner calls `idle_ends` after each input."""
        self.wake(now)
        self.st1 |= IDLESTAT
        self._next_boundary(now + cpu_costs.IDLE)

    def idle_ends(self, now: int) -> bool:
        """Leave IDLE and return True if an interrupt wakes the CPU now; else return False.

        After IDLE the CPU continues at cycle `ready`. It takes the interrupt that `next_taken` returns then; if that is
        0, it executes the next instruction.
        """
        self.wake(now)
        if now < self.ready or not (self.ifr & self.ier or self._nonmaskable):
            return False
        self.st1 &= ~IDLESTAT
        self.ready = now + self._options.idle_wake.assume(self.touched)
        return True

    # Requests in transit, context -------------------------------------------------

    def wake(self, now: int) -> None:
        """Set the IFR bits of the requests whose IFR_DELAY has passed."""
        while self.next_wake <= now:
            cycle, bit = self._coming.popleft()
            if self._latched_at != cycle:
                self._latched_at = cycle
                self._latched = 0
            self._latched |= bit
            self.ifr |= bit
            self.next_wake = self._coming[0][0] if self._coming else NEVER

    def save(self, number: int, first_instruction: int) -> Context:
        context = Context(number, self.sp, self.st1, self.ier)
        self.nested += 1
        self.sp = self.sp + CONTEXT_SP & 0xFFFF
        self.st1 = (self.st1 | INTM | DBGM) & ~(LOOP | EALLOW | IDLESTAT)
        self._next_boundary(first_instruction)
        return context

    def _next_boundary(self, cycle: int) -> None:
        self.ready = cycle
        self.owes_instruction = False
