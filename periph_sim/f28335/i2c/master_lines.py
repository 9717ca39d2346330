"""The line driver of the I2C master: schedules falls and releases of SCL, START, repeated START and STOP.

    SCL low --low()--> released --others may hold SCL--> SCL rises --high()--> `_after_high`: fall of SCL or a condition
    SDA falls while SCL is high: START      SDA rises while SCL is high: STOP

START, repeated START and STOP are called conditions. The subclasses `I2cMasterData` and `I2cMaster` decide when to make
one. `_step` is the next action, and `due` its cycle. If another device lengthens a low phase, the high phase begins
later. If another device pulls SCL low in the high phase of a bit, this module does so, too (`I2cMaster.fell`).

Source: SPRUG03B sections 2.3 to 2.8, 5.7, Tables 5, 6, 15.

Chosen:
- START hold, repeated START setup and STOP setup last one high time of SCL.
"""

# core: compiled

from __future__ import annotations

from ...core.chip import NEVER
from ...core.state import State
from .limits import I2cLimits
from .register_map import MDR_DLB, MDR_FDF, MDR_TRX, MDR_XA, SCL, SDA, STR_ARDY
from .registers import I2cRegisters

# Steps: none; release SCL; set SDA for a condition; set SDA for a bit; pull SCL low; make a START; end the START; make
# a STOP; make a repeated START.
NO_STEP, RELEASE, CONDITION, SET_SDA, FALL, START, STARTED, STOP, RESTART = range(9)

# HELD_...: the master holds SCL low until there is a command, a byte to send, or room for a received byte.
# LEFT_HIGH: it leaves SCL high until there is a command. HELD_FOR_NOTHING: it does not wait.
HELD_FOR_NOTHING, HELD_FOR_COMMAND, HELD_FOR_DATA, HELD_FOR_ROOM, LEFT_HIGH = range(5)


class I2cMasterLines:
    """Clock generator and conditions of the master.

    counter: number of data bytes left in the transfer, from I2CCNT.
    pulls: mask of the lines that the master holds low.
    due: the cycle of the next step, or NEVER.
    lines: levels of SCL and SDA before the noise filter.
    """

    STATE = State(
        "lines frozen halting active pulls _condition_sda _step _after_high _waits_for_rise _high_phase _holds _driven "
        "counter _addresses _starting _stopping _own_restart _restart_next",
        cycles="due _released_at _low_from _rose_at",
        expires="_released_at _low_from _rose_at",
    )

    def __init__(self, state: I2cRegisters, limits: I2cLimits) -> None:
        self.state = state
        self.limits = limits
        self.lines = SCL | SDA
        self.frozen = False  # True if a debugger halt is in effect
        self.halting = False  # True if a debugger halt waits for SCL to be low
        self._released_at = self._low_from = self._rose_at = 0
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
        """Return d (Table 15). SCL is low for I2CCLKL + d and high for I2CCLKH + d module clocks."""
        return max(5, 8 - self.state.tm)  # 7, 6 or 5 for IPSC = 0, 1 or more

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
        """Schedule the release of SCL for the end of the low time.

        If SDA changes late, because SCL was held low, the release also waits for the setup time of SDA.
        """
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
        """Set the levels of the lines before the filter. If SCL was released, its rise begins the high phase."""
        moved, self.lines = lines ^ self.lines, lines
        if not self.active or not moved & SCL:
            return
        if lines & SCL:
            if self._waits_for_rise:
                self._rose(now)
        elif self._high_phase and now - self._rose_at < self.state.filter_width:
            self._high_phase = False  # SCL was high for so short a time that the filter removes this pulse
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
        """Prepare a repeated START or STOP while SCL is low: schedule the change of SDA to `sda`, then release SCL.

        One high time after SCL has risen, the step `then` follows.
        """
        self._holds = HELD_FOR_NOTHING
        self._after_high = then
        self._condition_sda = sda
        self._at(max(now, self._low_from + self.state.tm), CONDITION)

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

    # Conditions --------------------------------------------------------------------------

    def reset_conditions(self) -> None:
        """Clear the counter, the addresses and the pending conditions of the transfer."""
        self.counter = 0
        self._addresses: list[int] = []
        self._starting = False  # True from the module's START or repeated START until this has passed the noise filter
        self._stopping = False  # True from the module's STOP until this has passed the noise filter
        self._own_restart = False
        # With ten_bit_read = full_address_first, the module sends the full 10-bit address, makes a repeated START by
        # itself, and sends the first address byte again. Until then, this list has the bytes to send after the repeated
        # START. Otherwise it is empty.
        self._restart_next: list[int] = []

    def _latch_command(self) -> None:
        """At STT, latch the address and, if cnt_copy_point is "start", the counter for the whole transfer."""
        state = self.state
        if state.options.cnt_copy_point.assume(state.touched) == "start":
            self.load_counter()
        self._own_restart = False
        self._restart_next = []
        self._addresses = [] if state.mdr & MDR_FDF else self._address_bytes()
        self.limits.scl(self.low(), self.high())

    def load_counter(self) -> None:
        self.counter = self.state.cnt or 65536

    def _address_bytes(self) -> list[int]:
        state = self.state
        mdr = state.mdr
        if not mdr & MDR_DLB:
            self.limits.address("I2CSAR", state.sar)
        address = state.oar if mdr & MDR_DLB else state.sar
        read = 0 if mdr & MDR_TRX else 1
        if not mdr & MDR_XA:
            return [(address & 0x7F) << 1 | read]
        header = 0xF0 | address >> 7 & 6
        if not read:
            return [header, address & 0xFF]
        if state.options.ten_bit_read.assume(state.touched) == "full_address_first" and not self.active:
            self._restart_next = [header | 1]
            return [header, address & 0xFF]
        return [header | 1]

    def _begin_start(self, now: int) -> None:
        state = self.state
        self.pulls |= SDA
        self._starting = True
        self._high_phase = False
        state.wanted = state.mdr & MDR_TRX > 0
        state.clear(now, STR_ARDY)
        self._at(now + self.high(), STARTED)

    def _restart(self, now: int, own: bool) -> None:
        """Begin a repeated START. own: False if firmware commanded it by STT; True if the module makes it by itself.

        The module does so after a START byte and, as `ten_bit_read` says, when it reads from a 10-bit address.
        """
        self._own_restart = own
        if not own:
            self._latch_command()
        self._begin_condition(now, 1, RESTART)

    def _stop(self, now: int) -> None:
        self.state.clear(now, STR_ARDY)
        self._begin_condition(now, 0, STOP)

    def _stop_high(self) -> None:
        self._stopping = True
        self._after_high = FALL
        self._high_phase = False
        self.pulls &= ~SDA
