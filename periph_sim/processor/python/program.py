"""A Python function as a program, which runs in a greenlet until it must wait or returns.

    Processor.act --> run --> greenlet --> firmware --> instructions --> yield_turn --> Kernel.run_nested until next run

A program that yields its turn runs the due events on its own stack. The stack changes only when another program
continues, or when the outer loop, which is the event loop of `Kernel.run_until`, must continue: for a plain callback,
at the end of the simulation run, or because an event raises an exception. This exception is not raised in the firmware,
but in the outer loop.

Each service routine has a code address, so that its vector is an ordinary word in the vector table of the PIE.
"""

# core: compiled

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from threading import get_ident, local
from typing import final
from weakref import WeakSet

from greenlet import GreenletExit, getcurrent, greenlet

from ...core.chip import NEVER
from ...core.kernel import Kernel
from ...f28335.pie.register_map import VECTORS
from ...form.c_types import BigInt, Text
from ..processor import Processor, Program
from ..source_location import SourceLocation, SourceLocator
from ..user_code import (
    FirmwareError,
    FirmwareLost,
    FirmwareStalled,
    NoProgress,
    as_firmware_error,
    output_aside,
    raised_at,
    watch,
)

ROUTINES = 0x30_0000  # the code address of a service routine is this number plus the address of its vector

Handler = Callable[[], None]


class _ProgramsOfThread:  # core: python
    """The programs that one thread has begun; no other thread can run or end them.

    alive: the programs that still exist. They end when the thread ends, since its variables are deleted then.
    leftovers: the programs whose scene was deleted in another thread. They end when this thread begins a program.
    """

    def __init__(self) -> None:
        self.alive: WeakSet[PythonProgram] = WeakSet()
        self.leftovers: list[PythonProgram] = []

    def begin(self, program: PythonProgram) -> None:
        self.alive.add(program)
        while self.leftovers:
            self.leftovers.pop().end_quietly()

    def __del__(self) -> None:
        if not sys.is_finalizing():  # at the end of Python, the modules needed here may be deleted already
            for program in list(self.alive):
                program.end_quietly()


class _Threads(local):
    def __init__(self) -> None:
        self.programs = _ProgramsOfThread()


_threads = _Threads()


@final
class PythonProgram(Program):
    """A program that consists of Python functions.

    handlers: the service routines, by the names of their vectors.
    entered: the service routine that must be called next.
    stall_limit: seconds of CPU time that the firmware may take at one instant of simulated time; 0 if unlimited.
    placed: returns the present statement of firmware that is not written in Python; None for Python firmware.
    thread: the id of the thread that executes the firmware now; 0 if none does.
    places: the statements of the firmware that is written in Python.
    """

    __weakref__: object

    def __init__(self, processor: Processor) -> None:
        super().__init__()
        self.name = processor.name
        self.stops_itself = True
        self.handlers: dict[str, Handler] = {}
        self.entered: Handler | None = None
        self.stall_limit: float = 0.0
        self.placed: Callable[[], SourceLocation | None] | None = None
        self.thread: BigInt = 0
        self._kernel: Kernel = processor.kernel
        self._processor = processor
        self._code: dict[int, Handler] = {}  # maps a code address to the service routine
        self.places = SourceLocator()
        self._greenlet: greenlet | None = None
        self._leftovers: list[PythonProgram] = []  # `leftovers` of the thread that has begun this program
        self._watched: BigInt = 0  # the id of the thread that has begun the firmware
        self._stops: list[int] = watch.stops

    # Start and end -----------------------------------------------------------

    def begin(self, firmware: Callable[[], None], after_main: Callable[[], None]) -> None:
        """Prepare the program so that the next `run` calls `firmware`.

        after_main: called when `firmware` has returned and its posted writes have landed.
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
        """Execute the program. Raise FirmwareError for errors of the firmware."""
        self._watched = self.thread = get_ident()
        processor = self._processor
        try:
            firmware()
            while processor.time.lands < NEVER:  # main has ended when all its posted writes have landed
                if not processor.reach(processor.time.lands + 1):
                    self.yield_turn()
            self.returned_at = processor.time.cycle
            after_main()
        except NoProgress as stopped:
            self._processor.time.meet()  # sets the kernel's time to the instant at which the run ends
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
        """End the turn of firmware that has returned or raised. If it was not killed, let the outer loop continue."""
        self._end_watch()
        if self._greenlet is not None:
            self._processor.stops()
            self._greenlet.parent = self._outer_loop()

    # Turns -------------------------------------------------------------------

    def run(self) -> None:
        """Continue this program. When it stops, `yield_turn` reports the stop to the processor.

        This call does not return when the program stops. It returns when the greenlet of its caller is resumed; another
        program may run before that.
        """
        kernel = self._kernel
        kernel.released = True
        if kernel.nested_owner is not self:
            self._switch()

    def _switch(self) -> None:
        kernel, program = self._kernel, self._greenlet
        assert program is not None
        here = getcurrent()
        if here is program:
            raise RuntimeError(f"{self.name} cannot continue inside an event that it started itself")
        if kernel.nested_owner is None:
            kernel.outer_loop = here
        kernel.nested_owner = None
        program.switch()
        fault, kernel.fault = kernel.fault, None
        if fault is not None:
            try:
                raise fault
            finally:
                del fault

    def yield_turn(self) -> None:
        """Stop the program, and return when it is run again.

        Until then, events run inside this call as long as `Kernel.run_nested` can run them, and then in the outer loop.
        """
        kernel, program = self._kernel, self._greenlet
        if program is None:  # the program was killed, so it never continues
            ender = getcurrent().parent
            assert ender is not None
            ender.switch()
            raise GreenletExit
        self._processor.stops()
        self._end_watch()
        try:
            goes_on = kernel.run_nested(self)
        except BaseException as error:
            if isinstance(error, GreenletExit) or self._greenlet is not program:
                raise
            kernel.nested_owner, kernel.fault = None, error
            goes_on = False
        if not goes_on:
            self._outer_loop().switch()
        self.thread = self._watched

    def _outer_loop(self) -> greenlet:
        outer_loop = self._kernel.outer_loop
        assert isinstance(outer_loop, greenlet), "firmware calls the CPU only from inside a run"
        return outer_loop

    def _end_watch(self) -> None:
        """End the watch for stalls: until `thread` is set again, CPU time does not count as that of the firmware."""
        self.thread = 0
        if self.stall_limit and self._stops:
            watch.leave(self._watched)

    def kill(self) -> None:
        """End the program: raise GreenletExit in the firmware, so that its `finally` blocks run."""
        Program.kill(self)
        dying, self._greenlet = self._greenlet, None
        if dying is not None and not dying.dead:
            dying.parent = getcurrent()  # `throw` returns here when the firmware has ended, or has to wait
            self.thread = self._watched
            try:
                dying.throw(GreenletExit)
            finally:
                self._end_watch()

    def release(self) -> None:
        """End the program: run the `finally` blocks of the firmware in no simulated time, and ignore their errors.

        Only the thread that has begun the program can do this. Any other thread adds the program to the `leftovers` of
        that thread.
        """
        if self._leftovers is _threads.programs.leftovers:
            self.end_quietly()
        elif self._greenlet is not None:
            self._leftovers.append(self)

    def end_quietly(self) -> None:
        with suppress(Exception, NoProgress), output_aside():
            self.kill()

    def instant(self) -> tuple[int, int]:
        """Return two numbers. At least one of them changes whenever simulated time passes."""
        return self._processor.time.instant()

    # Places and routines ---------------------------------------------------------

    def place(self) -> SourceLocation | None:
        """Return the innermost statement of the firmware that is executed; None before main begins.

        After main has returned, return the statement of an active service routine; None if there is none.
        """
        if self.placed is not None:
            return self.placed()
        running = self._greenlet
        if running is None or running.dead:
            return None
        return self.places.of_frame(sys._getframe() if getcurrent() is running else running.gr_frame)

    def handle(self, vector: Text, routine: Handler) -> None:
        """Make `routine` the service routine of a vector: store its code address in the vector table of the PIE.

        vector: the name of a vector in this table, which is any vector but RESET.
        """
        entry = VECTORS[vector]
        self.handlers[vector] = routine
        self._code[ROUTINES + entry] = routine
        self._processor.bus.ram.put_word32(entry, ROUTINES + entry)

    def routine(self, address: int, routine: Handler) -> None:
        """Make `routine` the code at an address, which the firmware itself stores as a vector."""
        self._code[address] = routine

    def enter(self, vector: int) -> Text:
        routine = self._code.get(vector)
        if routine is None:
            taken = self._processor.taken
            advice = f"Give it one with dsp.handle({taken!r}, routine)."
            if self._processor.unrequested:
                advice = (
                    "No line of its group was both flagged and enabled when the CPU fetched the vector, so it took "
                    "that of line 1 (SPRUFB0D section 8.3.3): a flag was cleared after its request, or PIEACK was "
                    "written while a request was pending. Write PIEACK before PIEIER."
                )
            raise FirmwareError(
                f"{self.name}: interrupt {taken} was taken at cycle {self._processor.time.cycle}, but firmware gave it "
                f"no handler; it has {', '.join(self.handlers) or 'none'}. {advice}"
            )
        self.entered = routine
        return self.places.of_routine(routine) or ""
