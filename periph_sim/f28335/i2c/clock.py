"""The I2C master's clock generator: times falls and releases of SCL, synchronized with the actual level of the line.

    SCL low --low()--> released --others may hold it--> rises --high()--> `_after_high`: the next fall, or a condition

The next action is a step with its cycle: RELEASE and CONDITION belong to the clock, the others to the master.

A low phase that others lengthen delays the high phase; one that others begin starts ours at once (`fell`, in the
master).
Source: SPRUG03B sections 2.3, 5.7, Table 15.
"""

# core: compiled

from __future__ import annotations

from ...core.chip import NEVER
from ...core.state import State
from .register_map import SCL, SDA
from .registers import I2cRegisters

# Steps: nothing; release SCL; set SDA for the next condition, or for a bit; SCL falls; a START and its end; a STOP; a
# repeated START.
NO_STEP, RELEASE, CONDITION, SET_SDA, FALL, START, STARTED, STOP, RESTART = range(9)

# Reasons to hold SCL low: none; waits for a command, a byte to send, or room for a received byte. After a NACK, SCL may
# instead be left high until a command.
HELD_FOR_NOTHING, HELD_FOR_COMMAND, HELD_FOR_DATA, HELD_FOR_ROOM, LEFT_HIGH = range(5)


class I2cClock:
    """Clock generator of the master.

    pulls: mask of the lines held low.
    due: the cycle of `_step`, or NEVER.
    lines: levels before the filter.
    """

    STATE = State(
        "lines frozen halting active pulls _condition_sda _step _after_high _waits_for_rise _high_phase _holds _driven",
        cycles="due _released_at _low_from _rose_at",
    )

    def __init__(self, state: I2cRegisters) -> None:
        self.state = state
        self.lines = SCL | SDA
        self.frozen = False  # a debugger halt is in effect
        self.halting = False  # a debugger halt waits for SCL to be low
        self._released_at = 0
        self._low_from = 0
        self._rose_at = 0
        self._condition_sda = 1  # SDA while SCL rises for a STOP (0) or repeated START (1)
        self.release_lines()

    def release_lines(self) -> None:
        """Release both lines and cancel the next step."""
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
        """Return the SCL low time in cycles."""
        return self.state.tm * (self.state.clkl + self._d())

    def high(self) -> int:
        """Return the SCL high time in cycles."""
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
        """Release SCL after the low time, or after the setup time if SCL was held until SDA had its level."""
        state = self.state
        over = self._low_from + self.low()
        if now > self._low_from + state.tm + state.filter_width:
            over = max(over, now + state.setup())
        self._at(over, RELEASE)

    def _release(self, now: int) -> None:
        if self.frozen:
            return
        self.pulls &= ~SCL
        self._released_at = now
        self._waits_for_rise = True
        self.due = NEVER

    def lines_changed(self, now: int, lines: int) -> None:
        """Set the actual levels of the lines; an expected rise of SCL begins our high phase."""
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
        if now > self._released_at:
            late = self.state.options.scl_sync_cycles.assume(self.state.touched) * self.state.tm
        self._at(now + late + self.high(), self._after_high)

    def _scl_low(self, now: int) -> None:
        self.pulls |= SCL
        self._low_from = now
        self._high_phase = False
        if self.halting:
            self.halting, self.frozen = False, True

    def _begin_condition(self, now: int, sda: int, then: int) -> None:
        """Prepare a condition while SCL is low: set SDA, release SCL, and do `then` one high time after its rise."""
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
