"""Interrupts of one CPU: requests from its modules, vectors, and the context in memory.

    module --lines of its chip--> PIE --INT1 to INT12--> Interrupts
    CPU timers 1 and 2 --INT13, INT14--> Interrupts

    request --> CpuInterrupts --> due --> take --vector_delay--> fetch --> entered ... iret --> returned
                                           |                      |                     |
                                   context to the stack    PIE, vector table    context from the stack

Each step is a call at a cycle; `Processor` lets time pass in between. The saved context is only in memory,
so firmware may return through another frame, or through one that it built.

Source: SPRU430F section 3.4, Table 3-4 (context); SPRUFB0D sections 8.1 to 8.5, Table 112 (vectors).
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import final

from ..core.chip import NEVER
from ..core.records import Kind, Recorder
from ..core.socket import Socket
from ..core.state import State
from ..core.time import Clock
from ..f28335.cpu.interrupts import CONTEXT_WORDS, IER_WORD, ST1_WORD, CpuInterrupts, frame_of, int13_source
from ..f28335.descriptor import ModuleDescriptor
from ..f28335.memory.ram import Ram, block_at
from ..f28335.pie.module import Pie
from ..f28335.pie.register_map import CPU_VECTORS, GROUPS, LINES, VECTOR_TABLE, VECTORS
from ..form.c_types import Text
from .cpu_time import CpuTime
from .firmware_notes import FirmwareNotes
from .user_code import InterruptFault

NAME_OF = {address: name for name, address in VECTORS.items()}
INT13 = 13
INT13 = 13
CODE_ADDRESS = 0x3F_FFFF  # valid bits of a vector


@final
class Interrupts:
    """The interrupts of one CPU.

    core: masks, flags and timing.
    taken: the name of the vector of the last interrupt that was taken.
    """

    STATE = State("core taken _number", records="_causes")

    def __init__(
        self,
        name: str,
        core: CpuInterrupts,
        pie: Pie,
        ram: Ram,
        time: CpuTime,
        clock: Clock,
        recorder: Recorder,
        notes: FirmwareNotes,
    ) -> None:
        self.core = core
        self.taken = ""
        self.unrequested = False  # True if no line was flagged and enabled when the last vector was fetched
        self._name = name
        self._pie = pie
        self._ram = ram
        self._time = time
        self._clock = clock
        self._recorder = recorder
        self._notes = notes
        self._records_irq = recorder.wants(Kind.IRQ)
        self._number = 0  # of the interrupt being taken
        self._causes: list[tuple[str, int]] = []  # by entry: vector, and the interrupted cause

    def request(self, cycle: int, number: int) -> None:
        """Receive a pulse of INTn at `cycle`."""
        core = self.core
        core.raise_line(cycle, number)
        if self._time.asleep or self._time.watching:
            due = core.next_wake if core.idlestat else core.earliest()
            if due < NEVER:
                self._time.resume_by(max(due, cycle))

    # Entry -----------------------------------------------------------------------

    def take_interrupt(self, cycle: int, number: int, context: Sequence[int]) -> None:
        """Take interrupt `number` at this boundary: store the context on the stack.

        context: 14 words in the order of `frame_of`; ST1 and IER are set here. Raise InterruptFault outside of memory.
        """
        self._number = number
        saved = self.core.enter(cycle, number)
        words = list(context)
        words[ST1_WORD], words[IER_WORD] = saved.st1, saved.ier
        self._ram.put_words(self._frame(cycle, saved.sp), words)

    def fetch(self, cycle: int) -> int:
        """Fetch the vector of the interrupt that was taken, a code address, from the table in memory."""
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
        """Fetch the vector of TRAP or INTR, a code address, from the table in memory."""
        address = self._pie.cpu_vector(number)
        if self._pie.notes:
            self._notes.move_from(cycle, self._pie.notes)
        return self._routine(cycle, address, f"the vector {number} of TRAP or INTR")

    def _routine(self, cycle: int, address: int, what: str) -> int:
        """Return the vector at an address. Raise InterruptFault if it is in boot ROM."""
        if address in VECTOR_TABLE:
            return self._ram.word32(address) & CODE_ADDRESS
        raise InterruptFault(
            f"{self._name}: {what} was taken at cycle {cycle} with PIECTRL.ENPIE = 0, so its vector "
            f"comes from boot ROM ({address:#x}), which has no routine of this firmware; "
            "set ENPIE before interrupts are enabled"
        )

    def entered(self, cycle: int, where: Text) -> None:
        """Record the entry, at the service routine's first instruction. where: the place of the routine."""
        self._causes.append((self.taken, self._recorder.cause))
        if self._records_irq:
            tick = self._clock.tick(cycle)
            self._recorder.cause = self._recorder.emit(tick, Kind.IRQ, self._name, self.taken, 1, where)

    # Return ----------------------------------------------------------------------

    def iret(self, cycle: int) -> Sequence[int]:
        """Begin IRET, and return the 14 words that it pops off the stack, in the order of `frame_of`."""
        core = self.core
        words = self._ram.words(self._frame(cycle, core.returning_sp), CONTEXT_WORDS)
        core.iret(cycle, words[ST1_WORD], words[IER_WORD])
        return words

    def returned(self, cycle: int) -> None:
        """Record the return, at the end of IRET, and restore the interrupted cause."""
        if self._causes:
            vector, outer = self._causes.pop()
            if self._records_irq:
                self._recorder.emit(self._clock.tick(cycle), Kind.IRQ, self._name, vector, 0)
            self._recorder.cause = outer
        self.take_notes(cycle)

    def forget(self) -> None:
        """Drop all entries, since the program has ended."""
        self._causes.clear()

    def take_notes(self, cycle: int) -> None:
        if self.core.notes:
            self._notes.move_from(cycle, self.core.notes)

    def _frame(self, cycle: int, sp: int) -> int:
        """Return the address of the context's first word, from SP at the entry. Raise InterruptFault outside of RAM."""
        first = frame_of(sp)
        for address in (first, first + CONTEXT_WORDS - 1):
            if block_at(address) is None:
                raise InterruptFault(f"{self._name}: SP = {sp:#x} at cycle {cycle}; {address:#06x} is not memory")
        return first


Handler = Callable[[int, int], None]  # called with a cycle and a mask of lines
Places = tuple[tuple[int, int], ...]  # group and line in the PIE


class InterruptLines:
    """The interrupt lines from the modules of a unit to its PIE and CPU.

    interrupts: the interrupts of the CPU; set before time passes.
    """

    interrupts: Interrupts

    def __init__(self, pie: Pie, sockets: Mapping[str, Socket]) -> None:
        """sockets: the modules of the unit, by name."""
        self._pie = pie
        self._sockets = sockets

    def request_handler(self, descriptor: ModuleDescriptor) -> Handler:
        """Return the function that takes a module's interrupt requests to the PIE, or straight to the CPU."""
        lines = pie_lines(descriptor)
        if lines or not descriptor.interrupts:
            return partial(self._requested, lines)
        return partial(self._cpu_requested, CPU_VECTORS[descriptor.interrupts[0].vector])

    def follow_pie(self, cycle: int) -> None:
        """Request the interrupts of the CPU that the PIE has pulsed."""
        pulses, self._pie.pulses = self._pie.pulses, 0
        number = 1
        while pulses:
            if pulses & 1:
                self.interrupts.request(cycle, number)
            pulses >>= 1
            number += 1

    def _cpu_requested(self, interrupt: int, cycle: int, asked: int) -> None:
        """Request INT13 or INT14; INT13 is timer 1's unless XNMICR assigns it to the XNMI pin (SPRUFB0D Table 123)."""
        xint = self._sockets.get("XINT")
        xnmicr = 0 if xint is None else xint.chip.peek(cycle, xint.chip.MAP["XNMICR"].offset)
        if interrupt != INT13 or int13_source(xnmicr) == "TINT1":
            self.interrupts.request(cycle, interrupt)

    def _requested(self, places: Places, cycle: int, asked: int) -> None:
        for i, (group, line) in enumerate(places):
            if asked >> i & 1:
                self._pie.request(cycle, group, line)
        self._sockets["PIE"].publish(cycle)

    def held(self, places: Places, cycle: int, held: int) -> None:
        """Pass the lines that a module holds to the PIE."""
        for i, (group, line) in enumerate(places):
            self._pie.hold(cycle, group, line, bool(held >> i & 1))
        self._sockets["PIE"].publish(cycle)


def pie_lines(descriptor: ModuleDescriptor) -> Places:
    """Return group and line of a module's interrupts in the PIE, in the order of its chip's LINES."""
    return tuple(LINES[one.vector] for one in descriptor.interrupts if one.vector in LINES)
