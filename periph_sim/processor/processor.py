"""One CPU: its time, its bus, its interrupts and its program.

    kernel --wake-up--> Processor --run--> Program --> Bus, CpuTime
                            ^--- reach, rest, take_interrupt, iret, stops

The program calls `reach`, `rest`, `take_interrupt` or `iret` for a step that takes time. If the call returns True, the
step is complete, and the program continues in the same call of `run`. If it returns False, the program must stop. An
image then returns from `run`. Python firmware calls `stops` instead, because it stops in the middle of its functions
and so cannot return. When the kernel wakes this CPU, the processor completes the step and runs the program again.

A program executes instructions. It advances `CpuTime.cycle`, makes accesses in the cycles that the bus returns, and
takes interrupts at boundaries between two instructions (`Processor.take_interrupt`, which calls `enter`). It keeps its
position between two calls of `run`: Python firmware keeps it in a greenlet, an image in the registers and the pending
instruction.

    request --> CpuInterrupts --> due --> take_interrupt --vector_delay--> fetch --> entered ... iret --> returned
                                            |                               |                     |
                                    context to the stack             PIE, vector table    context from the stack

The saved context of an interrupt is only in memory, so firmware may return with the context of another interrupt, or
with a context that it has built itself.

Source: SPRU430F section 3.4, Table 3-4 (context); SPRUFB0D sections 8.1 to 8.5, Table 112 (vectors).
"""

# core: compiled

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, final

from ..core.agent import Agent
from ..core.chip import NEVER
from ..core.kernel import Kernel
from ..core.records import Kind, Recorder
from ..core.state import State
from ..core.time import Clock
from ..f28335.cpu import code_costs as cpu_costs
from ..f28335.cpu.interrupts import CONTEXT_WORDS, IER_WORD, ST1_WORD, CpuInterrupts, frame_of
from ..f28335.memory.memory_map import AddressMap
from ..f28335.memory.ram import block_at
from ..f28335.pie.module import Pie
from ..f28335.pie.register_map import GROUPS, VECTOR_TABLE, VECTORS
from ..f28335.system_options import SystemOptions
from ..form.c_types import Text
from .bus import Bus
from .cpu_time import CpuTime
from .firmware_notes import FirmwareNotes
from .polling import Spin
from .source_location import SourceLocation
from .user_code import InterruptFault

NOTHING_SAVED = (0,) * CONTEXT_WORDS
NAME_OF = {address: name for name, address in VECTORS.items()}
CODE_ADDRESS = 0x3F_FFFF  # mask of the bits of a vector that the CPU uses


class Awaited(NamedTuple):
    """A description of a wait in progress.

    what: the registers or words that the wait reads, as text.
    unanswered: why an unmodelled register that the wait reads does not change, and how the case can answer its reads;
        "" if this does not apply.
    memory: True if the wait reads no register, so that only a service routine can end it.
    since: the cycle at which a wait for unmodelled registers began; 0 for other waits.
    place: the statement that closes the loop of a wait for unmodelled registers; None for other waits.
    """

    what: str
    unanswered: str = ""
    memory: bool = False
    since: int = 0
    place: SourceLocation | None = None


class Program:
    """Base of the programs that a processor runs.

    stops_itself: True if the program calls `Processor.stops` when it stops, because `run` does not return then.
    spin: the wait in progress; None if there is none.
    polls_skipped: the number of passes of waits that were skipped.
    returned_at: the cycle at which main has returned, or an image has executed ESTOP0; None before.
    """

    STATE = State("spin polls_skipped", cycles="returned_at", results="polls_skipped")

    def __init__(self) -> None:
        self.stops_itself = False
        self.spin: Spin | None = None
        self.polls_skipped = 0
        self.returned_at: int | None = None

    @property
    def finished(self) -> bool:
        """True if main has returned, or an image has executed ESTOP0."""
        return self.returned_at is not None

    def run(self) -> None:
        """Continue the program until it stops. If it has not ended, it is run again at the next wake-up of the CPU.

        If `Processor.reach`, `rest`, `take_interrupt` or `iret` returns False, the program must stop; the step is
        complete when the program is run again.
        """
        raise NotImplementedError

    def awaited(self) -> Awaited:
        """Return a description of the wait in progress."""
        return Awaited("" if self.spin is None else self.spin.waits_for())

    def unanswered_wait(self) -> Awaited | None:
        """Return a wait that reads only unmodelled registers, even during a service routine; None if there is none."""
        return None

    def ending(self, at: Text) -> str:
        """Return the text of the note about the end of the program. at: the time of `returned_at` as text."""
        return f"main returned at {at}; from then on only service routines run"

    def place(self) -> SourceLocation | None:
        """Return the statement that is executed now, or is executed next; None if it is unknown."""
        raise NotImplementedError

    def enter(self, vector: int) -> Text:
        """Enter the service routine at a code address, the vector. Raise FirmwareError if there is no routine.

        Return the location of the first statement of the routine; "" if it is unknown.
        """
        raise NotImplementedError

    def context(self) -> Sequence[int]:
        """Return the 14 words that an interrupt saves, in their order on the stack; the processor sets ST1 and IER."""
        return NOTHING_SAVED

    def restore(self, words: Sequence[int]) -> None:
        """Restore the context that IRET read from the stack."""

    def release(self) -> None:
        """Free the resources of the program, which is not run again."""

    def kill(self) -> None:
        """End the program at its present position."""
        self.spin = None


NONE, FETCHES, ENTERS, RETURNS = range(4)  # the pending step: none, fetch of the vector, entry into the routine, IRET


@final
class Processor(Agent):
    """Processor of a unit.

    core: the masks, flags and timing of interrupts.
    taken: the name of the vector of the last interrupt that was taken.
    unrequested: True if no line of the interrupt's PIE group was flagged and enabled when its vector was fetched.
    """

    STATE = State(
        "time notes bus core taken _under_way _vector _number",
        cycles="_goal",
        records="_cause _causes",
        expires="_goal",
    )

    def __init__(
        self,
        kernel: Kernel,
        clock: Clock,
        recorder: Recorder,
        name: str,
        memory: AddressMap,
        core: CpuInterrupts,
        pie: Pie,
        options: SystemOptions,
        *,
        strict: bool = False,
    ) -> None:
        self.name = name
        self.kernel = kernel
        self.time = CpuTime(kernel, clock, self)
        self.notes = FirmwareNotes(kernel, clock, recorder, name, strict, self.causing_statement)
        self.bus = Bus(name, self.time, clock, recorder, memory, core, self.notes, options, self._place)
        self.core = core
        self.taken = ""
        self.unrequested = False
        self._pie = pie
        self._clock = clock
        self._records_irq = recorder.wants(Kind.IRQ)
        self._number = 0  # the number of the interrupt that is being taken
        # For each active service routine, the innermost last: its vector, and the cause of records before it began.
        self._causes: list[tuple[str, int]] = []
        self._recorder = recorder
        self._program: Program | None = None
        self._cause = 0  # the record that is the cause of what the program does when it continues
        self._goal = 0  # the cycle that the program must reach before it continues
        self._outer = 0  # the record that was the cause when the kernel called `act`
        self._under_way = NONE  # the pending step
        self._vector = 0  # the code address of the service routine that is entered next

    @property
    def program(self) -> Program:
        """The program that runs here."""
        if self._program is None:
            raise RuntimeError(f"{self.name} has no program; give it one with Processor.start")
        return self._program

    # Start and end -----------------------------------------------------------

    def start(self, program: Program, delay: int = 0) -> None:
        """Run a program from its beginning, `delay` cycles after now."""
        self._program = program
        self._cause = 0
        self.time.begin(delay)

    def kill(self) -> None:
        """End the program at its present position, and drop its posted writes."""
        self._forget()
        if self._program is not None:
            self._program.kill()
            self._forget()  # again, because the program may have made accesses while it ended

    def _forget(self) -> None:
        """Cancel the wake-up, the posted writes and the pending step of the program."""
        self.time.stop()
        self.bus.forget()
        self._causes.clear()
        self._under_way = NONE
        self._goal = 0

    def causing_statement(self) -> SourceLocation | None:
        """Return the statement that causes the present action; None if it is unknown, or if no program runs.

        While a posted write with a known statement lands, this is that statement; otherwise, the present statement.
        """
        return self._place() if self.bus.issued_at is None else self.bus.issued_at

    def _place(self) -> SourceLocation | None:
        return None if self._program is None else self._program.place()

    def act(self, tag: int) -> None:
        """Continue the program at a scheduled wake-up."""
        time, recorder = self.time, self._recorder
        time.arrive()
        self._outer, recorder.cause = recorder.cause, self._cause
        if (time.cycle >= self._goal or self.reach(self._goal)) and (not self._under_way or self._go_on()):
            assert self._program is not None
            self._program.run()
            if self._program.stops_itself:
                return
        self.stops()

    def stops(self) -> None:
        """Handle a stop of the program: new records get the cause again that they had before the program ran."""
        recorder = self._recorder
        self._cause, recorder.cause = recorder.cause, self._outer

    # Steps that take time ------------------------------------------------------------

    def reach(self, cycle: int) -> bool:
        """Let time pass to `cycle` without interrupts. Posted writes that land before this cycle take effect.

        Return False if the program must stop before; see `Program.run`.
        """
        time = self.time
        while time.lands < cycle:
            if not time.advance(time.lands):
                self._goal = cycle
                return False
            time.meet()
            self.bus.land()
        if time.advance(cycle):
            return True
        self._goal = cycle
        return False

    def rest(self, cycle: int) -> bool:
        """Sleep until `cycle`, or until an earlier boundary at which an interrupt can be taken.

        Return True if that time has been reached in this call, False if the program must stop until the wake-up.
        """
        now = self.time.cycle
        self._goal = 0
        return self.time.rest(min(cycle, max(now, self.core.earliest())))

    def next_output(self, cycle: int) -> int:
        """Return a cycle before which no write of the program can land. cycle: the cycle of the next wake-up."""
        first = max(cycle, self._goal)
        if self._under_way == FETCHES:
            first = max(first, self.core.ready)
        return min(self.time.lands, first + self.bus.lands_after)

    def take_interrupt(self, number: int) -> bool:
        """Take this interrupt at the present boundary: store the context, fetch the vector, enter the routine.

        Return False if the program must stop before the routine is entered; see `Program.run`. Raise InterruptFault if
        the stack or the vector is not in RAM, FirmwareError if the vector has no routine.
        """
        core, words = self.core, list(self.program.context())
        self._number = number
        saved = core.enter(self.time.cycle, number)
        words[ST1_WORD], words[IER_WORD] = saved.st1, saved.ier
        self.bus.ram.put_words(self.frame(self.time.cycle, saved.sp), words)
        self._under_way = FETCHES
        return self.reach(core.ready - core.entry_cycles + core.vector_delay) and self._go_on()

    def iret(self) -> bool:
        """Execute IRET: restore the context and continue after 8 cycles.

        Return False if the program must stop; see `Program.run`. Raise InterruptFault if the context is not in RAM.
        """
        core, cycle = self.core, self.time.cycle
        words: list[int] = list(self.bus.ram.words(self.frame(cycle, core.returning_sp), CONTEXT_WORDS))
        core.iret(cycle, words[ST1_WORD], words[IER_WORD])
        self.program.restore(words)
        self._under_way = RETURNS
        return self.reach(self.time.cycle + cpu_costs.IRET) and self._go_on()

    def _go_on(self) -> bool:
        """Continue the pending step. Return True if it is complete, False if time has to pass before."""
        if self._under_way == FETCHES:
            self._vector = self._fetch(self.time.cycle)
            self._under_way = ENTERS
            if not self.reach(self.core.ready):
                return False
        under_way, self._under_way = self._under_way, NONE
        recorder, tick = self._recorder, self._clock.tick(self.time.cycle)
        if under_way == ENTERS:
            where = self.program.enter(self._vector)
            self._causes.append((self.taken, recorder.cause))
            if self._records_irq:
                recorder.cause = recorder.emit(tick, Kind.IRQ, self.name, self.taken, 1, where)
            return True
        if self._causes:
            vector, outer = self._causes.pop()
            if self._records_irq:
                recorder.emit(tick, Kind.IRQ, self.name, vector, 0)
            recorder.cause = outer
        self.notes.move_from(self.time.cycle, self.core.notes)
        return True

    def _fetch(self, cycle: int) -> int:
        """Return the vector of the interrupt that is taken: the code address in the vector table in memory."""
        number = self._number
        self.unrequested = number <= GROUPS and not self._pie.has_request(number)
        if number > GROUPS:
            address, self.taken = self._pie.cpu_vector(number), f"INT{number}"
        else:
            line, address = self._pie.vector(cycle, number)
            self.taken = f"INT{number}.{line}"
        routine = self._routine(cycle, address, f"INT{number}")
        self.taken = NAME_OF.get(address, self.taken)
        return routine

    def fetch_for_trap(self, cycle: int, number: int) -> int:
        """Return the vector for TRAP or INTR: the code address in the vector table in memory."""
        address = self._pie.cpu_vector(number)
        self.notes.move_from(cycle, self._pie.notes)
        return self._routine(cycle, address, f"the vector {number} of TRAP or INTR")

    def _routine(self, cycle: int, address: int, what: str) -> int:
        """Return the vector at an address. Raise InterruptFault if the address is in boot ROM."""
        if address in VECTOR_TABLE:
            return self.bus.ram.word32(address) & CODE_ADDRESS
        raise InterruptFault(
            f"{self.name}: {what} was taken at cycle {cycle} with PIECTRL.ENPIE = 0, so its vector "
            f"comes from boot ROM ({address:#x}), which has no routine of this firmware; "
            "set ENPIE before interrupts are enabled"
        )

    def frame(self, cycle: int, sp: int) -> int:
        """Return the address of the context that is saved when SP is `sp`. Raise InterruptFault if it is not in RAM."""
        first = frame_of(sp)
        for address in (first, first + CONTEXT_WORDS - 1):
            if block_at(address) is None:
                raise InterruptFault(f"{self.name}: SP = {sp:#x} at cycle {cycle}; {address:#06x} is not memory")
        return first

    # Requests ------------------------------------------------------------------------

    def request(self, cycle: int, number: int) -> None:
        """Receive a pulse on the interrupt line INTn at `cycle`. number: the n of INTn.

        Wake a sleeping CPU when the interrupt can be taken, or when it ends IDLE.
        """
        core = self.core
        core.raise_line(cycle, number)
        if self.time.asleep or self.time.watching:
            due = core.next_wake if core.idlestat else core.earliest()
            if due < NEVER:
                self.time.resume_by(max(due, cycle))
