"""One CPU between two accesses: instructions and computations take time, and interrupts cut in at their boundaries.

    instruction, compute, IDLE --boundary--> CpuInterrupts --> vector --> service routine --> IRET

A service routine is called on the firmware's own stack, where an instruction boundary meets a pending request, exactly
as on the chip.
"""

from __future__ import annotations

from collections.abc import Callable

from ..core.chip import NEVER, Note
from ..core.kernel import Kernel
from ..core.records import Kind, Recorder
from ..core.time import Clock
from ..f28335.cpu import instruction_costs as cpu_costs
from ..f28335.cpu.compiled_code_costs import CodeCosts
from ..f28335.cpu.interrupts import CpuInterrupts
from ..f28335.cpu.pie import Pie
from ..f28335.cpu.pie_map import GROUPS, VECTORS
from .cpu_time import CpuTime
from .error_origin import FirmwareError
from .polling import Spin

NAME_OF = {address: name for name, address in VECTORS.items()}

Handler = Callable[[], None]


class InterruptibleCpu(CpuTime):
    """handlers: service routines by vector. spin_now: the wait in progress.

    busy_cycles: spent in computations and service routines, not in waits.
    """

    __slots__ = (
        "_code",
        "_pie",
        "_records_irq",
        "_records_span",
        "_records_wait",
        "busy_cycles",
        "core",
        "handlers",
        "notes",
        "spin_now",
        "strict",
    )

    def __init__(
        self,
        kernel: Kernel,
        clock: Clock,
        recorder: Recorder,
        name: str,
        core: CpuInterrupts,
        pie: Pie,
        code: CodeCosts,
        strict: bool,
    ) -> None:
        super().__init__(kernel, clock, recorder, name)
        self.core = core
        self.strict = strict
        self.handlers: dict[str, Handler] = {}
        self.notes: dict[Note, int] = {}
        self.spin_now: Spin | None = None
        self.busy_cycles = 0
        self._records_irq = recorder.wants(Kind.IRQ)
        self._records_span = recorder.wants(Kind.SPAN)
        self._records_wait = recorder.wants(Kind.WAIT)
        self._pie = pie
        self._code = code

    def kill(self, how: type[BaseException]) -> None:
        self.spin_now = None
        super().kill(how)

    @property
    def sleeps_in_spin(self) -> bool:
        """A wait is being skipped: it goes on when a register that it reads changes, or an interrupt is due."""
        return self.spin_now is not None and self._interruptible and not self._wake

    # Instructions --------------------------------------------------------------

    def instruction(self, cycles: int) -> None:
        """One instruction, or an inseparable few: interrupts wait for its end."""
        cycle = self.cycle + cycles
        if cycle >= self._lease:
            self._go_to(cycle)
        self.cycle = cycle
        core = self.core
        if core.ifr or core.next_wake <= cycle or core.owes_instruction:
            self._serve()

    def compute(self, cycles: int, name: str = "") -> None:
        """A stretch of single-cycle instructions; interrupts cut in at any of them. A name makes it a span."""
        if name:
            self.mark_span(name, 1)
        self.busy_cycles += cycles
        self._run(cycles)
        if name:
            self.mark_span(name, 0)

    def _run(self, cycles: int) -> None:
        """Straight-line code: interrupts cut in at each cycle."""
        end, core = self.cycle + cycles, self.core
        if end < self._lease and core.next_wake > end and not core.ifr and not core.owes_instruction:
            self.cycle = end
            return
        left = cycles
        while left > 0:
            if self._lands < NEVER:  # one by one until the posted writes have landed
                self.instruction(1)
                left -= 1
                continue
            began = self.cycle
            self._rest_until(began + left)
            left -= self.cycle - began
            if core.ifr or core.next_wake <= self.cycle:
                self._serve()

    def mark_span(self, name: str, begins: int) -> None:
        """Record that a named stretch of firmware begins (1) or ends (0) at this cycle."""
        if self._records_span:
            where = self._places.now(1) if begins else ""
            self._recorder.emit(self._clock.tick(self.cycle), Kind.SPAN, self.name, name, begins, where)

    def idle(self) -> None:
        """IDLE: nothing until an interrupt that IER enables; with INTM = 0 it is served first."""
        self.core.idle(self.cycle)
        if self._records_wait:
            self._record_wait(self.cycle, "IDLE", 1)
        self._go_to(self.cycle + cpu_costs.IDLE)
        while not self.core.idle_ends(self.cycle):
            self._rest_until(max(self.cycle, self.core.next_wake))
        if self._records_wait:
            self._record_wait(self.cycle, "IDLE", 0)
        self._serve()

    def _after_main(self) -> None:
        """The endless loop that ends exit() of the run-time library, a branch to itself: service routines still run."""
        while True:
            began = self.cycle
            self._rest_until(NEVER)
            passes = max(1, -(-(self.cycle - began) // cpu_costs.SB_ALWAYS))
            self._go_to(began + passes * cpu_costs.SB_ALWAYS)
            self._serve()

    def _rest_until(self, cycle: int) -> None:
        """Sleep to `cycle`, or to the boundary at which an interrupt can be taken."""
        kernel = self._kernel
        cycle = min(cycle, max(self.cycle, self.core.earliest()))
        if cycle < NEVER:
            tick = self._clock.tick(cycle)
            if tick < kernel.quiet_until():
                kernel.now = max(kernel.now, tick)
                self.cycle = cycle
                return
            self._wake_at(cycle)
        self._interruptible = True
        self._sleep()
        self._interruptible = False
        self.cycle = max(self.cycle, min(cycle, self._clock.cycle_at(kernel.now)))

    def _record_wait(self, cycle: int, what: str, begins: int) -> None:
        where = self._places.now(2) if begins else ""
        self._recorder.emit(self._clock.tick(cycle), Kind.WAIT, self.name, what, begins, where)

    # Interrupts --------------------------------------------------------------

    def request(self, cycle: int, number: int) -> None:
        """INTn was pulsed at `cycle`."""
        self.core.raise_line(cycle, number)
        if self._interruptible:
            due = self.core.next_wake if self.core.idlestat else self.core.earliest()
            if due < NEVER:
                self.resume_by(max(due, cycle))

    def _serve(self) -> None:
        """Take every interrupt that can be taken at this instruction boundary."""
        if self.core.owes_instruction:
            self.core.instruction_done()
        number = self.core.next_taken(self.cycle)
        while number:
            self._enter(number)
            number = self.core.next_taken(self.cycle)

    def _enter(self, number: int) -> None:
        spin, self.spin_now = self.spin_now, None
        began, busy = self.cycle, self.busy_cycles
        core = self.core
        core.enter(began, number)
        self._go_to(began + core.vector_delay)
        vector = self._fetch_vector(number)
        self._go_to(began + core.entry_cycles)
        handler = self.handlers.get(vector)
        if handler is None:
            raise FirmwareError(
                f"{self.name}: interrupt {vector} was taken at cycle {self.cycle}, but firmware gave it no handler; "
                f"it has {', '.join(self.handlers) or 'none'}. Give it one with dsp.handle({vector!r}, routine)."
            )
        outer = self._recorder.cause
        if self._records_irq:
            tick, where = self._clock.tick(self.cycle), self._places.of(handler) or ""
            self._recorder.cause = self._recorder.emit(tick, Kind.IRQ, self.name, vector, 1, where)
        self._run(self._code.isr_prologue)
        handler()
        self._run(self._code.isr_epilogue)
        core.iret(self.cycle)
        self._go_to(self.cycle + cpu_costs.IRET)
        if self._records_irq:
            self._recorder.emit(self._clock.tick(self.cycle), Kind.IRQ, self.name, vector, 0)
        self._recorder.cause = outer
        self.busy_cycles = busy + self.cycle - began
        self.spin_now = spin
        if spin is not None:
            spin.hold_up(self.cycle - began)
        self._take_notes()

    def _fetch_vector(self, number: int) -> str:
        """The name of the vector taken for INTn at this cycle."""
        if number > GROUPS:
            address = self._pie.cpu_vector(self.cycle, number)
        else:
            _, address = self._pie.vector(self.cycle, number)
        name = NAME_OF.get(address)
        if name is None:
            raise FirmwareError(
                f"{self.name}: INT{number} was taken at cycle {self.cycle} with PIECTRL.ENPIE = 0, so its vector "
                f"comes from boot ROM ({address:#x}), where no routine of this firmware is; "
                "set ENPIE before interrupts are enabled."
            )
        return name

    def _take_notes(self) -> None:
        for note in self.core.notes:
            self.note(note)
        self.core.notes.clear()

    def note(self, note: Note) -> None:
        """Tell something about the firmware."""
        self.insist(note, self.name)
        self.notes[note] = self.notes.get(note, 0) + 1
        if self._recorder.wants(Kind.NOTE):
            tick = self._clock.tick(self.cycle)
            self._recorder.emit(tick, Kind.NOTE, self.name, note.code, self.notes[note], note.text)

    def insist(self, note: Note, who: str) -> None:
        """With `strict` a duty that the firmware breaks ends the run: FirmwareError. who: noted it."""
        if self.strict and note.code == "duty":
            at = self._clock.timebase.show(self._kernel.now)
            where = self.stands_at()
            place = "" if where is None else f", {where.for_people()}"
            raise FirmwareError(f"{who}{place}, at {at}: {note.text} [{note.source}]")

    # Instructions about interrupts and protection -------------------------------

    def eint(self) -> None:
        self._core_instruction(self.core.clrc_intm, cpu_costs.CLRC_INTM)

    def dint(self) -> None:
        self._core_instruction(self.core.setc_intm, cpu_costs.SETC_INTM)

    def eallow(self) -> None:
        self.core.set_eallow(self.cycle, True)
        self.instruction(cpu_costs.EALLOW)

    def edis(self) -> None:
        self.core.set_eallow(self.cycle, False)
        self.instruction(cpu_costs.EDIS)

    def or_ier(self, mask: int) -> None:
        self.core.or_ier(self.cycle, mask)
        self.instruction(cpu_costs.OR_IER)

    def and_ier(self, mask: int) -> None:
        self.core.and_ier(self.cycle, mask)
        self.instruction(cpu_costs.AND_IER)

    def nop(self) -> None:
        self.instruction(cpu_costs.SIMPLE)

    def _core_instruction(self, begin: Callable[[int], None], cycles: int) -> None:
        begin(self.cycle)
        self._take_notes()
        self.instruction(cycles)
