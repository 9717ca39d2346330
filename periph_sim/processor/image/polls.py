"""Detection of waits in an image: loops whose passes all have the same result until a register that they read changes.

    a backward branch repeats --> the state of the CPU is as before --> Lease: a watch on the registers that were read
    --> sleep --> woken: the pass in progress is replayed from its start; reads in the past return the earlier values

A pass is *clean* under these conditions:

- It changed no word of M0, M1 and L0 to L7, and wrote no recorded variable. At other addresses, it wrote only to the
  key register of the watchdog, if at all.
- It read no register that changes with time, and no register whose read has an effect.
- It did not write INTM, IER or the whole of ST1, and did not access IFR.
- It executed no IDLE, TRAP, INTR or IRET, and no interrupt was taken. If a listener observes calls, it made no call.

If two clean passes have the same number of cycles, and leave the registers of the CPU, the pipeline and the fetch queue
as they were, then the next pass has the same result as long as the module registers that it reads keep their values. So
skipping it does not change any cycle or bit of the run.

A pass may also change nothing but counters, in registers or in memory (`counting_loop`). Such passes are skipped in the
same way, and the counters are advanced.
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

FIRST_EXAMINED = 1  # number of passes of a loop before a pass is examined
LONGEST = 1024  # maximum number of passes between two examined passes of a loop that is not found to be a wait
COUNTS_FROM = 64  # number of passes before a loop is analysed for counters, which is slow
FEWEST = 8  # a loop that counts: if fewer passes than this can be skipped, they are executed instead
# Attributes that affect the run only in some states: in sleeps, in replays, or outside of sleeps.
NOT_ALWAYS = ("began", "live_from", "_next", "_examine_at", "_period", "_most", "_spin", "_values")
TRIES = 3  # number of failed analyses for counters after which a loop is not analysed again


@final
class PollSkipper:
    """Detects a pass of a loop that all further passes would repeat, and skips the further passes.

    tracking: True if the present pass is examined.
    clean: True if the examined pass has been clean so far (see the module's description).
    counting: True if the examined pass is analysed for counters, so it may change words of memory.
    changed: for the address of each memory word that the examined pass has changed, the earlier value of the word.
    skips: True if the program sleeps instead of executing the further passes. If it is False, the program executes
        them, and the sleep is only noted: the wait is recorded with the start and the end that a sleep would have.
    asleep: True during a sleep or a noted sleep.
    replaying: True while a pass is replayed. Its reads before the cycle `live_from` return the values that the examined
        pass has read.
    elsewhere: the addresses of the unmodelled words that the examined pass has read.
    routines: the number of active service routines.
    restarts: True if the examined pass has written the key register of the watchdog. Further passes must then not be
        skipped, because they restart the watchdog, too.
    began: in a sleep, the cycle at which the first pass of the sleep begins; before, the cycle at which the states were
        compared last, or at which the analysed pass began.
    since: the cycle at which the first pass of the loop ended.
    """

    STATE = State(
        "asleep tracking clean counting replaying restarts routines changed elsewhere _lease _values "
        "_failed _compared _branch _outer_branch _passes _next _examine_at _step _period _most _spin",
        cycles="live_from _outer_since began since",
        results="_lease _passes _outer_since since",
        grids={"began": "_period"},
    )

    def __init__(self, time: CpuTime, core: CpuInterrupts, skips: bool) -> None:
        self.skips = skips
        self._time = time
        self._core = core
        self._lease = Lease(time)
        self.elsewhere: list[int] = []
        self._values: list[int] = []
        self.changed: dict[int, int] = {}
        self._failed: dict[int, int] = {}  # maps the branch that closes a loop to the number of failed analyses
        self._compared = False  # True if the states at both ends of an examined pass were compared
        self._branch = -1
        self._spin = Spin(0)
        self.forget()

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return the parts of a sleep or replay that affect the future of the program. See `proof.normal_state`."""
        found: dict[str, object] = dict.fromkeys(NOT_ALWAYS)
        if not (self.asleep and self.skips):  # the end of such a sleep sets `_examine_at`
            found["_examine_at"] = self._examine_at - self._passes
        if self.replaying:
            found["live_from"] = self.live_from - cycle
            found["_next"], found["_values"] = self._next, tuple(self._values)
        if self.asleep:
            if self._most == NEVER:
                del found["began"]
            else:
                found["began"] = self.began - cycle
            found["_most"], found["_period"], found["_values"] = self._most, self._period, tuple(self._values)
            found["_spin"] = tuple([(read.operand.address, read.value) for read in self._spin.reads[: self._spin.made]])
        return found

    def forget(self) -> None:
        """Reset the detection. Call this method when the program begins again or has ended."""
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
        """Count a pass, which a backward branch has closed. Return True if the next pass should be examined.

        branch: the address of the branch. cycle: the cycle at which the next pass begins.
        """
        if branch != self._branch:
            self._branch, self._passes, self.since = branch, 0, cycle
            if not self.routines:  # a loop in a service routine does not end the loop that it interrupts
                if branch == self._outer_branch:
                    self.since = self._outer_since
                self._outer_branch, self._outer_since = branch, self.since
            self._examine_at, self._step = FIRST_EXAMINED, 1
            self.tracking = self.counting = False
            return False
        self._passes += 1
        return self._passes >= self._examine_at

    def is_repeatable(self) -> bool:
        """Return True, at the start of a pass, if the previous pass was examined and clean.

        The caller then calls `repeats`. Otherwise, begin to examine the present pass if the previous pass was not
        examined, or examine the loop later if the previous pass was not clean. In each case, the caller calls
        `ImageCpu.is_as_before`, which keeps the state for the comparison at the end of the pass.
        """
        if self.tracking and self.clean:
            return True
        if self.tracking:
            self.examine_later()
        else:
            self._compared, self.began, self._period = False, self._time.cycle, 0
            self._begin()
        return False

    def examine_later(self) -> None:
        """Examine the loop again after some passes. Their number doubles with each call, up to LONGEST."""
        self._step = min(2 * self._step, LONGEST)
        self._examine_at = self._passes + self._step
        self.tracking = False

    def repeats(self, as_before: bool) -> bool:
        """Return True, at the start of a pass, if two clean passes of equal length have left the state unchanged.

        Call this method if `is_repeatable` is True. as_before: the present result of `ImageCpu.is_as_before`.
        """
        if self._compared and not as_before:
            self.examine_later()
            return False
        cycle = self._time.cycle
        period = cycle - self.began if as_before else 0  # the first examined pass may bring the state that repeats
        seen: bool = as_before and period == self._period
        self._compared, self.began, self._period = True, cycle, period
        if not seen:
            self._begin()
        return seen

    # Passes that count -------------------------------------------------------------

    def may_count(self) -> bool:
        """Begin to examine the pass that begins now, and to analyse it for counters. Return True.

        Return False, without effect, if the loop has made too few passes, if too many analyses have failed, or if the
        pass is examined already. Call this method if the previous pass was not repeatable.
        """
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
        """Return True, at the end of the analysed pass, if it was clean and as long as the pass before it."""
        cycle = self._time.cycle
        alike: bool = self.clean and cycle - self.began == self._period
        self.began = cycle
        self.counting = False
        self.examine_later()
        return alike

    def count_failure(self) -> None:
        """Count a failed analysis: the loop did more than change counters."""
        self._failed[self._branch] = self._failed.get(self._branch, 0) + 1

    @property
    def reads_modules(self) -> bool:
        """True if the examined pass reads a register of a module."""
        return self._spin.made > 0

    @property
    def reads(self) -> bool:
        """True if the examined pass reads values that may change, so that the loop is a wait."""
        return self.reads_modules or len(self.elsewhere) > 0

    def changes(self, address: int, before: int) -> None:
        """Handle a change of a memory word by the examined pass. before: the earlier value of the word.

        If the pass is analysed for counters, store the earlier value. Otherwise, set `clean` to False.
        """
        if not self.counting:
            self.clean = False
        elif address not in self.changed:
            self.changed[address] = before

    def _begin(self) -> None:
        """Begin to examine the pass that begins now."""
        self.tracking = self.clean = True
        self.restarts = False
        self.elsewhere.clear()
        self._values.clear()
        self._spin.begin_pass(self._time.cycle)

    def note(self, operand: Operand, value: int) -> None:
        """Append the read of a module's register to the reads of the examined pass.

        If the register changes with time, or its read has an effect, set `clean` to False.
        """
        self._spin.note(operand, value << operand.shift, None)
        self._values.append(value)
        if not operand.steady:
            self.clean = False

    def note_elsewhere(self, address: int, value: int) -> None:
        """Append the read of an unmodelled word to the reads of the examined pass."""
        self.elsewhere.append(address)
        self._values.append(value)

    def restart(self) -> None:
        """Set `restarts`, because the examined pass writes the key register of the watchdog.

        The further passes are then executed and not skipped. If the pass is analysed for counters, this is ensured by
        setting `clean` to False; otherwise, the program checks `restarts`.
        """
        self.restarts = True
        if self.counting:
            self.clean = False

    def soil(self) -> None:
        """Set `clean` to False, because the examined pass has done something that the next pass may not repeat."""
        self.clean = False

    # Sleep -------------------------------------------------------------------------

    def sleep(self, most: int = NEVER) -> Spin | None:
        """Put the program to sleep until a value that it polls may differ, or for `most` passes.

        An interrupt ends the sleep, too. Return the wait that begins.

        Return None, without a sleep, if a posted write is pending, if an interrupt can be taken, or if the next pass
        would read other values. The loop is then examined again.
        """
        time, lease, spin = self._time, self._lease, self._spin
        spin.since = self.since
        if time.lands < NEVER or self._core.earliest() < NEVER or not lease.begin(spin):
            self.tracking = False
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
        self.asleep, self._step = True, 1
        return spin

    def woken(self, now: int) -> int:
        """End the sleep at cycle `now`. From this cycle on, a pass may have another result.

        Return the number of complete passes since the sleep began. If these were skipped, the pass in progress is
        replayed from its start, and its reads before `now` return the earlier values.
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
        return passes

    def begins_at(self, passes: int) -> int:
        """Return the cycle at which a pass begins. passes: its number, counted from the pass that began at `began`."""
        return self.began + passes * self._period

    def resume(self, cycle: int) -> None:
        """Wake the program if it sleeps. Call this method when a stub was added or has changed its value."""
        if self.asleep:
            self._time.resume_by(max(cycle, self.began))

    def answer(self, cycle: int) -> bool:
        """Return True if a read in this cycle must return a value of the examined pass, which `answered` returns.

        Return False, and end the replay, if the read must be made.
        """
        self.replaying = cycle < self.live_from and self._next < len(self._values)
        return self.replaying

    def answered(self) -> int:
        """Return the value of the next read of the replay."""
        self._next += 1
        return self._values[self._next - 1]
