"""Register accesses of Python firmware, with the cycles that they take.

firmware --> wait for writes, wait states --> Bus --> value, or a posted write --> boundary
                                                ^--- reads of a replayed pass of a wait return the earlier values
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import Note
from ...f28335.cpu import instruction_costs as cpu_costs
from ...f28335.cpu.compiled_code_costs import CodeCosts
from ...f28335.memory.ram import block_at
from ..bus import Bus
from ..cpu_time import CpuTime
from ..operand import Operand
from ..polling import Spin
from ..processor import Processor
from ..source_location import SourceLocation
from ..user_code import warn
from .instructions import Instructions
from .program import PythonProgram

MANY_READS = 1000  # registers read in a row, without a write or a wait
CYCLES_OF_A_PASS = 100  # most cycles for each read of a loop that only polls
POLLING = Note(
    "polling",
    "a loop polls registers pass by pass, which takes long to simulate; wait with dsp.spin(lambda: CONDITION), which "
    "skips the passes",
    "firmware in Python",
)


@final
class Accesses:
    """Register and memory accesses: each takes one cycle and the frame's wait states."""

    __slots__ = (
        "_between",
        "_bus",
        "_instructions",
        "_notes",
        "_polling_places",
        "_program",
        "_reads",
        "_reads_from",
        "_time",
    )

    _between: int

    def __init__(
        self, processor: Processor, program: PythonProgram, instructions: Instructions, code: CodeCosts
    ) -> None:
        self._between = code.between_accesses
        self._bus: Bus = processor.bus
        self._instructions = instructions
        self._program = program
        self._time: CpuTime = processor.time
        self._notes = processor.notes
        self._reads = 0  # since the last write or wait
        self._reads_from = 0  # the latest cycle at which they may have begun
        self._polling_places: set[str] = set()

    def read(self, operand: Operand, where: SourceLocation | None = None) -> int:
        """Return the value of the operand's words, each in its place. where: the statement, if known."""
        time, instructions, spin = self._time, self._instructions, self._program.spin
        if spin is None:
            instructions.run(self._between)
            self._reads += 1
            if self._reads == MANY_READS:
                self._check_for_polling()
        elif spin.made:
            instructions.instruction(cpu_costs.SB_NOT_TAKEN)  # the test of the previous value
        bus = self._bus
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
                instructions.go_to(at)
            if operand.looks and (where is not None or not operand.placed):
                value = operand.chip.see(at, operand.offset)
                if operand.recorded:
                    bus.record_poll(at, operand, value, where)
            else:
                value = self._fetch(operand)
        if spin is not None:
            spin.note(operand, value, where)
            self._reads = 0
        instructions.instruction(1)
        return value

    def _check_for_polling(self) -> None:
        """Note, once for each place, a loop that reads registers pass by pass without `dsp.spin`."""
        cycle = self._time.cycle
        dense = cycle - self._reads_from < MANY_READS * CYCLES_OF_A_PASS
        self._reads, self._reads_from = 0, cycle
        where = self._program.place() if dense and self._program.placed is None else None
        if where is not None and where not in self._polling_places:
            self._polling_places.add(where)
            self._notes.note(cycle, POLLING)
            warn(f"{self._program.name}, {where.for_people()}: {POLLING.text}")

    def write(self, operand: Operand, value: int) -> None:
        """Write the operand's words, each in its place in `value`."""
        self._before_write()
        at = self._bus.posts_at(self._time.cycle, operand)
        self._instructions.go_to(at)
        self._bus.store(at, operand, value)
        self._instructions.instruction(1)

    def modify(self, operand: Operand, number: int) -> None:
        """Write a bit field by a read-modify-write of its word."""
        self._before_write()
        time = self._time
        self._wait_for_writes(operand, self._program.spin)
        self._instructions.go_to(time.cycle + self._bus.read_waits(operand))
        if operand.meets:
            time.meet()
        self._bus.modify(time.cycle, operand, number)
        self._instructions.instruction(1)

    def load(self, address: int, width: int = 16) -> int:
        """Return a 16- or 32-bit value from an address. Raise NoSuchAddress if nothing is there."""
        bus, time, instructions = self._bus, self._time, self._instructions
        if block_at(address) is not None:
            instructions.run(self._between)
            instructions.go_to(bus.reads_at(time.cycle, address, width))
            value = bus.read(time.cycle, address, width)
            instructions.instruction(1)
            return value
        operand = bus.at(address, width)
        if width == 32 and operand.frame2:
            self._refuse(operand)
            return 0
        return self.read(operand) >> operand.shift

    def store(self, address: int, value: int, width: int = 16) -> None:
        """Write 16 or 32 bits to an address. Raise NoSuchAddress if nothing is there."""
        bus, time, instructions = self._bus, self._time, self._instructions
        if block_at(address) is not None:
            self._before_write()
            instructions.go_to(bus.writes_at(time.cycle, address, width))
            bus.write(time.cycle, address, value, width)
            instructions.instruction(1)
            return
        operand = bus.at(address, width)
        if width == 32 and operand.frame2:
            self._refuse(operand)
        else:
            self.write(operand, value << operand.shift)

    def _refuse(self, operand: Operand) -> None:
        """Let the cycles of an access pass whose width the frame does not support; it has no effect."""
        self._instructions.instruction(1 + self._bus.read_waits(operand))
        self._bus.note_width(self._time.cycle, operand)

    def _fetch(self, operand: Operand) -> int:
        if operand.meets:
            self._time.meet()
        return self._bus.fetch(self._time.cycle, operand)

    def _wait_for_writes(self, operand: Operand, spin: Spin | None) -> None:
        free, cycle = self._bus.free(operand), self._time.cycle
        if cycle < free:
            if spin is not None:
                spin.hold_up(free - cycle)
            self._instructions.go_to(free)

    def _before_write(self) -> None:
        """Execute the code between two accesses. A pass of a wait has its own; one with a write is not skipped."""
        spin = self._program.spin
        self._reads = 0
        if spin is None:
            self._instructions.run(self._between)
        else:
            spin.pure = False
