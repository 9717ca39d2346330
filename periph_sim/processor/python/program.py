"""A Python function as a program: the function goes in; it runs in a greenlet, until it must wait or is over.

    Processor.run --> greenlet --> firmware --> instructions --> give_way --> back in run, with the reason

Service routines have code addresses of their own, so that their vectors are words in the PIE's table as any others.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from threading import get_ident

from greenlet import GreenletExit, getcurrent, greenlet

from ...core.chip import NEVER
from ...f28335.cpu.pie_map import VECTORS
from ..error_origin import FirmwareError, FirmwareStalled, Misuse, raised_at
from ..processor import Processor
from ..program import Program, Stop
from ..source_location import SourceLocation, SourceLocator
from ..stall_watch import NoProgress, watch

ROUTINES = 0x30_0000  # service routines begin in flash, as far from its begin as their vector in the table is from 0

Handler = Callable[[], None]


class PythonProgram(Program):
    """handlers: service routines by vector. entered: the routine that is to be called now.

    stall_limit: seconds of CPU time that the firmware may take at one instant; 0: any.
    thread: that runs the firmware, while it does.
    """

    def __init__(self, processor: Processor) -> None:
        super().__init__()
        self.name = processor.name
        self.handlers: dict[str, Handler] = {}
        self.entered: Handler | None = None
        self.stall_limit = 0.0
        self.thread = 0
        self._processor = processor
        self._code: dict[int, Handler] = {}  # service routines by their code address
        self._places = SourceLocator()
        self._greenlet: greenlet | None = None
        self._hub: greenlet | None = None

    # Life --------------------------------------------------------------------

    def begin(self, firmware: Callable[[], None], after_main: Callable[[], None]) -> None:
        """Run `firmware` from its beginning on when the processor next runs this program.

        after_main: what is executed once it has returned.
        """
        self.returned_at = None

        def body() -> Stop:
            try:
                firmware()
                self._land()
            except NoProgress as stopped:
                self._processor.time.meet()  # the run ends now
                at, limit = raised_at(stopped), f"{self.stall_limit:g} s of CPU time"
                text = f"{self.name} let no simulated time pass for {limit} at {at}; give it an access, compute or spin"
                raise FirmwareStalled(text) from None
            except Misuse as error:
                at = raised_at(error)
                raise FirmwareError(f"{self.name}{f', {at}' if at else ''}: {error}") from error
            except Exception as error:
                blamed = raised_at(error)
                if not blamed or isinstance(error, FirmwareError):
                    raise
                text = str(error.args[0]) if error.args else "no message"
                raise FirmwareError(f"{self.name}: {type(error).__name__} at {blamed}: {text}") from error
            self.returned_at = self._processor.time.cycle
            after_main()
            return Stop.ENDED

        self._greenlet = greenlet(body)
        if self.stall_limit:
            watch.add(self)

    def run(self, until: int) -> Stop:
        assert self._greenlet is not None
        self._hub = getcurrent()
        self.thread = thread = get_ident()
        try:
            stop: Stop = self._greenlet.switch()
        finally:
            self.thread = 0
            if self.stall_limit and watch.has_stopped:
                watch.leave(thread)
        return stop

    def give_way(self, why: Stop = Stop.WAITS) -> None:
        """Stop here; returns when the program is run again."""
        assert self._hub is not None, "firmware calls the CPU only from inside a run"
        self._hub.switch(why)

    def kill(self, how: type[BaseException]) -> None:
        """`how` is raised in the firmware, so that its `finally` blocks run."""
        Program.kill(self, how)
        dying, self._greenlet = self._greenlet, None
        if dying is not None and not dying.dead:
            dying.throw(how)

    def let_go(self) -> None:
        """Its `finally` blocks run, and no simulated time passes in them; what goes wrong there concerns nobody."""
        Program.kill(self, GreenletExit)
        dying, self._greenlet = self._greenlet, None
        if dying is None or dying.dead:
            return
        with suppress(Exception):  # the other way: that it is let go of in a thread that cannot end it
            dying.parent = self._hub = getcurrent()
            dying.throw(GreenletExit)

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
        running = self._greenlet
        if running is None or running.dead:
            return None
        return self._places.of_frame(sys._getframe() if getcurrent() is running else running.gr_frame)

    def handle(self, vector: str, routine: Handler) -> None:
        """Make `routine` the service routine of a vector: its address is stored in the PIE's table."""
        entry = VECTORS[vector]
        self.handlers[vector] = routine
        self._code[ROUTINES + entry] = routine
        self._processor.bus.ram.put_word32(entry, ROUTINES + entry)

    def enter(self, vector: int) -> str:
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
