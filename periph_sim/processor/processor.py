"""One CPU: its time, bus and interrupts, and the program that runs on them.

    kernel --wake-up--> Processor --run--> Program --> Bus, Interrupts, CpuTime
                            ^--- reach, rest, take, iret: what the program has to wait for; stops

What takes time is asked for here. The answer True says that it is done, and the program goes on in the same call; after
False it stops, the rest is done when the kernel wakes this CPU, and then the program is run again.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ..core.kernel import Agent, Kernel
from ..core.records import Recorder
from ..core.state import State
from ..core.time import Clock
from ..f28335.cpu import instruction_costs as cpu_costs
from ..f28335.cpu.interrupts import CpuInterrupts
from ..f28335.cpu.pie import Pie
from ..f28335.system.memory_map import AddressMap
from ..f28335.system.options import SystemOptions
from .bus import Bus
from .cpu_time import CpuTime
from .firmware_notes import FirmwareNotes
from .interrupts import Interrupts
from .program import Program, Stop
from .source_location import SourceLocation

NONE, FETCHES, ENTERS, RETURNS = range(4)  # what is under way: the vector's fetch, the entry, IRET


@final
class Processor(Agent):
    """stopped: why the program stopped last; None where none has run."""

    STATE = State("time notes bus interrupts stopped _under_way _vector", cycles="_goal", records="_cause")

    __slots__ = (
        "_cause",
        "_goal",
        "_outer",
        "_program",
        "_recorder",
        "_under_way",
        "_vector",
        "bus",
        "interrupts",
        "kernel",
        "name",
        "notes",
        "stopped",
        "time",
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
        self.stopped: Stop | None = None
        self.time = CpuTime(kernel, clock, self)
        self.notes = FirmwareNotes(kernel, clock, recorder, name, strict, self.stands_at)
        self.bus = Bus(name, self.time, clock, recorder, memory, core, self.notes, options, self._place)
        self.interrupts = Interrupts(name, core, pie, self.bus.ram, self.time, clock, recorder, self.notes)
        self._recorder = recorder
        self._program: Program | None = None
        self._cause = 0  # under which record the program goes on
        self._goal = 0  # the cycle that it is to reach
        self._outer = 0  # under which record the kernel gave it its turn
        self._under_way = NONE
        self._vector = 0

    @property
    def program(self) -> Program:
        if self._program is None:
            raise RuntimeError(f"{self.name} has no program; give it one with Processor.start")
        return self._program

    # Life --------------------------------------------------------------------

    def start(self, program: Program, delay: int = 0) -> None:
        """Run a program from its beginning on, `delay` cycles after now."""
        self._program = program
        self._cause = 0
        self.time.begin(delay)

    def kill(self, how: type[BaseException]) -> None:
        """Stop the program where it stands; what it posted does not land. how: raised in it, if it is Python."""
        self._forget()
        if self._program is not None:
            self._program.kill(how)
            self._forget()  # what it still asked for as it ended

    def _forget(self) -> None:
        """Nothing that the program is waiting for will come."""
        self.time.stop()
        self.bus.forget()
        self.interrupts.forget()
        self._under_way = NONE
        self._goal = 0

    def stands_at(self) -> SourceLocation | None:
        """The statement to blame for what happens now: of the write that lands, or the one that runs or goes on next.

        None where the program has not begun or is over.
        """
        return self._place() if self.bus.issued_at is None else self.bus.issued_at

    def _place(self) -> SourceLocation | None:
        return None if self._program is None else self._program.place()

    def act(self, tag: int) -> None:
        """The cycle has come for which a wake-up was promised."""
        time, recorder = self.time, self._recorder
        time.arrive()
        self._outer, recorder.cause = recorder.cause, self._cause
        why = self.stopped
        if (time.cycle >= self._goal or self.reach(self._goal)) and (not self._under_way or self._go_on()):
            assert self._program is not None
            why = self._program.run(time.renew())
            if why is None:
                return
        self.stops(why)

    def stops(self, why: Stop | None) -> None:
        """The program's turn is over, for this reason."""
        recorder = self._recorder
        self.stopped = why
        self._cause, recorder.cause = recorder.cause, self._outer

    # What takes time ------------------------------------------------------------

    def reach(self, cycle: int) -> bool:
        """Let time pass to `cycle`, which no interrupt cuts short; posted writes of earlier cycles land on the way."""
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
        """Sleep to `cycle`, or to the boundary at which an interrupt can be taken."""
        now = self.time.cycle
        self._goal = 0
        return self.time.rest(min(cycle, max(now, self.interrupts.core.earliest())))

    def next_output(self, cycle: int) -> int:
        """Before this cycle nothing that the program writes reaches a register. cycle: of the next wake-up."""
        first = max(cycle, self._goal)
        if self._under_way == FETCHES:
            first = max(first, self.interrupts.core.ready)
        return min(self.time.lands, first + self.bus.lands_after)

    def take(self, number: int) -> bool:
        """Take this interrupt at the present boundary: context, vector, and the program enters its routine."""
        self.interrupts.take(self.time.cycle, number, self.program.context())
        core = self.interrupts.core
        self._under_way = FETCHES
        return self.reach(core.ready - core.entry_cycles + core.vector_delay) and self._go_on()

    def iret(self) -> bool:
        """IRET: the context comes back, and after its 8 cycles the program goes on with what was interrupted."""
        words = self.interrupts.iret(self.time.cycle)
        self.program.restore(words)
        self._under_way = RETURNS
        return self.reach(self.time.cycle + cpu_costs.IRET) and self._go_on()

    def _go_on(self) -> bool:
        """The next steps of what is under way, up to its end or to where time has to pass."""
        if self._under_way == FETCHES:
            self._vector = self.interrupts.fetch(self.time.cycle)
            self._under_way = ENTERS
            if not self.reach(self.interrupts.core.ready):
                return False
        under_way, self._under_way = self._under_way, NONE
        if under_way == ENTERS:
            where = self.program.enter(self._vector)
            self.interrupts.entered(self.time.cycle, where)
        else:
            self.interrupts.returned(self.time.cycle)
        return True
