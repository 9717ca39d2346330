"""The I2C module as master: executes the commands STT and STP of I2CMDR on SCL and SDA, bit by bit, and sets flags.

    STT --> START --> [START byte] --> address --> data --> hold, repeated START, or STOP

`I2cMasterLines` generates SCL, START and STOP; `I2cMasterData` handles bytes.

Source: SPRUG03B sections 2.3 to 2.8, 5.7, Tables 5, 6.

Chosen:
- The module changes SDA one module clock after SCL fell.
- While the master waits for a command, a write of 1 to STT or STP is a command even if the bit was 1 already.
- With hold_scl_after_nack = false, a STOP follows a NACK automatically if STP = 1.
- In loopback the module acknowledges itself.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER
from ...core.state import State
from .limits import I2cLimits
from .master_data import ADDRESS, NO_BYTE, RECEIVE, SEND, START_BYTE, I2cMasterData
from .master_lines import (
    CONDITION,
    FALL,
    HELD_FOR_COMMAND,
    HELD_FOR_DATA,
    LEFT_HIGH,
    NO_STEP,
    RELEASE,
    RESTART,
    SET_SDA,
    START,
    STARTED,
    STOP,
)
from .register_map import (
    MDR_DLB,
    MDR_MST,
    MDR_NACKMOD,
    MDR_RM,
    MDR_STB,
    MDR_STP,
    MDR_STT,
    MDR_TRX,
    MDR_XA,
    SCL,
    STR_AL,
    STR_BB,
    STR_NACK,
)
from .registers import I2cRegisters

FIRST_BYTE = 0x01  # value of the START byte
SKIPPED_BITS = 7  # number of bits of a byte that can be skipped; the eighth is always simulated
NO_BIT = -1
ONES = 0xFF


@final
class I2cMaster(I2cMasterData):
    """Master side of the module.

    active: True while this module owns the bus.
    sees_idle: True if both lines are high after the filter. The owner sets it before each call of `timer`.
    skip_release: the cycle in which SCL was released for the first bit of a byte with skipped bits (see `begin_skip`).
    skip_fell: the cycle in which the module pulled SCL low before this release.
    skip_low: the low time of SCL in skipped bits, in cycles.
    skip_high: the time from a release of SCL until the module pulls SCL low again, in cycles.
    """

    STATE = State("sees_idle starts _waits_for_bus", cycles="_free_from", expires="_free_from", results="starts")

    def __init__(self, state: I2cRegisters, limits: I2cLimits) -> None:
        super().__init__(state, limits)
        self.sees_idle = True
        self.starts = 0  # number of STARTs and repeated STARTs that this module has made
        self.reset()

    def reset(self) -> None:
        """Release the lines and abort the transfer, as IRS = 0 does."""
        self.release_lines()
        self.reset_conditions()
        self.reset_bytes()
        self.skip_low = self.skip_high = self._skip_delay = 0  # times in cycles; `begin_skip` sets them
        self._in_before = self._sampled_before = self.skip_fell = self._rose_before = self.skip_release = 0
        self._waits_for_bus = False
        self._free_from = 0  # cycle from which on the bus has been free long enough for a START

    # Steps --------------------------------------------------------------------------

    def timer(self, now: int) -> None:
        """Execute the step that is due at `due` or, in loopback, receive the byte that is due at `deliver_at`."""
        if self.deliver_at <= now:
            self.deliver_at = NEVER
            self._store_byte(now, self._deliver, 8)
            return
        step = self._step
        self.due, self._step = NEVER, NO_STEP
        if step == RELEASE:
            self._release(now)
        elif step == FALL:
            self._fall(now)
        elif step == SET_SDA:
            self._set_sda(now)
        elif step == CONDITION:
            self._drive(self._condition_sda)
            self._release_after_low(now)
        elif step == START:
            self._start(now)
        elif step == STARTED:
            self._started(now)
        elif step == STOP:
            self._stop_high()
        elif step == RESTART:
            self._after_high = FALL
            self._begin_start(now)

    def answers_edges(self) -> bool:
        """Return True if an edge on the bus may cause the master to change a line, at once or later."""
        return self.active or self._waits_for_bus

    # Commands -----------------------------------------------------------------------

    def command(self, now: int, written: int) -> None:
        """Act on STT and STP after a write of `written` to I2CMDR."""
        state = self.state
        mdr = state.mdr
        if not mdr & MDR_MST or not written & (MDR_STT | MDR_STP):
            return
        if mdr & MDR_RM and mdr & MDR_STT and mdr & MDR_STP:
            return  # reserved combination: no activity (Table 6)
        if not self.active:
            if mdr & MDR_STT:
                self._request_bus(now)
            return
        if self._holds == LEFT_HIGH:
            self._scl_low(now)
            self._holds = HELD_FOR_COMMAND
        if self._holds == HELD_FOR_COMMAND:
            if mdr & MDR_STT:
                self._restart(now, False)
            elif (
                self._data_bytes
                or mdr & MDR_RM
                or state.options.stop_without_data.assume(state.touched) != "waits_for_data"
            ):
                self._stop(now)
        elif self._holds == HELD_FOR_DATA:
            if mdr & MDR_STT:
                self._restart(now, False)
            elif mdr & MDR_RM:
                self._stop(now)

    def _request_bus(self, now: int) -> None:
        state = self.state
        if state.str & STR_BB:
            policy = state.options.stt_while_busy.assume(state.touched)
            if policy == "foreign_al":
                self.lose(now)
                return
            if policy == "foreign_waits":
                self._waits_for_bus = True
                return
        self._latch_command()
        self._at(max(now + state.tm, self._free_from), START)

    def start_seen(self, now: int) -> None:
        if self._starting:
            self._starting = False
        elif self.active:
            self._meets_foreign_condition(now)

    def stop_seen(self, now: int) -> None:
        if self._stopping:
            self._stopping = False
            self.active = False
            self._free_from = now + self.low()
            self.state.mdr &= ~(MDR_STP | MDR_MST)
            self.state.wanted = False
        elif self._waits_for_bus:
            self._waits_for_bus = False
            self._free_from = now + self.low()
            self._latch_command()
            self._at(self._free_from, START)
        elif self.active:
            self._meets_foreign_condition(now)

    def _meets_foreign_condition(self, now: int) -> None:
        """Process a START or STOP of another device during a transfer. Section 2.8 does not state the effect."""
        if self.state.options.foreign_start_stop.assume(self.state.touched) == "loses_arbitration":
            self.lose(now)

    def _start(self, now: int) -> None:
        """Begin the START. If a line is low, try again one low time later.

        If another master has taken the bus, the option stt_while_busy decides what happens. A START of another master
        that has not passed the noise filter yet is not seen, so that both masters continue.
        """
        state = self.state
        if state.str & STR_BB and state.options.stt_while_busy.assume(state.touched) != "always_repeated_start":
            self._request_bus(now)  # another master has taken the bus
            return
        if not self.sees_idle:
            self._at(now + self.low(), START)
            return
        self.active = True
        self._begin_start(now)

    def _started(self, now: int) -> None:
        """End the START: pull SCL low, and begin the first byte."""
        state = self.state
        mdr = state.mdr
        self.starts += 1
        self._scl_low(now)
        if self._own_restart and self._restart_next:
            self._addresses, self._restart_next = self._restart_next, []
            self._next_address(now)
            return
        if mdr & MDR_STB and self._kind != START_BYTE:
            self._kind = START_BYTE
            self._begin_byte(now, FIRST_BYTE, 8)
            return
        state.mdr &= ~MDR_STT
        self._stp_at_start = bool(mdr & MDR_STP)
        self._data_bytes = 0
        state.wanted = bool(mdr & MDR_TRX)
        state.update(now)
        if self._addresses:
            self._next_address(now)
        else:
            self._kind = NO_BYTE
            self._next_data(now)

    # Bytes --------------------------------------------------------------------------

    def _next_address(self, now: int) -> None:
        self._kind = ADDRESS
        self._begin_byte(now, self._addresses.pop(0), 8)

    def _set_sda(self, now: int) -> None:
        """Put the next bit on SDA while SCL is low, and schedule the release of SCL after the low time."""
        bit, n = self._bit, self._n
        if self._kind == RECEIVE:
            level = 1 if bit < n or self._answer_nack else 0
        else:
            level = 1 if bit == n else self._byte >> (n - 1 - bit) & 1
        self._drive(level)
        self._release_after_low(now)

    def fell(self, now: int) -> None:
        """Process a filtered fall of SCL. If another device has pulled SCL low, the high phase ends early."""
        if not self.active or self.lines & SCL:
            return
        if self._step == STARTED:  # SCL fell within the hold time of this module's START
            self._started(now)
        elif self._high_phase and self._after_high == FALL:
            self._fall(now)
        else:
            return
        self._low_from = now - self.state.filter_width

    def rise(self, now: int, sda: int) -> None:
        """Sample SDA at a filtered rise of SCL. Lose arbitration if SDA is low for a bit that is sent as 1."""
        if not self.active or self._after_high != FALL:
            return
        self._sampled = sda
        if self._kind != RECEIVE and self._bit < self._n and self._driven and not sda:
            self.lose(now)
            return
        if self._bit < self._n:
            self._in = (self._in << 1 | sda) & 0xFF
            if self._bit == self._n - 1:
                self._nack_armed = bool(self.state.mdr & MDR_NACKMOD)
        if self._kind == RECEIVE and self._bit == self._n and self.state.rrdy_rises_at("rise9"):
            self._store_byte(now, self._in, self._n)

    def _fall(self, now: int) -> None:
        if self._bit == self._n and self._kind in (ADDRESS, SEND) and self._sampled and self._leaves_scl_high():
            self._high_phase = False
            self._refused(now)
            return
        self._scl_low(now)
        self._bit = bit = self._bit + 1
        if bit <= self._n:
            if bit == self._n and self._kind == RECEIVE:
                self._choose_answer()
                if self.state.rrdy_rises_at("fall8"):
                    self._store_byte(now, self._in, self._n)
            loops_back = bit == self._n and self._kind == SEND and self.state.mdr & MDR_DLB
            if loops_back and self.state.options.dlb_delay.assume(self.state.touched) == "after_last_bit":
                self._deliver, self.deliver_at = self._byte & 0xFF, now + 8 * self.state.tm
            self._at(now + self.state.tm, SET_SDA)
            return
        self._byte_over(now)

    def _byte_over(self, now: int) -> None:
        ack = self._sampled == 0 or bool(self.state.mdr & MDR_DLB)
        kind = self._kind
        if kind == START_BYTE:
            self._restart(now, True)
        elif kind == ADDRESS:
            self._address_over(now, ack)
        elif kind == SEND:
            self._sent(now, ack)
        else:
            self._receive_done(now)

    def _address_over(self, now: int, ack: bool) -> None:
        state = self.state
        general_call = not state.mdr & MDR_XA and self._byte == 0
        if ack and not general_call:
            state.clear(now, STR_NACK)
        elif ack:
            state.nack_received(now, as_slave=False, refused="")
        if not ack:
            self._refused(now)
        elif self._addresses:
            self._next_address(now)
        elif self._restart_next:
            self._restart(now, True)
        else:
            self._next_data(now)

    def _leaves_scl_high(self) -> bool:
        """Return True if SCL stays high after a NACK until the next command, instead of being held low."""
        state = self.state
        return not (state.mdr & (MDR_STP | MDR_DLB) or state.options.hold_scl_after_nack.assume(state.touched))

    # STOP, loss of arbitration ----------------------------------------------------------

    def lose(self, now: int) -> None:
        """Set AL and become a slave-receiver, because arbitration is lost or another master owns the bus."""
        state = self.state
        cleared = MDR_MST | MDR_STP
        if state.mdr & MDR_STT and state.options.al_clears_stt.assume(state.touched):
            cleared |= MDR_STT
        state.mdr &= ~cleared
        self.release_lines()
        self._starting = self._stopping = False
        self._addresses, self._restart_next = [], []
        state.wanted = False
        state.set(now, STR_AL)

    # Skipped bits (see `bus.i2c.bit_skip`) --------------------------------------------

    def released_bit(self) -> int:
        """Return the index of the bit for which SCL is released but has not risen yet; NO_BIT if there is none."""
        if not self._waits_for_rise or self._after_high != FALL or self._kind == NO_BYTE:
            return NO_BIT
        return self._bit

    def only_clocks(self) -> bool:
        """Return True if the master only transfers a byte of eight bits, and has no step scheduled."""
        return not (self.frozen or self.halting) and self._n == SKIPPED_BITS + 1 and self.due == NEVER

    def byte(self) -> int:
        """Return the byte that the master puts on SDA; 0xFF if it receives."""
        return ONES if self._kind == RECEIVE else self._byte

    def keeps_bus(self, shown: int) -> bool:
        """Return True if the master does not lose arbitration when the byte on the bus is `shown`."""
        return self._kind == RECEIVE or shown == self._byte

    def begin_skip(self, delay: int) -> None:
        """Begin to skip bits: store the present state. SCL has just been released for the first bit of a byte, bit 0.

        delay: cycles from an output of the module to its pin.

        output SCL  __|~~|__|~~|_ ... _|~~|_      bit n: release at `skip_release` + n (`skip_low` + `skip_high`)
                      ^ bit position 0      ^ position 7: the module wakes to release SCL for bit 7
        """
        late = self.state.options.scl_sync_cycles.assume(self.state.touched) * self.state.tm if delay else 0
        self.skip_low, self.skip_high, self._skip_delay = self.low(), delay + late + self.high(), delay
        self._in_before, self._sampled_before = self._in, self._sampled
        self.skip_fell, self._rose_before, self.skip_release = self._low_from, self._rose_at, self._released_at

    def set_bit_position(self, shown: int, bit: int) -> None:
        """Set the state that the master has after `bit` bits, 0 or 7, of the byte `shown` have passed on the bus."""
        period = self.skip_low + self.skip_high
        self._bit = bit
        self._drive(self.byte() >> (SKIPPED_BITS - bit) & 1)
        if bit:
            self.pulls |= SCL
            self._waits_for_rise = False
            self._in, self._sampled = (self._in_before & 1) << SKIPPED_BITS | shown >> 1, shown >> 1 & 1
            self._released_at = self.skip_release + (SKIPPED_BITS - 1) * period
            self._rose_at = self._released_at + self._skip_delay
            self._at(self.skip_release + SKIPPED_BITS * period, RELEASE)
            self._low_from = self.due - self.skip_low
        else:
            self.pulls &= ~SCL
            self._waits_for_rise = True
            self._in, self._sampled = self._in_before, self._sampled_before
            self._released_at, self._rose_at = self.skip_release, self._rose_before
            self._low_from = self.skip_fell
            self._at(NEVER, NO_STEP)
