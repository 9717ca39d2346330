"""The time of one CPU: its firmware goes in; it runs in a greenlet, and is resumed when the cycle it waits for comes.

    firmware --> cycles on this CPU's clock --> kernel
                     ^--- posted writes land on the way

As long as nothing else can happen (`Kernel.quiet_until`: a lease) the CPU moves time itself; else it gives way to the
kernel and is resumed by an event.
"""

from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from collections.abc import Callable
from threading import get_ident

from greenlet import getcurrent, greenlet

from ..core.chip import NEVER
from ..core.kernel import CPU, Kernel
from ..core.records import Recorder
from ..core.time import Clock
from .error_origin import FirmwareError, FirmwareStalled, Misuse, raised_at
from .source_location import SourceLocation, SourceLocator
from .stall_watch import NoProgress, watch


class CpuTime(ABC):
    """cycle: how many SYSCLKOUT cycles have passed for this CPU. returned_at: the cycle at which main returned."""

    __slots__ = (
        "__weakref__",
        "_clock",
        "_greenlet",
        "_hub",
        "_interruptible",
        "_issued_at",
        "_kernel",
        "_lands",
        "_lease",
        "_places",
        "_recorder",
        "_wake",
        "_wake_cycle",
        "_wake_tick",
        "cycle",
        "name",
        "returned_at",
        "stall_limit",
        "thread",
    )

    def __init__(self, kernel: Kernel, clock: Clock, recorder: Recorder, name: str) -> None:
        self.name = name
        self.cycle = 0
        self.returned_at: int | None = None
        self.stall_limit = 0.0  # seconds of CPU time that firmware may take at one instant; 0: any
        self.thread = 0  # that runs the firmware, while it does
        self._kernel = kernel
        self._clock = clock
        self._recorder = recorder
        self._places = SourceLocator()
        self._greenlet: greenlet | None = None
        self._hub: greenlet | None = None
        self._wake = 0  # the promise by which this CPU is resumed, 0 when there is none
        self._wake_tick = 0
        self._wake_cycle = 0
        self._lease = 0  # before this cycle nothing can act but firmware; 0: not known
        self._lands = NEVER  # the cycle at whose end the next posted write takes effect
        self._interruptible = False  # asleep at an instruction boundary
        self._issued_at: SourceLocation | None = None  # of the write that lands now

    @property
    def finished(self) -> bool:
        """Main has returned."""
        return self.returned_at is not None

    # Life --------------------------------------------------------------------

    def start(self, firmware: Callable[[], None], delay: int = 0) -> None:
        """Run `firmware`, beginning `delay` cycles after now."""
        self.cycle = self._clock.cycle_at(self._kernel.now) + delay
        self.returned_at = None

        def body() -> None:
            try:
                firmware()
                while self._lands < NEVER:
                    self._go_to(self._lands + 1)
            except NoProgress as stopped:
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
            self.returned_at = self.cycle
            self._after_main()

        self._greenlet = greenlet(body)
        self._wake_at(self.cycle)
        if self.stall_limit:
            watch.add(self)

    def instant(self) -> tuple[int, int]:
        return self.cycle, self._kernel.now

    def kill(self, how: type[BaseException]) -> None:
        """Stop the firmware where it stands: `how` is raised in it, so that its `finally` blocks run."""
        if self._wake:
            self._kernel.cancel(self._wake)
            self._wake = 0
        self._lands = NEVER
        self._interruptible = False
        dying, self._greenlet = self._greenlet, None
        if dying is not None and not dying.dead:
            dying.throw(how)

    def reclock(self) -> None:
        """The clock was retuned: a resumption promised for a cycle moves to that cycle's new tick."""
        if self._wake:
            self._kernel.cancel(self._wake)
            self._wake_at(self._wake_cycle)

    def resume_by(self, cycle: int) -> None:
        """Be resumed at `cycle`, or sooner if that is settled already."""
        if not self._wake or self._wake_tick > self._clock.tick(cycle):
            if self._wake:
                self._kernel.cancel(self._wake)
            self._wake_at(cycle)

    def _wake_at(self, cycle: int) -> None:
        tick, now = self._clock.tick(cycle), self._kernel.now
        self._wake_cycle = cycle
        self._wake_tick = tick = tick if tick > now else now
        self._wake = self._kernel.at(tick, self._resume, CPU)

    def _resume(self) -> None:
        self._wake = 0
        self._lease = 0
        self._hub = getcurrent()
        assert self._greenlet is not None
        outer = self._recorder.cause
        self.thread = get_ident()
        try:
            self._greenlet.switch()
        finally:
            self.thread = 0
            if self.stall_limit:
                watch.leave(get_ident())
        self._recorder.cause = outer

    def _sleep(self) -> None:
        """Give way to the kernel; returns when `_resume` runs."""
        assert self._hub is not None, "firmware calls the CPU only from inside a run"
        own = self._recorder.cause  # what happens meanwhile is not of our making
        self._hub.switch()
        self._recorder.cause = own

    def stands_at(self) -> SourceLocation | None:
        """The statement of the firmware that runs now, or goes on next; None where main has not begun or is over.

        While a posted write lands it is the one that issued it.
        """
        if self._issued_at is not None:
            return self._issued_at
        running = self._greenlet
        if running is None or running.dead:
            return None
        return self._places.of_frame(sys._getframe() if getcurrent() is running else running.gr_frame)

    # Time --------------------------------------------------------------------

    def _go_to(self, cycle: int) -> None:
        """Let time pass to `cycle`, which no interrupt cuts short; posted writes of earlier cycles land on the way."""
        while self._lands < cycle:
            self._advance(self._lands)
            self._land()
        self._advance(cycle)

    def _advance(self, cycle: int) -> None:
        """The past is where a replayed pass of a wait moves: free."""
        if cycle >= self._lease:
            quiet = self._clock.cycle_at(self._kernel.quiet_until())
            self._lease = quiet if quiet <= self._lands else self._lands + 1
            if cycle >= quiet and self._clock.tick(cycle) > self._kernel.now:
                self._wake_at(cycle)
                self._sleep()
        self.cycle = cycle

    @abstractmethod
    def _after_main(self) -> None:
        """What the CPU does once main has returned."""

    @abstractmethod
    def _land(self) -> None:
        """Let the posted write whose cycle it is take effect."""

    def _now(self) -> None:
        """The kernel's time is this CPU's: an access happens. It may promise new events, so the lease ends."""
        kernel = self._kernel
        tick = self._clock.tick(self.cycle)
        if tick > kernel.now:
            kernel.now = tick
        self._lease = 0
