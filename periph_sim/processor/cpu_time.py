"""The time of one CPU: the cycle that its program wants goes in; a wake-up of the kernel, or none, comes out.

    program --> cycle wanted --lease--> it is that cycle now
                               \\------> wake-up promised --> kernel --> the processor goes on there

As long as nothing else can act (`Kernel.quiet_until`: a lease) the CPU moves its time by itself; else it is woken by
an event. Here nothing is called that could read, write or take an interrupt.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ..core.chip import NEVER
from ..core.kernel import CPU, Agent, Event, Kernel
from ..core.state import State
from ..core.time import LAST_TICK, Clock


@final
class CpuTime:
    """cycle: how many SYSCLKOUT cycles have passed for this CPU.

    lease: before this cycle nothing can act but this CPU's program; 0: not known.
    lands: the cycle at whose end the next posted write takes effect; NEVER if there is none. The lease ends there.
    met: the cycle for which the kernel's time was last made this CPU's.
    asleep: at an instruction boundary, so that an interrupt can wake it.
    watching: it executes passes of a wait that it could sleep through; `wakes` is the cycle at which it would be woken.
    """

    STATE = State("asleep watching _wake", cycles="cycle lands met wakes _wake_cycle _until", ticks="_wake_tick")

    __slots__ = (
        "_clock",
        "_kernel",
        "_until",
        "_wake",
        "_wake_cycle",
        "_wake_tick",
        "asleep",
        "cycle",
        "lands",
        "lease",
        "met",
        "wakes",
        "watching",
    )

    def __init__(self, kernel: Kernel, clock: Clock, agent: Agent) -> None:
        """agent: acts when the cycle has come for which a wake-up was promised; it calls `arrive` first."""
        self.cycle = 0
        self.lease = 0
        self.lands = NEVER
        self.met = -1
        self.asleep = self.watching = False
        self.wakes = NEVER
        self._kernel = kernel
        self._clock = clock
        self._wake: Event = kernel.event(agent, CPU)  # the promise by which this CPU is woken
        self._wake_tick = 0
        self._wake_cycle = 0
        self._until = NEVER  # a sleeping CPU's time does not pass beyond this cycle

    def instant(self) -> tuple[int, int]:
        """What changes with simulated time."""
        return self.cycle, self._kernel.now

    @property
    def waits_for_input(self) -> bool:
        """Asleep, and no cycle is known at which this CPU goes on: a watched register or an interrupt must come."""
        return self.wakes == NEVER if self.watching else self.asleep and not self._wake.queued

    def left(self) -> int:
        """Cycles from here to the last tick that there is."""
        return self._clock.cycle_at(LAST_TICK) - self.cycle

    # Moving on ---------------------------------------------------------------

    def advance(self, cycle: int) -> bool:
        """True: it is `cycle` now. False: something else may act before; the CPU is woken then.

        The past is where a replayed pass of a wait moves: free.
        """
        if cycle >= self.lease:
            quiet = self._clock.cycle_at(self._kernel.quiet_until())
            self.lease = quiet if quiet <= self.lands else self.lands + 1
            if cycle >= quiet and self._clock.tick(cycle) > self._kernel.now:
                self.wake_at(cycle)
                return False
        self.cycle = cycle
        return True

    def renew(self) -> int:
        """The lease as it is now: up to where something else may act, or behind the next posted write."""
        quiet = self._clock.cycle_at(self._kernel.quiet_until())
        self.lease = lease = quiet if quiet <= self.lands else self.lands + 1
        return lease

    def rest(self, cycle: int) -> bool:
        """True: it is `cycle` now, or was already. False: asleep up to it, or to an interrupt; NEVER: to that only."""
        if cycle < NEVER:
            kernel, tick = self._kernel, self._clock.tick(cycle)
            if tick < kernel.quiet_until():
                kernel.now = max(kernel.now, tick)
                self.cycle = cycle
                return True
            self.wake_at(cycle)
        self.sleep(cycle)
        return False

    def sleep(self, until: int) -> None:
        """Asleep at an instruction boundary; whoever calls has promised a wake-up, or waits for `resume_by`."""
        self.asleep = True
        self._until = until

    def watch(self, until: int) -> None:
        """Go on, and note for when a sleeping CPU would have been woken: at `until`, or by `resume_by`."""
        self.watching, self.wakes = True, until

    def meet(self) -> None:
        """The kernel's time becomes this CPU's: an access is made that acts. It may promise events: the lease ends."""
        kernel, cycle = self._kernel, self.cycle
        tick = self._clock.tick(cycle)
        if tick > kernel.now:
            kernel.now = tick
        self.met = cycle
        self.lease = 0

    def limit(self, lands: int) -> None:
        """A write was posted that takes effect at the end of this cycle."""
        if lands < self.lands:
            self.lands = lands
        if lands < self.lease:
            self.lease = lands + 1

    # Waking ------------------------------------------------------------------

    def begin(self, delay: int) -> None:
        """Be woken `delay` cycles after now."""
        self.cycle = self._clock.cycle_at(self._kernel.now) + delay
        self.wake_at(self.cycle)

    def arrive(self) -> None:
        """The wake-up that was promised has come."""
        self.lease = 0
        if self.asleep:
            self.asleep = False
            cycle = min(self._until, self._clock.cycle_at(self._kernel.now))
            if cycle > self.cycle:
                self.cycle = cycle
        else:
            self.cycle = self._wake_cycle

    def wake_at(self, cycle: int) -> None:
        """Promise a wake-up at `cycle`; now, if that is past."""
        tick, now = self._clock.tick(cycle), self._kernel.now
        self._wake_cycle = cycle
        self._wake_tick = tick = tick if tick > now else now
        self._kernel.renew(self._wake, tick, 0)

    def resume_by(self, cycle: int) -> None:
        """Be woken at `cycle`, or sooner if that is promised already."""
        if self.watching:
            self.wakes = min(self.wakes, cycle)
            return
        if not self._wake.queued or self._wake_tick > self._clock.tick(cycle):
            self._kernel.cancel(self._wake)
            self.wake_at(cycle)

    def restored(self) -> None:
        """The state has been restored, in which the lease is not known."""
        self.lease = 0

    def reclock(self) -> None:
        """The clock was retuned: a wake-up promised for a cycle moves to that cycle's new tick."""
        if self._wake.queued:
            self._kernel.cancel(self._wake)
            self.wake_at(self._wake_cycle)

    def stop(self) -> None:
        """No wake-up, no landing: the program is over."""
        self._kernel.cancel(self._wake)
        self.lands = NEVER
        self.asleep = self.watching = False
