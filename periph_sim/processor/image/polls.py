"""Waits of an image: passes of a loop go in; that every further one comes out the same comes out, and for how long.

    a backward branch, again and again --> state at two of them equal --> Lease of what was read --> sleep
          ^--- the pass in progress, made anew from its start; what lies in the past is answered as it was <-- woken

A pass is *clean* if it stored in memory what stood there already, wrote no register, read none that counts or that a
read changes, did not touch what decides about interrupts, and was not interrupted. If the registers, the pipeline and
the fetch queue are equal before and after two clean passes of the same cycles, the next one comes out the same as long
as the registers of the chip that it read do. So skipping changes no cycle and no bit.

A pass that counts, in a register or in memory, may be followed by others that only count (`counting_loop`): so many are
skipped in the same way, and the counters moved.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER
from ...core.state import State
from ...f28335.cpu.interrupts import CpuInterrupts
from ..cpu_time import CpuTime
from ..operand import Operand
from ..polling import Lease, Spin

FIRST_LOOK = 2  # passes of a loop before anybody looks at it
LONGEST = 1024  # passes between two looks at a loop that is no wait
COUNTS_FROM = 64  # passes of a loop before it is taken apart as one that counts, which takes as long as some hundred
FEWEST = 8  # passes that are worth it
TRIES = 3  # in turn, at a loop that does not only count


@final
class Polls:
    """tracking: a pass is looked at. clean: nothing in it but what every further pass would do again. counting: it may
    change words of memory, besides; changed: those, with what they held before.

    skips: passes that come out alike are skipped; else they are executed, and only the times are noted at which the
    program would have begun to sleep and been woken. asleep: between these. replaying: reads are answered as they were
    up to the cycle `live_from`. elsewhere: words read that nothing models. routines: service routines under way.
    restarts: the pass restarts the watchdog, so that no further one is skipped.
    """

    STATE = State(
        "asleep tracking clean counting replaying restarts routines changed elsewhere _lease _values "
        "_failed _compared _branch _outer_branch _passes _next _look_at _step _period _most _spin",
        cycles="live_from _outer_since _started _since",
    )

    __slots__ = (
        "_branch", "_compared", "_core", "_failed", "_lease", "_look_at", "_most", "_next", "_outer_branch",
        "_outer_since", "_passes", "_period", "_since", "_spin", "_started", "_step", "_time", "_values", "asleep",
        "changed", "clean", "counting", "elsewhere", "live_from", "replaying", "restarts", "routines", "skips",
        "tracking",
    )  # fmt: skip

    def __init__(self, time: CpuTime, core: CpuInterrupts, skips: bool) -> None:
        self.skips = skips
        self._time = time
        self._core = core
        self._lease = Lease(time)
        self.elsewhere: list[int] = []
        self._values: list[int] = []
        self.changed: dict[int, int] = {}
        self._failed: dict[int, int] = {}  # by branch: how often its loop turned out to do more than count
        self._compared = False  # the state was kept at the begin of the last pass
        self._branch = -1
        self._spin = Spin(0)
        self.forget()

    def forget(self) -> None:
        """The program begins anew, or is over."""
        self._lease.end()
        self.asleep = self.tracking = self.clean = self.counting = self.replaying = False
        self.restarts = False
        self.live_from = self.routines = 0
        self._branch = self._outer_branch = -1
        self._outer_since = 0
        self._passes = self._next = self._look_at = self._step = 0
        self._period = self._started = self._since = 0
        self._most = NEVER

    # Passes ------------------------------------------------------------------------

    def again(self, branch: int, cycle: int) -> bool:
        """A branch back is taken. True if it is time to look at the loop."""
        if branch != self._branch:
            self._branch, self._passes, self._since = branch, 0, cycle
            if not self.routines:  # loops of service routines do not end the loop that they interrupt
                if branch == self._outer_branch:
                    self._since = self._outer_since
                self._outer_branch, self._outer_since = branch, self._since
            self._look_at, self._step = FIRST_LOOK, 1
            self.tracking = self.counting = False
            return False
        self._passes += 1
        return self._passes >= self._look_at

    def may_be_alike(self) -> bool:
        """At the begin of a pass: whether the one behind it was looked at and clean, so that states are compared."""
        if self.tracking and self.clean:
            return True
        if self.tracking:
            self.look_later()
        else:
            self._compared = False
            self._begin()
        return False

    def look_later(self) -> None:
        """Look again later, and ever less often."""
        self._step = min(2 * self._step, LONGEST)
        self._look_at = self._passes + self._step
        self.tracking = False

    def comes_out_alike(self, as_before: bool) -> bool:
        """At the begin of a pass that may be: whether two clean ones behind it had this state before and after them.

        as_before: the state is that of the last call.
        """
        cycle = self._time.cycle
        equal: bool
        period, equal = cycle - self._started, as_before and self._compared
        seen: bool = equal and period == self._period
        if self._compared and not equal:
            self.look_later()
            return False
        self._compared, self._started, self._period = True, cycle, period if equal else 0
        if not seen:
            self._begin()
        return seen

    # Passes that count -------------------------------------------------------------

    def may_count(self) -> bool:
        """At the begin of a pass, the one behind it being none that comes out alike: whether to take this one apart."""
        if self.tracking or self._passes < COUNTS_FROM or self._failed.get(self._branch, 0) >= TRIES:
            return False
        cycle = self._time.cycle
        self._period, self._started = cycle - self._spin.start, cycle
        self._look_at = self._passes + 1
        self.changed.clear()
        self.counting = True
        self._begin()
        return True

    def counted(self) -> bool:
        """At the begin of a pass: whether the one behind it, which was taken apart, took as long as the one before."""
        cycle = self._time.cycle
        alike: bool = self.clean and cycle - self._started == self._period
        self._started = cycle
        self.counting = False
        self.look_later()
        return alike

    def fails(self) -> None:
        """The loop does more than count."""
        self._failed[self._branch] = self._failed.get(self._branch, 0) + 1

    @property
    def reads_modules(self) -> bool:
        """True if the pass reads a register of a module."""
        return self._spin.made > 0

    @property
    def reads(self) -> bool:
        """Whether the pass reads what may change: the loop is a wait."""
        return self.reads_modules or len(self.elsewhere) > 0

    @property
    def since(self) -> int:
        """The cycle at which the first pass of the loop ended."""
        return self._since

    def changes(self, address: int, before: int) -> None:
        """The pass changes a word of memory."""
        if not self.counting:
            self.clean = False
        elif address not in self.changed:
            self.changed[address] = before

    def _begin(self) -> None:
        """Look at the pass that begins now."""
        self.tracking = self.clean = True
        self.restarts = False
        self.elsewhere.clear()
        self._values.clear()
        self._spin.begin_pass(self._time.cycle)

    @property
    def began(self) -> int:
        """When the pass began that is looked at."""
        return self._started

    def note(self, operand: Operand, value: int) -> None:
        """The pass reads a register of the chip."""
        self._spin.note(operand, value << operand.shift, None)
        self._values.append(value)
        if not operand.steady:
            self.clean = False

    def note_elsewhere(self, address: int, value: int) -> None:
        """The pass reads a word that nothing models."""
        self.elsewhere.append(address)
        self._values.append(value)

    def restart(self) -> None:
        """The pass writes a key of the watchdog."""
        self.restarts = True
        if self.counting:
            self.clean = False

    def soil(self) -> None:
        """The pass does what the next one may not do again."""
        self.clean = False

    # Sleep -------------------------------------------------------------------------

    def sleep(self, most: int = NEVER) -> Spin | None:
        """Sleep until a pass may come out otherwise, `most` of them at most. None if that may be now already."""
        time, lease, spin = self._time, self._lease, self._spin
        if time.lands < NEVER or self._core.earliest() < NEVER:
            return None
        spin.since = self._since
        lease.take(spin)
        if lease.broken(time.cycle):
            return None
        lease.begin()
        self._most, until = most, NEVER
        if most < NEVER:
            self._failed.pop(self._branch, None)
            until = self._started + most * self._period
        if self.skips:
            if until < NEVER:
                time.wake_at(until)
            time.sleep(until)
        else:
            self.tracking = False
            time.watch(until)
        self.asleep = True
        return spin

    def woken(self, now: int) -> int:
        """A pass may come out otherwise from this cycle on. How many passes came out alike before the one in progress.

        Where these were skipped, it is made anew from its start, and what lies in the past is answered as it was.
        """
        time = self._time
        self._lease.end()
        self.asleep = time.watching = False
        passes = (now - self._started) // self._period
        if self.skips:
            time.cycle = self._started + passes * self._period
            self.live_from, self._next = now, 0
            self.replaying = now > time.cycle
        self.tracking = False
        self._look_at = self._passes + 1
        if self._most < NEVER:
            self._step = 1
        return passes

    def begins_at(self, passes: int) -> int:
        """Return the cycle at which a pass begins. passes: counted from the one looked at."""
        return self._started + passes * self._period

    def resume(self, cycle: int) -> None:
        """What a word answers that nothing models has changed: a sleeping program looks."""
        if self.asleep:
            self._time.resume_by(max(cycle, self._started))

    def answer(self, cycle: int) -> bool:
        """Whether the read in this cycle is answered as it was (`answered`); if not, the replay is over."""
        self.replaying = cycle < self.live_from and self._next < len(self._values)
        return self.replaying

    def answered(self) -> int:
        self._next += 1
        return self._values[self._next - 1]
