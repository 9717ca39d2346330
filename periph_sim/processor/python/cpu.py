"""The C28x as Python firmware uses it: instructions, register accesses, and interrupts between two instructions.

instruction, run, idle --boundary--> Processor.take_interrupt --> vector --> service routine --> Processor.iret
firmware --> wait for writes, wait states --> Bus --> value, or a posted write --> boundary
                                                ^--- reads of a replayed pass of a wait return the earlier values

A service routine is called on the firmware's own stack, at the instruction boundary at which the chip would take the
interrupt.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from typing import final

from ...core.chip import NEVER, Note
from ...core.records import Kind, Recorder, Topic
from ...core.time import Clock
from ...f28335.cpu import code_costs as cpu_costs
from ...f28335.cpu.code_costs import BARE, CodeCosts
from ...f28335.cpu.interrupts import CpuInterrupts
from ...f28335.memory.ram import block_at
from ...form.c_types import Text
from ..bus import Bus
from ..cpu_time import CpuTime
from ..operand import Operand
from ..polling import Spin
from ..processor import Processor
from ..source_location import SourceLocation
from ..user_code import warn
from .program import PythonProgram

MANY_READS = 1000  # after this number of reads without a write or a wait, it is checked whether a loop polls
CYCLES_OF_A_PASS = 100  # a loop polls if less than MANY_READS times this has passed since the last check
POLLING = Note(
    "polling",
    "a loop polls registers pass by pass, which takes long to simulate; wait with dsp.spin(lambda: CONDITION), which "
    "skips the passes",
    "firmware in Python",
)


@final
class Cpu:
    """One processor with its Python firmware. Each access takes one cycle and the wait states of its peripheral frame.

    core: the masks, flags and timing of interrupts.
    program: the Python firmware.
    records_waits: True if any subscriber needs records of waits.
    keeps_waits: True if a subscriber to records of waits or accesses may keep a reference to a wait, so that the `Spin`
        object of the wait must not be used again.
    """

    def __init__(self, processor: Processor, clock: Clock, recorder: Recorder, code: CodeCosts = BARE) -> None:
        self.processor = processor
        self.time: CpuTime = processor.time
        self.bus: Bus = processor.bus
        self.core: CpuInterrupts = processor.core
        self.program = PythonProgram(processor)
        self.records_waits = recorder.wants(Kind.WAIT)
        self.keeps_waits: bool = recorder.makes_records(Kind.WAIT) or recorder.makes_records(Kind.ACCESS)
        self._clock = clock
        self._recorder = recorder
        self._records_spans = recorder.wants(Kind.SPAN)
        self._topics: dict[tuple[Operand, ...], Topic] = {}  # maps the operands that a wait polls to its topic
        self._prologue: int = code.isr_prologue
        self._epilogue: int = code.isr_epilogue
        self._between: int = code.between_accesses
        self._reads = 0  # number of reads since the last write, wait or check for polling
        self._reads_from = 0  # the cycle of the last check for polling
        self._polling_places: set[str] = set()  # the statements for which a note about polling was made

    # Start and end -----------------------------------------------------------

    def start(self, firmware: Callable[[], None], delay: int = 0) -> None:
        """Start Python firmware, which begins `delay` cycles after now."""
        self.program.begin(firmware, lambda: self.after_main())
        self.processor.start(self.program, delay)

    @property
    def cycle(self) -> int:
        """Number of SYSCLKOUT cycles that have passed."""
        return self.time.cycle

    # Code ----------------------------------------------------------------------

    def compute(self, cycles: int, name: Text = "") -> None:
        """Execute instructions of one cycle each; an interrupt can be taken after each.

        name: the name of a span around the instructions; "" for no span.
        """
        if name:
            self.mark_span(name, 1)
        self.run(cycles)
        if name:
            self.mark_span(name, 0)

    def mark_span(self, name: str, begins: int) -> None:
        """Record that a span of this name begins (begins = 1) or ends (0) at the present cycle."""
        if self._records_spans:
            self.record(self._recorder.topic(Kind.SPAN, self.program.name, name), self.time.cycle, begins)

    def _mark_idle(self, begins: int) -> None:
        if self.records_waits:
            self.record(self._recorder.topic(Kind.WAIT, self.program.name, "IDLE"), self.time.cycle, begins)

    def waited_for(self, spin: Spin) -> Topic:
        """Return the topic of the WAIT records of all waits that poll the same operands as `spin`."""
        polled = tuple([read.operand for read in spin.reads[: spin.made]])
        topic = self._topics.get(polled)
        if topic is None:
            what = spin.waits_for() or "a variable"
            topic = self._topics[polled] = self._recorder.topic(Kind.WAIT, self.program.name, what)
        return topic

    def record(self, topic: Topic, cycle: int, begins: int, end: Text = "") -> None:
        """Record that a wait or a span begins (begins = 1) or ends (0). end: the text of the record of the end."""
        text = (self.program.place() or "") if begins and topic.places else end
        topic.emit(self._clock.tick(cycle), begins, text)

    # Interrupt and protection instructions -------------------------------------------

    def eint(self) -> None:
        self.core.clrc_intm(self.time.cycle)
        self._note_and_pass(cpu_costs.CLRC_INTM)

    def dint(self) -> None:
        self.core.setc_intm(self.time.cycle)
        self._note_and_pass(cpu_costs.SETC_INTM)

    def eallow(self) -> None:
        self.core.set_eallow(self.time.cycle, True)
        self.instruction(cpu_costs.EALLOW)

    def edis(self) -> None:
        self.core.set_eallow(self.time.cycle, False)
        self.instruction(cpu_costs.EDIS)

    def or_ier(self, mask: int) -> None:
        self.core.or_ier(self.time.cycle, mask)
        self.instruction(cpu_costs.OR_IER)

    def and_ier(self, mask: int) -> None:
        self.core.and_ier(self.time.cycle, mask)
        self.instruction(cpu_costs.AND_IER)

    def nop(self) -> None:
        self.instruction(cpu_costs.SIMPLE)

    def _note_and_pass(self, cycles: int) -> None:
        self.processor.notes.move_from(self.time.cycle, self.core.notes)
        self.instruction(cycles)

    # Instructions ----------------------------------------------------------------------

    def instruction(self, cycles: int) -> None:
        """Execute instructions that take these cycles in total. An interrupt can be taken only after the last one."""
        time, core = self.time, self.core
        cycle = time.cycle + cycles
        if cycle >= time.lease and not self.processor.reach(cycle):
            self.program.yield_turn()
        time.cycle = cycle
        if core.ifr or core.next_wake <= cycle or core.owes_instruction:
            self.serve()

    def go_to(self, cycle: int) -> None:
        """Let time pass to `cycle`, without interrupts."""
        if not self.processor.reach(cycle):
            self.program.yield_turn()

    def run(self, cycles: int) -> None:
        """Execute code of this number of cycles without accesses. An interrupt can be taken after each cycle."""
        time, core = self.time, self.core
        end = time.cycle + cycles
        if end < time.lease and core.next_wake > end and not core.ifr and not core.owes_instruction:
            time.cycle = end
            return
        left = cycles
        while left > 0:
            if time.lands < NEVER:  # cycle by cycle until all posted writes have landed
                self.instruction(1)
                left -= 1
                continue
            began = time.cycle
            self._rest_until(began + left)
            left -= time.cycle - began
            if core.ifr or core.next_wake <= time.cycle:
                self.serve()

    def idle(self) -> None:
        """Execute IDLE: sleep until an interrupt that IER enables. If INTM is 0, serve the interrupt."""
        time, core = self.time, self.core
        self._mark_idle(1)
        core.idle(time.cycle)
        self.go_to(time.cycle + cpu_costs.IDLE)
        while not core.idle_ends(time.cycle):
            self._rest_until(max(time.cycle, core.next_wake))
        if core.ready > time.cycle:
            self.go_to(core.ready)
        self._mark_idle(0)
        self.serve()

    def after_main(self) -> None:
        """Execute the endless loop of exit() in the run-time library, a branch to itself. Interrupts are served."""
        time = self.time
        while True:
            began = time.cycle
            self._rest_until(NEVER)
            passes = max(1, -(-(time.cycle - began) // cpu_costs.SB_ALWAYS))
            self.go_to(began + passes * cpu_costs.SB_ALWAYS)
            self.serve()

    def _rest_until(self, cycle: int) -> None:
        """Sleep until `cycle`, or until an earlier boundary at which an interrupt can be taken."""
        if not self.processor.rest(cycle):
            self.program.yield_turn()

    def serve(self) -> None:
        """Take every interrupt that can be taken at this instruction boundary."""
        time, core = self.time, self.core
        if core.owes_instruction:
            core.owes_instruction = False
        number = core.next_taken(time.cycle)
        while number:
            self._call_routine(number)
            number = core.next_taken(time.cycle)

    def _call_routine(self, number: int) -> None:
        processor, program, time = self.processor, self.program, self.time
        spin, program.spin = program.spin, None
        began = time.cycle
        if not processor.take_interrupt(number):
            program.yield_turn()
        routine = program.entered
        assert routine is not None
        self.run(self._prologue)
        routine()
        self.run(self._epilogue)
        if not processor.iret():
            program.yield_turn()
        program.spin = spin
        if spin is not None:
            spin.hold_up(time.cycle - began)

    # Accesses --------------------------------------------------------------------------

    def read(self, operand: Operand, where: SourceLocation | None = None) -> int:
        """Read an operand, and return its words with the upper word in bits 31:16.

        where: the statement with the read; None if it is not known yet.
        """
        time, spin = self.time, self.program.spin
        if spin is None:
            self.run(self._between)
            self._reads += 1
            if self._reads == MANY_READS:
                self._check_for_polling()
        elif spin.made:
            self.instruction(cpu_costs.SB_NOT_TAKEN)  # the branch that tests the previous value
        bus = self.bus
        free = bus.free_from if operand.block else bus.free(operand)
        if time.cycle < free:
            self._wait_for_writes(operand, spin)
        at = time.cycle + bus.read_waits(operand)
        if spin is not None and at < spin.live_from:
            value = spin.answer()
            time.cycle = at
        else:
            if at < time.lease:
                time.cycle = at
            else:
                self.go_to(at)
            if operand.looks and (where is not None or not operand.placed):
                value = operand.chip.see(at, operand.offset)
                if operand.recorded:
                    bus.record_poll(at, operand, value, where)
            else:
                if operand.meets:
                    time.meet()
                value = bus.fetch(at, operand)
        if spin is not None:
            spin.note(operand, value, where)
            self._reads = 0
        self.instruction(1)
        return value

    def _check_for_polling(self) -> None:
        """Make a note of a loop that reads registers pass by pass without `dsp.spin`, once for each statement."""
        cycle = self.time.cycle
        dense = cycle - self._reads_from < MANY_READS * CYCLES_OF_A_PASS
        self._reads, self._reads_from = 0, cycle
        where = self.program.place() if dense and self.program.placed is None else None
        if where is not None and where not in self._polling_places:
            self._polling_places.add(where)
            self.processor.notes.note(cycle, POLLING)
            warn(f"{self.program.name}, {where.for_people()}: {POLLING.text}")

    def write(self, operand: Operand, value: int) -> None:
        """Write an operand. The upper word is in bits 31:16 of `value`."""
        self._before_write()
        at = self.bus.posts_at(self.time.cycle, operand)
        self.go_to(at)
        self.bus.store(at, operand, value)
        self.instruction(1)

    def modify(self, operand: Operand, number: int) -> None:
        """Write `number` to a bit field by a read-modify-write of the word with the field."""
        self._before_write()
        time = self.time
        self._wait_for_writes(operand, self.program.spin)
        self.go_to(time.cycle + self.bus.read_waits(operand))
        if operand.meets:
            time.meet()
        self.bus.modify(time.cycle, operand, number)
        self.instruction(1)

    def load(self, address: int, width: int = 16) -> int:
        """Return a 16- or 32-bit value from an address; 0 for a 32-bit read in peripheral frame 2.

        Raise NoSuchAddress if nothing is there.
        """
        bus, time = self.bus, self.time
        if block_at(address) is not None:
            self.run(self._between)
            self.go_to(bus.reads_at(time.cycle, address, width))
            value = bus.read(time.cycle, address, width)
            self.instruction(1)
            return value
        operand = bus.at(address, width)
        if width == 32 and operand.frame2:
            self._refuse(operand)
            return 0
        return self.read(operand) >> operand.shift

    def store(self, address: int, value: int, width: int = 16) -> None:
        """Write 16 or 32 bits to an address; 32 bits in peripheral frame 2 are ignored.

        Raise NoSuchAddress if nothing is there.
        """
        bus, time = self.bus, self.time
        if block_at(address) is not None:
            self._before_write()
            self.go_to(bus.writes_at(time.cycle, address, width))
            bus.write(time.cycle, address, value, width)
            self.instruction(1)
            return
        operand = bus.at(address, width)
        if width == 32 and operand.frame2:
            self._refuse(operand)
        else:
            self.write(operand, value << operand.shift)

    def _refuse(self, operand: Operand) -> None:
        """Make a note of a 32-bit access in peripheral frame 2, which has no effect, and let its cycles pass."""
        self.instruction(1 + self.bus.read_waits(operand))
        self.bus.note_width(self.time.cycle, operand)

    def _wait_for_writes(self, operand: Operand, spin: Spin | None) -> None:
        free, cycle = self.bus.free(operand), self.time.cycle
        if cycle < free:
            if spin is not None:
                spin.hold_up(free - cycle)
            self.go_to(free)

    def _before_write(self) -> None:
        """Let the time pass that compiled firmware needs between two accesses. An interrupt can be taken during it.

        In a wait, no time passes here. The present pass is marked so that it is not skipped, because it writes.
        """
        spin = self.program.spin
        self._reads = 0
        if spin is None:
            self.run(self._between)
        else:
            spin.pure = False
