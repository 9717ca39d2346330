"""Time of one CPU: advances to the cycle that its program requests, at once or by a wake-up of the kernel.

    program --> cycle wanted --lease--> it is that cycle now
                               \\------> wake-up scheduled --> kernel --> the processor continues

As long as nothing else can act (`Kernel.quiet_until`: a lease) the CPU advances its time by itself; else it is woken by
an event. Nothing is called here that could read, write or take an interrupt.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ..core.agent import Agent, Event
from ..core.chip import NEVER
from ..core.kernel import CPU, Kernel
from ..core.state import State
from ..core.time import LAST_TICK, Clock


@final
class CpuTime:
    """The time of one CPU, in cycles of its SYSCLKOUT.

    cycle: the number of cycles that have passed for this CPU.
    lease: before this cycle only this CPU's program can act; 0 if it is not known.
    lands: the cycle at whose end the next posted write takes effect; NEVER if there is none. The lease ends there.
    met: the cycle at which the kernel's time was last set to this CPU's.
    asleep: True if it sleeps at an instruction boundary, so that an interrupt can wake it.
    watching: True if it executes passes of a wait that it could sleep through; it would then be woken at cycle `wakes`.
    """

    STATE = State("asleep watching _wake", cycles="cycle lands met wakes _wake_cycle _until", ticks="_wake_tick")

    def __init__(self, kernel: Kernel, clock: Clock, agent: Agent) -> None:
        """agent: acts at the cycle of a scheduled wake-up; it calls `arrive` first."""
        self.cycle = 0
        self.lease = 0
        self.lands = NEVER
        self.met = -1
        self.asleep = self.watching = False
        self.wakes = NEVER
        self._kernel = kernel
        self._clock = clock
        self._wake: Event = kernel.event(agent, CPU)  # the event that wakes this CPU
        self._wake_tick = 0
        self._wake_cycle = 0
        self._until = NEVER  # a sleeping CPU's time does not pass beyond this cycle

    def instant(self) -> tuple[int, int]:
        """Return values that change with simulated time."""
        return self.cycle, self._kernel.now

    @property
    def waits_for_input(self) -> bool:
        """True if asleep without a scheduled wake-up: only a watched register or an interrupt can wake it."""
        return self.wakes == NEVER if self.watching else self.asleep and not self._wake.queued

    def left(self) -> int:
        """Return the cycles from here to the last possible tick."""
        return self._clock.cycle_at(LAST_TICK) - self.cycle

    # Advancing ---------------------------------------------------------------

    def advance(self, cycle: int) -> bool:
        """Return True if it is `cycle` now, False if something else may act before; the CPU is woken then.

        A cycle in the past, as in a replayed pass of a wait, is always possible.
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
        """Return a new lease: up to where something else may act, or after the next posted write."""
        quiet = self._clock.cycle_at(self._kernel.quiet_until())
        self.lease = lease = quiet if quiet <= self.lands else self.lands + 1
        return lease

    def rest(self, cycle: int) -> bool:
        """Return True if it is `cycle` now; else sleep until it or an interrupt. NEVER: until an interrupt only."""
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
        """Sleep at an instruction boundary, until a wake-up that the caller scheduled, or `resume_by`."""
        self.asleep = True
        self._until = until

    def watch(self, until: int) -> None:
        """Continue, and keep the cycle at which a sleeping CPU would have been woken: `until`, or by `resume_by`."""
        self.watching, self.wakes = True, until

    def meet(self) -> None:
        """Set the kernel's time to this CPU's for an access with effects. It may schedule events: the lease ends."""
        kernel, cycle = self._kernel, self.cycle
        tick = self._clock.tick(cycle)
        if tick > kernel.now:
            kernel.now = tick
        self.met = cycle
        self.lease = 0

    def limit(self, lands: int) -> None:
        """Limit the lease: a posted write takes effect at the end of this cycle."""
        if lands < self.lands:
            self.lands = lands
        if lands < self.lease:
            self.lease = lands + 1

    # Waking ------------------------------------------------------------------

    def begin(self, delay: int) -> None:
        """Schedule a wake-up `delay` cycles after now."""
        self.cycle = self._clock.cycle_at(self._kernel.now) + delay
        self.wake_at(self.cycle)

    def arrive(self) -> None:
        """Set the time at a scheduled wake-up."""
        self.lease = 0
        if self.asleep:
            self.asleep = False
            cycle = min(self._until, self._clock.cycle_at(self._kernel.now))
            if cycle > self.cycle:
                self.cycle = cycle
        else:
            self.cycle = self._wake_cycle

    def wake_at(self, cycle: int) -> None:
        """Schedule a wake-up at `cycle`; now, if that is past."""
        tick, now = self._clock.tick(cycle), self._kernel.now
        self._wake_cycle = cycle
        self._wake_tick = tick = tick if tick > now else now
        self._kernel.reschedule(self._wake, tick, 0)

    def resume_by(self, cycle: int) -> None:
        """Schedule a wake-up at `cycle`, unless an earlier one is scheduled."""
        if self.watching:
            self.wakes = min(self.wakes, cycle)
            return
        if not self._wake.queued or self._wake_tick > self._clock.tick(cycle):
            self._kernel.cancel(self._wake)
            self.wake_at(cycle)

    def restored(self) -> None:
        """Forget the lease, which is not part of a restored state."""
        self.lease = 0

    def reclock(self) -> None:
        """Move a scheduled wake-up to the new tick of its cycle after the clock was retuned."""
        if self._wake.queued:
            self._kernel.cancel(self._wake)
            self.wake_at(self._wake_cycle)

    def stop(self) -> None:
        """Cancel the wake-up and the landing, since the program has ended."""
        self._kernel.cancel(self._wake)
        self.lands = NEVER
        self.asleep = self.watching = False
