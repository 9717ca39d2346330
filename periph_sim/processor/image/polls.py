"""Detection of waits of an image: loops whose further passes all have the same result, and for how long.

    repeated backward branch --> state at two of them equal --> Lease of the registers read --> sleep
          ^--- replay of the pass in progress from its start; reads in the past return the earlier values <-- woken

A pass is *clean* if it changed no word of memory, wrote no register, read no register that counts or that a read
changes, did not access interrupt masks and flags, and was not interrupted. If the registers, the pipeline and the fetch
queue are equal before and after two clean passes of the same cycles, the next pass has the same result as long as the
registers of the chip that it read keep their values. So skipping changes no cycle and no bit.

A pass that counts, in a register or in memory, may be followed by others that only count (`counting_loop`). They are
skipped in the same way, and the counters advanced.
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

FIRST_EXAMINED = 2  # passes of a loop before the first one is examined
LONGEST = 1024  # most passes between two examined ones of a loop that is no wait
COUNTS_FROM = 64  # passes of a loop before it is analysed as one that counts, at the cost of some hundred passes
FEWEST = 8  # fewest passes that are worth skipping
TRIES = 3  # failed analyses before a loop counts as one that does more than count


@final
class PollSkipper:
    """Detects passes of a loop that further passes would repeat, and skips these.

    tracking: True if the present pass is examined.
    clean: True if each further pass would repeat all that the examined pass did.
    counting: True if the pass may also change words of memory.
    changed: the words that it changed, with their earlier values.
    skips: True if equal passes are skipped. Otherwise they are executed, and only the times are recorded at which the
        program would have begun to sleep and would have been woken.
    asleep: True between these times.
    replaying: True if reads before the cycle `live_from` return the earlier values.
    elsewhere: the addresses of unmodelled words that were read.
    routines: the number of active service routines.
    restarts: True if the pass restarts the watchdog, so that no further pass is skipped.
    began: the cycle at which the examined pass began.
    since: the cycle at which the first pass of the loop ended.
    """

    STATE = State(
        "asleep tracking clean counting replaying restarts routines changed elsewhere _lease _values "
        "_failed _compared _branch _outer_branch _passes _next _examine_at _step _period _most _spin",
        cycles="live_from _outer_since began since",
    )

    def __init__(self, time: CpuTime, core: CpuInterrupts, skips: bool) -> None:
        self.skips = skips
        self._time = time
        self._core = core
        self._lease = Lease(time)
        self.elsewhere: list[int] = []
        self._values: list[int] = []
        self.changed: dict[int, int] = {}
        self._failed: dict[int, int] = {}  # by branch: how often its loop did more than count
        self._compared = False  # the state was saved at the begin of the last pass
        self._branch = -1
        self._spin = Spin(0)
        self.forget()

    def forget(self) -> None:
        """Reset: the program begins again, or has ended."""
        self._lease.end()
        self.asleep = self.tracking = self.clean = self.counting = self.replaying = False
        self.restarts = False
        self.live_from = self.routines = 0
        self._branch = self._outer_branch = -1
        self._outer_since = 0
        self._passes = self._next = self._examine_at = self._step = 0
        self._period = self.began = self.since = 0
        self._most = NEVER

    # Passes ------------------------------------------------------------------------

    def again(self, branch: int, cycle: int) -> bool:
        """Count a backward branch that is taken. Return True if the loop is due to be examined."""
        if branch != self._branch:
            self._branch, self._passes, self.since = branch, 0, cycle
            if not self.routines:  # loops of service routines do not end the loop that they interrupt
                if branch == self._outer_branch:
                    self.since = self._outer_since
                self._outer_branch, self._outer_since = branch, self.since
            self._examine_at, self._step = FIRST_EXAMINED, 1
            self.tracking = self.counting = False
            return False
        self._passes += 1
        return self._passes >= self._examine_at

    def is_repeatable(self) -> bool:
        """Return True, at the begin of a pass, if the previous one was examined and clean: states are then compared."""
        if self.tracking and self.clean:
            return True
        if self.tracking:
            self.examine_later()
        else:
            self._compared = False
            self._begin()
        return False

    def examine_later(self) -> None:
        """Examine the loop again after more passes, twice as many each time."""
        self._step = min(2 * self._step, LONGEST)
        self._examine_at = self._passes + self._step
        self.tracking = False

    def repeats(self, as_before: bool) -> bool:
        """Return True, at the begin of a pass, if the state was this one before and after the last two clean passes.

        Call it if `is_repeatable` is True. as_before: the state equals that of the last call.
        """
        cycle = self._time.cycle
        equal: bool
        period, equal = cycle - self.began, as_before and self._compared
        seen: bool = equal and period == self._period
        if self._compared and not equal:
            self.examine_later()
            return False
        self._compared, self.began, self._period = True, cycle, period if equal else 0
        if not seen:
            self._begin()
        return seen

    # Passes that count -------------------------------------------------------------

    def may_count(self) -> bool:
        """Return True, at the begin of a pass whose predecessor was not repeatable, if this one should be analysed."""
        if self.tracking or self._passes < COUNTS_FROM or self._failed.get(self._branch, 0) >= TRIES:
            return False
        cycle = self._time.cycle
        self._period, self.began = cycle - self._spin.start, cycle
        self._examine_at = self._passes + 1
        self.changed.clear()
        self.counting = True
        self._begin()
        return True

    def counted(self) -> bool:
        """Return True, at the begin of a pass, if the analysed one before it was clean and of the usual length."""
        cycle = self._time.cycle
        alike: bool = self.clean and cycle - self.began == self._period
        self.began = cycle
        self.counting = False
        self.examine_later()
        return alike

    def count_failure(self) -> None:
        """Count a failed analysis: the loop does more than count."""
        self._failed[self._branch] = self._failed.get(self._branch, 0) + 1

    @property
    def reads_modules(self) -> bool:
        """True if the pass reads a register of a module."""
        return self._spin.made > 0

    @property
    def reads(self) -> bool:
        """True if the pass reads values that may change, so that the loop is a wait."""
        return self.reads_modules or len(self.elsewhere) > 0

    def changes(self, address: int, before: int) -> None:
        """Note that the pass changes a word of memory."""
        if not self.counting:
            self.clean = False
        elif address not in self.changed:
            self.changed[address] = before

    def _begin(self) -> None:
        """Examine the pass that begins now."""
        self.tracking = self.clean = True
        self.restarts = False
        self.elsewhere.clear()
        self._values.clear()
        self._spin.begin_pass(self._time.cycle)

    def note(self, operand: Operand, value: int) -> None:
        """Note a read of a register of the chip."""
        self._spin.note(operand, value << operand.shift, None)
        self._values.append(value)
        if not operand.steady:
            self.clean = False

    def note_elsewhere(self, address: int, value: int) -> None:
        """Note a read of a word that is not modelled."""
        self.elsewhere.append(address)
        self._values.append(value)

    def restart(self) -> None:
        """Note a write of a key of the watchdog."""
        self.restarts = True
        if self.counting:
            self.clean = False

    def soil(self) -> None:
        """Note an action that the next pass may not repeat."""
        self.clean = False

    # Sleep -------------------------------------------------------------------------

    def sleep(self, most: int = NEVER) -> Spin | None:
        """Sleep until a pass may differ, for at most `most` passes. Return None if the next one may differ."""
        time, lease, spin = self._time, self._lease, self._spin
        if time.lands < NEVER or self._core.earliest() < NEVER:
            return None
        spin.since = self.since
        if not lease.begin(spin):
            return None
        self._most, until = most, NEVER
        if most < NEVER:
            self._failed.pop(self._branch, None)
            until = self.began + most * self._period
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
        """End the sleep, since a pass may differ from this cycle on. Return the number of equal passes before it.

        If these were skipped, it is replayed from its start; reads in the past return the earlier values.
        """
        time = self._time
        self._lease.end()
        self.asleep = time.watching = False
        passes = (now - self.began) // self._period
        if self.skips:
            time.cycle = self.began + passes * self._period
            self.live_from, self._next = now, 0
            self.replaying = now > time.cycle
        self.tracking = False
        self._examine_at = self._passes + 1
        if self._most < NEVER:
            self._step = 1
        return passes

    def begins_at(self, passes: int) -> int:
        """Return the cycle at which a pass begins. passes: counted from the examined one."""
        return self.began + passes * self._period

    def resume(self, cycle: int) -> None:
        """Wake a sleeping program: a stub has changed its value."""
        if self.asleep:
            self._time.resume_by(max(cycle, self.began))

    def answer(self, cycle: int) -> bool:
        """Return True if the read in this cycle returns its earlier value (`answered`); else end the replay."""
        self.replaying = cycle < self.live_from and self._next < len(self._values)
        return self.replaying

    def answered(self) -> int:
        """Return the value of the next read of the replay."""
        self._next += 1
        return self._values[self._next - 1]
