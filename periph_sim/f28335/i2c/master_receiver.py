"""The I2C module as master-receiver: bits of a byte go in; the answer to it, I2CDRR and what comes next come out.

    bits --> answer ACK or NACK --> I2CDRR, or I2CRSR where that is unread --> next byte, hold, repeated START, STOP

In loopback the byte that was sent is received, a fixed time later. Commands, conditions and sending are in
`master`. Source: SPRUG03B sections 2.3 to 2.8, 5.7, Tables 5, 6.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

from ...core.chip import NEVER
from .clock import I2cClock
from .register_map import MDR_NACKMOD, MDR_RM, MDR_STP, MDR_STT, STR_NACKSNT, STR_RSFULL


class I2cMasterReceiver(I2cClock, ABC):
    """counter: bytes to go."""

    def reset_bytes(self) -> None:
        """No byte is in progress."""
        self.counter = 0
        self._kind = ""  # of the byte in progress: start byte, address, send, take
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
        self._deliver_at = NEVER
        self._deliver = 0

    @abstractmethod
    def _next_data(self, now: int) -> None:
        """SCL is low, the bus is ours: the next data byte."""

    @abstractmethod
    def _done(self, now: int) -> None:
        """The counter has reached 0."""

    @abstractmethod
    def _stop(self, now: int) -> None: ...

    @abstractmethod
    def _restart(self, now: int, *, own: bool = False) -> None: ...

    def timer(self, now: int) -> None:
        """`due` has come."""
        if self._deliver_at <= now:
            self._deliver_at = NEVER
            self._received(now, self._deliver)
            return
        step, self.due, self._step = self._step, NEVER, self._nothing
        step(now)

    @property
    def next_due(self) -> int:
        return min(self.due, self._deliver_at)

    # Receiving ------------------------------------------------------------------------

    def _repeat(self) -> bool:
        if not self.state.mdr & MDR_RM:
            return False
        self.state.touched.add("rm_receiver")
        return self._kind != "take" or self.state.options.rm_receiver == "allowed"

    def _choose_answer(self) -> None:
        state = self.state
        stp = bool(state.mdr & MDR_STP)
        if self._nack_armed or state.mdr & MDR_STT:
            self._answer_nack = True
        elif self._repeat():
            self._answer_nack = stp
        elif self.counter <= 1:
            state.touched.add("mr_nack_at_count0")
            self._answer_nack = stp or state.options.mr_nack_at_count0 == "always"
        else:
            self._answer_nack = stp and not self._stp_at_start

    def _take(self, now: int) -> None:
        state = self.state
        value = self._in & 0xFF
        if self._n < 8:
            state.touched.add("bc_less_than_8_upper_bits")
            if state.options.bc_less_than_8_upper_bits == "zeros":
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

    def _taken(self, now: int) -> None:
        state = self.state
        if state.options.rrdy_point == "fall9":
            self._take(now)
        if self._answer_nack:
            if self._nack_armed:
                state.mdr &= ~MDR_NACKMOD
            state.set(now, STR_NACKSNT)
        self.counter -= 1
        self._data_bytes += 1
        if self._rsr_waits:
            self._holds = "room"
            return
        self._after_taken(now)

    def _after_taken(self, now: int) -> None:
        state = self.state
        mdr = state.mdr
        if mdr & MDR_STT and self._answer_nack:
            self._restart(now)
        elif self._repeat() or mdr & MDR_STT:
            if mdr & MDR_STP and self._answer_nack:
                self._stop(now)
            elif self._answer_nack:
                self._holds = "command"
            else:
                self._next_data(now)
        elif self.counter <= 0:
            self._done(now)
        elif self._answer_nack:
            if mdr & MDR_STP:
                self._stop(now)
            else:
                self._holds = "command"
        else:
            self._next_data(now)

    def drr_read(self, now: int) -> None:
        state = self.state
        if not self._rsr_waits or state.rx_blocked():
            return
        self._rsr_waits = False
        state.str &= ~STR_RSFULL
        state.received(now, state.rsr)
        if self._holds == "room":
            self._holds = ""
            self._after_taken(now)

    def _loop_back(self, now: int) -> None:
        """The byte sent comes back n = 8 module clocks after its last bit (or after the write of I2CDXR)."""
        state = self.state
        state.touched.add("dlb_delay")
        if state.options.dlb_delay == "after_last_bit":
            self._deliver, self._deliver_at = self._byte & 0xFF, now + 8 * state.tm
