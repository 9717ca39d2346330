"""The I2C master's clock generator: SCL as it really is goes in; when SCL falls and is let go comes out.

    SCL low --low()--> let go --others may hold it--> rises --high()--> `_after_high`: the next fall, or a condition

What comes next is a step with its cycle: the clock's own are RELEASE and CONDITION, the others the master's.

A low that others lengthen delays the high phase, a low that others begin starts ours at once (`fell`, in the master).
Source: SPRUG03B sections 2.3, 5.7, Table 15.
"""

# core: compiled

from __future__ import annotations

from ...core.chip import NEVER
from ...core.state import State
from .register_map import SCL, SDA
from .registers import I2cRegisters

# A step: nothing; SCL is let go; SDA gets the level of the condition to come, or of a bit; SCL falls; a START and its
# end; a STOP; a repeated START.
NO_STEP, RELEASE, CONDITION, SET_SDA, FALL, START, STARTED, STOP, RESTART = range(9)

# Why SCL is held low, or, after a NACK, not: a command, a byte to send, or room for one that came has to come first.
HELD_FOR_NOTHING, HELD_FOR_COMMAND, HELD_FOR_DATA, HELD_FOR_ROOM, LET_GO = range(5)


class I2cClock:
    """pulls: mask of the lines held low. due: when `_step` comes, or NEVER. lines: as they are, before the filter."""

    STATE = State(
        "lines frozen halting active pulls _condition_sda _step _after_high _waits_for_rise _high_phase _holds _driven",
        cycles="due _let_go_at _low_from _rose_at",
    )

    def __init__(self, state: I2cRegisters) -> None:
        self.state = state
        self.lines = SCL | SDA
        self.frozen = False  # a debugger halt took hold
        self.halting = False  # a debugger halt waits for SCL to be low
        self._let_go_at = 0
        self._low_from = 0
        self._rose_at = 0
        self._condition_sda = 1  # SDA while SCL rises for a STOP (0) or repeated START (1)
        self.let_go()

    def let_go(self) -> None:
        """Both lines are released, nothing is to come."""
        self.active = False
        self.pulls = 0
        self.due = NEVER
        self._step = NO_STEP
        self._after_high = FALL  # the step that ends a high phase
        self._waits_for_rise = self._high_phase = False
        self._holds = HELD_FOR_NOTHING
        self._driven = 1

    def _d(self) -> int:
        return max(5, 8 - self.state.tm)  # Table 15: 7, 6, 5 for IPSC 0, 1, more

    def low(self) -> int:
        """SCL low time in cycles."""
        return self.state.tm * (self.state.clkl + self._d())

    def high(self) -> int:
        """SCL high time in cycles."""
        return self.state.tm * (self.state.clkh + self._d())

    def _at(self, now: int, step: int) -> None:
        self.due, self._step = now, step

    def _drive(self, level: int) -> None:
        self._driven = level
        if level:
            self.pulls &= ~SDA
        else:
            self.pulls |= SDA

    def _release_after_low(self, now: int) -> None:
        """SDA has its level: SCL is let go after the low time, or the setup time where it was held for that level."""
        state = self.state
        over = self._low_from + self.low()
        if now > self._low_from + state.tm + state.filter_width:
            over = max(over, now + state.setup())
        self._at(over, RELEASE)

    def _release(self, now: int) -> None:
        if self.frozen:
            return
        self.pulls &= ~SCL
        self._let_go_at = now
        self._waits_for_rise = True
        self.due = NEVER

    def hear(self, now: int, lines: int) -> None:
        """The lines as they really are: a rise of SCL that was waited for begins our high phase."""
        moved, self.lines = lines ^ self.lines, lines
        if not self.active or not moved & SCL:
            return
        if lines & SCL:
            if self._waits_for_rise:
                self._rose(now)
        elif self._high_phase and now - self._rose_at < self.state.filter_width:
            self._high_phase = False  # that rise was a spike
            self._waits_for_rise = True
            self.due = NEVER

    def _rose(self, now: int) -> None:
        self._waits_for_rise = False
        self._high_phase = True
        self._rose_at = now
        late: int = 0
        if now > self._let_go_at:
            late = self.state.options.scl_sync_cycles.assume(self.state.touched) * self.state.tm
        self._at(now + late + self.high(), self._after_high)

    def _scl_low(self, now: int) -> None:
        self.pulls |= SCL
        self._low_from = now
        self._high_phase = False
        if self.halting:
            self.halting, self.frozen = False, True

    def _begin_condition(self, now: int, sda: int, then: int) -> None:
        """SCL is low: SDA to `sda`, SCL let go after the low time, the step `then` one high time after it rose."""
        self._holds = HELD_FOR_NOTHING
        self._after_high = then
        self._condition_sda = sda
        self._at(max(now, self._low_from + self.state.tm), CONDITION)

    def _condition_low(self, now: int) -> None:
        self._drive(self._condition_sda)
        self._release_after_low(now)

    # Debugger ----------------------------------------------------------------------------

    def halt(self, now: int) -> None:
        if not self.active:
            return
        if self.pulls & SCL:
            self.frozen = True
        else:
            self.halting = True

    def resume_after_halt(self, now: int) -> None:
        self.halting = False
        if self.frozen:
            self.frozen = False
            if self._step == NO_STEP and not self._holds and self.pulls & SCL:
                self._at(now, RELEASE)
