"""The C28x as Python firmware uses it: accesses, computations, waits and instructions, with their cycles.

firmware --> Cpu --> Accesses, Waits --> Instructions --> Processor
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable

from ...core.records import Recorder
from ...core.time import Clock
from ...f28335.cpu import code_costs as cpu_costs
from ...f28335.cpu.code_costs import BARE, CodeCosts
from ...f28335.system_options import SystemOptions
from ...form.c_types import Text
from ..processor import Processor
from .accesses import Accesses, Instructions
from .program import CodeRecords, PythonProgram
from .waits import Waits


class Cpu:
    """One processor with its Python firmware.

    accesses: register accesses, by operand or address.
    waits: waits for conditions.
    skip_polls: False executes every pass of every spin.
    """

    def __init__(
        self,
        processor: Processor,
        clock: Clock,
        recorder: Recorder,
        options: SystemOptions,
        *,
        code: CodeCosts = BARE,
        skip_polls: bool = True,
    ) -> None:
        self.processor = processor
        self.time = processor.time
        self.program = PythonProgram(processor)
        self._core = processor.interrupts.core
        self._records = CodeRecords(clock, recorder, self.program)
        self._instructions = Instructions(processor, self.program, code)
        self.accesses = Accesses(processor, self.program, self._instructions, code)
        self.waits = Waits(
            processor,
            self.program,
            self._instructions,
            self._records,
            poll_pass=code.poll_pass,
            pf2_read_ws=options.pf2_read_ws,
            skip_polls=skip_polls,
        )

    # Life --------------------------------------------------------------------

    def start(self, firmware: Callable[[], None], delay: int = 0) -> None:
        """Run `firmware`, beginning `delay` cycles after now."""
        self.program.begin(firmware, lambda: self._instructions.after_main())
        self.processor.start(self.program, delay)

    @property
    def cycle(self) -> int:
        """Number of SYSCLKOUT cycles that have passed."""
        return self.time.cycle

    # Code ----------------------------------------------------------------------

    def load(self, address: int, width: int = 16) -> int:
        """Return a 16- or 32-bit value from an address. Raise NoSuchAddress if nothing is there."""
        return self.accesses.load(address, width)

    def store(self, address: int, value: int, width: int = 16) -> None:
        """Write 16 or 32 bits to an address. Raise NoSuchAddress if nothing is there."""
        self.accesses.store(address, value, width)

    def instruction(self, cycles: int) -> None:
        """Execute one instruction, or an inseparable group: interrupts wait for its end."""
        self._instructions.instruction(cycles)

    def compute(self, cycles: int, name: Text = "") -> None:
        """Execute single-cycle instructions, interruptible after each of them. A name makes it a span."""
        if name:
            self.mark_span(name, 1)
        self._instructions.run(cycles)
        if name:
            self.mark_span(name, 0)

    def mark_span(self, name: str, begins: int) -> None:
        """Record that a named stretch of firmware begins (1) or ends (0) at this cycle."""
        self._records.span(self.time.cycle, name, begins)

    def idle(self) -> None:
        """Execute IDLE: wait for an interrupt that IER enables; with INTM = 0 it is served first."""
        self._records.wait(self.time.cycle, "IDLE", 1)
        self._instructions.idle()
        self._records.wait(self.time.cycle, "IDLE", 0)
        self._instructions.serve()

    # Interrupt and protection instructions -------------------------------------------

    def eint(self) -> None:
        self._core.clrc_intm(self.time.cycle)
        self._note_and_pass(cpu_costs.CLRC_INTM)

    def dint(self) -> None:
        self._core.setc_intm(self.time.cycle)
        self._note_and_pass(cpu_costs.SETC_INTM)

    def eallow(self) -> None:
        self._core.set_eallow(self.time.cycle, True)
        self._instructions.instruction(cpu_costs.EALLOW)

    def edis(self) -> None:
        self._core.set_eallow(self.time.cycle, False)
        self._instructions.instruction(cpu_costs.EDIS)

    def or_ier(self, mask: int) -> None:
        self._core.or_ier(self.time.cycle, mask)
        self._instructions.instruction(cpu_costs.OR_IER)

    def and_ier(self, mask: int) -> None:
        self._core.and_ier(self.time.cycle, mask)
        self._instructions.instruction(cpu_costs.AND_IER)

    def nop(self) -> None:
        self._instructions.instruction(cpu_costs.SIMPLE)

    def _note_and_pass(self, cycles: int) -> None:
        self.processor.interrupts.take_notes(self.time.cycle)
        self._instructions.instruction(cycles)
