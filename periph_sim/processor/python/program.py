"""A Python function as a program: the function goes in; it runs in a greenlet, until it must wait or is over.

    Processor.act --> run --> greenlet --> firmware --> instructions --> give_way --> Kernel.help, until it is run again

A program that gives way does what is due meanwhile from where it stands: nobody changes stacks until another program is
to go on, or the run is over. What comes of that is no concern of the firmware: an exception is raised at home, where
the kernel was asked to run.

Service routines have code addresses of their own, so that their vectors are words in the PIE's table as any others.
"""

# core: compiled

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from threading import get_ident, local
from types import CodeType
from typing import final
from weakref import WeakSet

from greenlet import GreenletExit, getcurrent, greenlet

from ...core.chip import NEVER
from ...core.kernel import Kernel
from ...f28335.cpu.pie_map import VECTORS
from ...form.c_types import BigInt, Text
from ..error_origin import FirmwareError, FirmwareLost, FirmwareStalled, raised_at
from ..processor import Processor
from ..program import Program, Stop
from ..source_location import SourceLocation, SourceLocator
from ..stall_watch import NoProgress, watch
from ..user_code import as_firmware_error, output_aside

ROUTINES = 0x30_0000  # service routines begin in flash, as far from its begin as their vector in the table is from 0

Handler = Callable[[], None]


class _ProgramsOfThread:  # core: python
    """The programs that a thread has begun: no other thread can run or end them.

    alive: all that still exist. They end with the thread, as its variables are deleted.
    leftovers: those whose scene was freed in another thread. They end as the thread begins its next program.
    """

    def __init__(self) -> None:
        self.alive: WeakSet[PythonProgram] = WeakSet()
        self.leftovers: list[PythonProgram] = []

    def begin(self, program: PythonProgram) -> None:
        self.alive.add(program)
        while self.leftovers:
            self.leftovers.pop().end_quietly()

    def __del__(self) -> None:
        if not sys.is_finalizing():  # Python itself ends, and takes its modules apart
            for program in list(self.alive):
                program.end_quietly()


class _Threads(local):
    def __init__(self) -> None:
        self.programs = _ProgramsOfThread()


_threads = _Threads()


@final
class PythonProgram(Program):
    """handlers: service routines by vector. entered: the routine that is to be called now.

    stall_limit: seconds of CPU time that the firmware may take at one instant; 0: any.
    placed: says where the firmware is, if its statements are none of Python's.
    thread: that runs the firmware, while it does.
    """

    __weakref__: object
    stall_limit: float
    thread: BigInt
    _watched: BigInt
    _stops: list[int]

    def __init__(self, processor: Processor) -> None:
        super().__init__()
        self.name = processor.name
        self.handlers: dict[str, Handler] = {}
        self.entered: Handler | None = None
        self.stall_limit = 0.0
        self.placed: Callable[[], SourceLocation | None] | None = None
        self.thread = 0
        self._kernel: Kernel = processor.kernel
        self._processor = processor
        self._code: dict[int, Handler] = {}  # service routines by their code address
        self._places = SourceLocator()
        self._greenlet: greenlet | None = None
        self._leftovers: list[PythonProgram] = []  # of the thread in which it was begun
        self._watched = 0  # the thread that runs the firmware
        self._stops = watch.stops

    # Life --------------------------------------------------------------------

    def begin(self, firmware: Callable[[], None], after_main: Callable[[], None]) -> None:
        """Run `firmware` from its beginning on when the processor next runs this program.

        after_main: what is executed once it has returned.
        """
        self.returned_at = None
        programs = _threads.programs
        programs.begin(self)
        self._leftovers = programs.leftovers

        def body() -> None:
            try:
                self._execute(firmware, after_main)
            except GreenletExit:
                raise
            except BaseException:
                self._end()
                raise
            self._end()

        self._greenlet = greenlet(body)
        if self.stall_limit:
            watch.add(self)

    def _execute(self, firmware: Callable[[], None], after_main: Callable[[], None]) -> None:
        """All that the program does. FirmwareError, where it is the firmware's fault."""
        self._watched = get_ident()
        self._goes_on()
        try:
            firmware()
            self._land()
            self.returned_at = self._processor.time.cycle
            after_main()
        except NoProgress as stopped:
            self._processor.time.meet()  # the run ends now
            at, limit = raised_at(stopped), f"{self.stall_limit:g} s of CPU time"
            text = f"{self.name} let no simulated time pass for {limit} at {at}; give it an access, compute or spin"
            raise FirmwareStalled(text) from None
        except FirmwareLost:
            self._processor.time.meet()
            raise
        except BaseException as error:
            found = as_firmware_error(error, self.name)
            if found is None:
                raise
            raise found from error

    def _end(self) -> None:
        """The firmware is over, if it was not killed: whoever is at home goes on."""
        self._waits()
        if self._greenlet is not None:
            self._processor.stops(Stop.ENDED)
            self._greenlet.parent = self._home()

    # Turns -------------------------------------------------------------------

    def run(self, until: int) -> None:
        """It is this program's turn. Its stops are told by `give_way`: here another program may come back."""
        kernel = self._kernel
        kernel.released = True
        if kernel.helper is not self:
            self._switch()

    def _switch(self) -> None:
        kernel, program = self._kernel, self._greenlet
        assert program is not None
        here = getcurrent()
        if here is program:
            raise RuntimeError(f"{self.name} was to go on in the middle of something that it had begun itself")
        if kernel.helper is None:
            kernel.home = here
        kernel.helper = None
        program.switch()
        fault, kernel.fault = kernel.fault, None
        if fault is not None:
            try:
                raise fault
            finally:
                del fault

    def give_way(self, why: Stop = Stop.WAITS) -> None:
        """Stop here; returns when the program is run again. What is due meanwhile is done from here."""
        kernel, program = self._kernel, self._greenlet
        if program is None:  # it was killed, and never goes on
            ender = getcurrent().parent
            assert ender is not None
            ender.switch()
            raise GreenletExit
        self._processor.stops(why)
        self._waits()
        try:
            goes_on = kernel.help(self)
        except BaseException as error:
            if isinstance(error, GreenletExit) or self._greenlet is not program:
                raise
            kernel.helper, kernel.fault = None, error
            goes_on = False
        if not goes_on:
            self._home().switch()
        self._goes_on()

    def _home(self) -> greenlet:
        home = self._kernel.home
        assert isinstance(home, greenlet), "firmware calls the CPU only from inside a run"
        return home

    def _goes_on(self) -> None:
        """From here on the firmware is watched."""
        self.thread = self._watched

    def _waits(self) -> None:
        """Nothing that comes up to here is of the firmware."""
        self.thread = 0
        if self.stall_limit and self._stops:
            watch.leave(self._watched)

    def kill(self, how: type[BaseException]) -> None:
        """`how` is raised in the firmware, so that its `finally` blocks run."""
        Program.kill(self, how)
        dying, self._greenlet = self._greenlet, None
        if dying is not None and not dying.dead:
            dying.parent = getcurrent()  # goes on here, and this for good if it has to wait
            self._goes_on()
            try:
                dying.throw(how)
            finally:
                self._waits()

    def let_go(self) -> None:
        """Run its `finally` blocks, in no simulated time; errors in them are ignored.

        In a thread that cannot end it, it is left to the thread that can.
        """
        if self._leftovers is _threads.programs.leftovers:
            self.end_quietly()
        elif self._greenlet is not None:
            self._leftovers.append(self)

    def end_quietly(self) -> None:
        with suppress(Exception, NoProgress), output_aside():
            self.kill(GreenletExit)

    def instant(self) -> tuple[int, int]:
        """What changes with simulated time."""
        return self._processor.time.instant()

    def _land(self) -> None:
        """What main posted last takes effect before main counts as over."""
        processor = self._processor
        while processor.time.lands < NEVER:
            if not processor.reach(processor.time.lands + 1):
                self.give_way()

    # Places and routines ---------------------------------------------------------

    def place(self) -> SourceLocation | None:
        """The innermost statement of the firmware; None where main has not begun or is over."""
        if self.placed is not None:
            return self.placed()
        running = self._greenlet
        if running is None or running.dead:
            return None
        return self._places.of_frame(sys._getframe() if getcurrent() is running else running.gr_frame)

    def place_in(self, code: CodeType, line: int) -> SourceLocation | None:
        """What `place` says as this line of a code runs; None where that is not known."""
        return None if self.placed is not None else self._places.of_line(code, line)

    def handle(self, vector: Text, routine: Handler) -> None:
        """Make `routine` the service routine of a vector: its address is stored in the PIE's table."""
        entry = VECTORS[vector]
        self.handlers[vector] = routine
        self._code[ROUTINES + entry] = routine
        self._processor.bus.ram.put_word32(entry, ROUTINES + entry)

    def routine(self, address: int, routine: Handler) -> None:
        """Make `routine` what a code address stands for, which firmware stores as a vector by itself."""
        self._code[address] = routine

    def enter(self, vector: int) -> Text:
        routine = self._code.get(vector)
        if routine is None:
            taken = self._processor.interrupts.taken
            raise FirmwareError(
                f"{self.name}: interrupt {taken} was taken at cycle {self._processor.time.cycle}, but firmware gave it "
                f"no handler; it has {', '.join(self.handlers) or 'none'}. "
                f"Give it one with dsp.handle({taken!r}, routine)."
            )
        self.entered = routine
        return self._places.of(routine) or ""
