"""Time of one CPU, which advances to the cycle that its program requests, at once or by a wake-up of the kernel.

    requested cycle --within the lease--> the time of the CPU is that cycle
                    --else-------------> a wake-up is scheduled --> kernel --> the processor continues

The lease is the time in which nothing else can act (`Kernel.quiet_until`). In the lease, the CPU advances its time by
itself; outside of the lease, an event wakes the CPU. Methods of this module make no accesses and take no interrupts.
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
    lease: the end of the lease: before this cycle only the program of this CPU can act. 0 if it must be computed again.
    lands: the cycle at whose end the next posted write takes effect, and the lease ends; NEVER if there is none.
    met: the cycle of this CPU to which the kernel's time was set last.
    asleep: True if the CPU sleeps at an instruction boundary, so that an interrupt can wake it.
    watching: True while the CPU executes the passes of a wait in place of a sleep, because passes must not be skipped.
    wakes: while `watching`, the cycle at which a sleeping CPU would be woken; NEVER if no such cycle is known.
    """

    STATE = State(
        "asleep watching _wake",
        cycles="cycle lands met wakes _wake_cycle _until",
        ticks="_wake_tick",
        expires="cycle met _wake_cycle _wake_tick",
    )

    def __init__(self, kernel: Kernel, clock: Clock, agent: Agent) -> None:
        """agent: the kernel calls its `act` at a scheduled wake-up; `act` must call `arrive` first."""
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
        self._until = NEVER  # the latest cycle to which a wake-up sets the time of a sleeping CPU

    def instant(self) -> tuple[int, int]:
        """Return two numbers. At least one of them changes whenever simulated time passes."""
        return self.cycle, self._kernel.now

    @property
    def waits_for_input(self) -> bool:
        """True if the CPU sleeps, or would sleep if not `watching`, and only a register or interrupt can wake it."""
        return self.wakes == NEVER if self.watching else self.asleep and not self._wake.queued

    def left(self) -> int:
        """Return the number of cycles from now to the last tick that a run can reach."""
        return self._clock.cycle_at(LAST_TICK) - self.cycle

    # Advancing ---------------------------------------------------------------

    def advance(self, cycle: int) -> bool:
        """Set the time to `cycle` and return True, or schedule a wake-up at `cycle` and return False.

        The result is False if something else may act before `cycle` or at its start; the program must then stop until
        the wake-up. A cycle in the past, as in a replayed pass of a wait, is always accepted.
        """
        if cycle >= self.lease:
            quiet = self._clock.cycle_at(self._kernel.quiet_until())
            self.lease = quiet if quiet <= self.lands else self.lands + 1
            if cycle >= quiet and self._clock.tick(cycle) > self._kernel.now:
                self.wake_at(cycle)
                return False
        self.cycle = cycle
        return True

    def rest(self, cycle: int) -> bool:
        """Set the times of the CPU and the kernel to `cycle` and return True, or sleep and return False.

        The result is False if something else may act before `cycle` or at its start.
        The sleep ends at `cycle` or at an interrupt; if `cycle` is NEVER, only at an interrupt.
        """
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
        """Sleep at an instruction boundary. The caller, or a later call of `resume_by`, schedules the wake-up.

        until: the latest cycle to which `arrive` sets the time of this CPU, even if the wake-up comes later.
        """
        self.asleep = True
        self._until = until

    def watch(self, until: int) -> None:
        """Set `watching`, and keep in `wakes` the cycle at which a sleeping CPU would be woken.

        until: the cycle of this wake-up. A later call of `resume_by` may replace it by an earlier cycle.
        """
        self.watching, self.wakes = True, until

    def meet(self) -> None:
        """Set the kernel's time to that of this CPU. Call this method before an access with effects.

        The lease ends, because an access with effects may schedule events.
        """
        kernel, cycle = self._kernel, self.cycle
        tick = self._clock.tick(cycle)
        if tick > kernel.now:
            kernel.now = tick
        self.met = cycle
        self.lease = 0

    def limit(self, lands: int) -> None:
        """End the lease when a new posted write takes effect, at the end of cycle `lands`."""
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
        """Set the time of the CPU to the cycle of the wake-up that happens now.

        The time of a sleeping CPU does not go back. It is not set to a cycle after `until`, the argument of `sleep`.
        """
        self.lease = 0
        if self.asleep:
            self.asleep = False
            cycle = min(self._until, self._clock.cycle_at(self._kernel.now))
            if cycle > self.cycle:
                self.cycle = cycle
        else:
            self.cycle = self._wake_cycle

    def wake_at(self, cycle: int) -> None:
        """Schedule a wake-up at `cycle`, or now if that cycle is in the past."""
        tick, now = self._clock.tick(cycle), self._kernel.now
        self._wake_cycle = cycle
        self._wake_tick = tick = tick if tick > now else now
        self._kernel.reschedule(self._wake, tick, 0)

    def resume_by(self, cycle: int) -> None:
        """Schedule a wake-up at `cycle`, or keep a scheduled one that is earlier.

        While `watching`, schedule nothing, but set `wakes` to `cycle` if that is earlier.
        """
        if self.watching:
            self.wakes = min(self.wakes, cycle)
            return
        if not self._wake.queued or self._wake_tick > self._clock.tick(cycle):
            self._kernel.cancel(self._wake)
            self.wake_at(cycle)

    def restored(self) -> None:
        """End the lease after a snapshot was restored, since snapshots do not contain the lease."""
        self.lease = 0

    def reclock(self) -> None:
        """Move a scheduled wake-up to the new tick of its cycle, after the frequency of the clock has changed."""
        if self._wake.queued:
            self._kernel.cancel(self._wake)
            self.wake_at(self._wake_cycle)

    def stop(self) -> None:
        """End a sleep, reset `lands`, and cancel the scheduled wake-up. Call this method when the program has ended."""
        self._kernel.cancel(self._wake)
        self.lands = NEVER
        self.asleep = self.watching = False
