"""The I2C module as master-receiver: answers received bytes, fills I2CDRR and chooses the next action.

    bits --> answer ACK or NACK --> I2CDRR, or I2CRSR if that is unread --> next byte, hold, repeated START, STOP

Sending is in `master_transmitter`, commands and conditions are in `master`. Source: SPRUG03B sections 2.3 to 2.8,
5.7, Tables 5, 6.
"""

# core: compiled

from __future__ import annotations

from ...core.chip import NEVER
from ...core.state import State
from .clock import HELD_FOR_COMMAND, HELD_FOR_NOTHING, HELD_FOR_ROOM
from .conditions import I2cConditions
from .register_map import MDR_NACKMOD, MDR_RM, MDR_STP, MDR_STT, STR_NACKSNT, STR_RSFULL

# The byte in progress.
NO_BYTE, START_BYTE, ADDRESS, SEND, RECEIVE = range(5)


class I2cMasterReceiver(I2cConditions):
    """Receiving half of the master.

    deliver_at: the cycle at which a byte returns in loopback, or NEVER.
    """

    STATE = State(
        "_kind _n _bit _byte _in _sampled _answer_nack _nack_armed _stp_at_start _rsr_waits _data_bytes _deliver",
        cycles="deliver_at",
    )

    def reset_bytes(self) -> None:
        """Reset the state of the byte in progress."""
        self._kind = NO_BYTE
        self._n = 8
        self._bit = 0
        self._byte = 0
        self._in = 0
        self._sampled = 1
        self._answer_nack = False
        self._nack_armed = False
        self._stp_at_start = False
        self._rsr_waits = False
        self._data_bytes = 0
        self.deliver_at = NEVER
        self._deliver = 0

    def _next_data(self, now: int) -> None:
        """Begin the next data byte. SCL is low and this module owns the bus."""
        raise NotImplementedError

    def _done(self, now: int) -> None:
        """Choose the next action when the counter has reached 0."""
        raise NotImplementedError

    def _refused(self, now: int) -> None:
        """Process a NACK of the byte in progress."""
        raise NotImplementedError

    # Receiving ------------------------------------------------------------------------

    def _repeat(self) -> bool:
        if not self.state.mdr & MDR_RM:
            return False
        return self._kind != RECEIVE or self.state.options.rm_receiver.assume(self.state.touched) == "allowed"

    def _choose_answer(self) -> None:
        state = self.state
        stp = bool(state.mdr & MDR_STP)
        if self._nack_armed or state.mdr & MDR_STT:
            self._answer_nack = True
        elif self._repeat():
            self._answer_nack = stp
        elif self.counter <= 1:
            self._answer_nack = stp or state.options.mr_nack_at_count0.assume(state.touched) == "always"
        else:
            self._answer_nack = stp and not self._stp_at_start

    def _store_byte(self, now: int) -> None:
        state = self.state
        value = self._in & 0xFF
        if self._n < 8 and state.options.bc_less_than_8_upper_bits.assume(state.touched) == "zeros":
            value = self._in & (1 << self._n) - 1
        self._received(now, value)

    def _received(self, now: int, value: int) -> None:
        state = self.state
        if state.rx_blocked():
            state.rsr = value
            self._rsr_waits = True
            state.overrun(now)
        else:
            state.received(now, value)

    def _receive_done(self, now: int) -> None:
        state = self.state
        if state.rrdy_rises_at("fall9"):
            self._store_byte(now)
        if self._answer_nack:
            if self._nack_armed:
                state.mdr &= ~MDR_NACKMOD
            state.set(now, STR_NACKSNT)
        self.counter -= 1
        self._data_bytes += 1
        if self._rsr_waits:
            self._holds = HELD_FOR_ROOM
            return
        self._after_receive(now)

    def _after_receive(self, now: int) -> None:
        state = self.state
        mdr = state.mdr
        if mdr & MDR_STT and self._answer_nack:
            self._restart(now, False)
        elif self._repeat() or mdr & MDR_STT:
            if mdr & MDR_STP and self._answer_nack:
                self._stop(now)
            elif self._answer_nack:
                self._holds = HELD_FOR_COMMAND
            else:
                self._next_data(now)
        elif self.counter <= 0:
            self._done(now)
        elif self._answer_nack:
            if mdr & MDR_STP:
                self._stop(now)
            else:
                self._holds = HELD_FOR_COMMAND
        else:
            self._next_data(now)

    def drr_read(self, now: int) -> None:
        state = self.state
        if not self._rsr_waits or state.rx_blocked():
            return
        self._rsr_waits = False
        state.str &= ~STR_RSFULL
        state.received(now, state.rsr)
        if self._holds == HELD_FOR_ROOM:
            self._holds = HELD_FOR_NOTHING
            self._after_receive(now)
