"""The bytes of the I2C master: sends addresses and I2CDXR, acknowledges received bytes, and chooses the next action.

    I2CDXR --> I2CXSR --> bits --ACK--> next byte, or hold SCL until I2CDXR is written, or repeated START, or STOP
    bits --> ACK or NACK --> I2CDRR, or I2CRSR while I2CDRR is unread --> next byte, hold, repeated START, or STOP

In loopback the module receives the byte that it sends, a fixed time later. `master` executes commands and samples bits.

Source: SPRUG03B sections 2.3 to 2.8, 5.7, Tables 5, 6.
"""

# core: compiled

from __future__ import annotations

from ...core.chip import NEVER
from ...core.state import State
from .master_lines import (
    HELD_FOR_COMMAND,
    HELD_FOR_DATA,
    HELD_FOR_NOTHING,
    HELD_FOR_ROOM,
    LEFT_HIGH,
    SET_SDA,
    I2cMasterLines,
)
from .register_map import (
    MDR_DLB,
    MDR_FDF,
    MDR_NACKMOD,
    MDR_RM,
    MDR_STP,
    MDR_STT,
    MDR_TRX,
    MDR_XA,
    STR_ARDY,
    STR_NACK,
    STR_NACKSNT,
    STR_RSFULL,
    STR_XSMT,
)

# Kinds of the byte in progress.
NO_BYTE, START_BYTE, ADDRESS, SEND, RECEIVE = range(5)


class I2cMasterData(I2cMasterLines):
    """Sending and receiving of bytes by the master.

    deliver_at: the cycle at which the sent byte is received in loopback, or NEVER. It is 8 module clocks after the last
        bit of the byte or after the write of I2CDXR, as the option dlb_delay selects.
    """

    STATE = State(
        "_kind _n _bit _byte _in _sampled _answer_nack _nack_armed _stp_at_start _rsr_waits _data_bytes _deliver",
        cycles="deliver_at",
    )

    def reset_bytes(self) -> None:
        """Reset the state of the byte in progress."""
        self._kind = NO_BYTE
        self._n = 8
        self._bit = self._byte = self._in = self._data_bytes = self._deliver = 0
        self._sampled = 1
        self._answer_nack = self._nack_armed = self._stp_at_start = self._rsr_waits = False
        self.deliver_at = NEVER

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

    def _store_byte(self, now: int, shifted: int, bits: int) -> None:
        if self.state.store(now, shifted, bits):
            self._rsr_waits = True

    def _receive_done(self, now: int) -> None:
        state = self.state
        if state.rrdy_rises_at("fall9"):
            self._store_byte(now, self._in, self._n)
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

    # Sending --------------------------------------------------------------------------

    def _begin_byte(self, now: int, byte: int, n: int) -> None:
        """Begin to send or receive a byte of `n` bits: schedule the change of SDA for its first bit."""
        self._byte, self._n, self._bit = byte, n, 0
        self._answer_nack = self._nack_armed = False
        self._holds = HELD_FOR_NOTHING
        self._at(max(now, self._low_from + self.state.tm), SET_SDA)

    def _next_data(self, now: int) -> None:
        """Begin to receive (TRX = 0) or send (TRX = 1) the next data byte. SCL is low, and this module owns the bus.

        If there is no byte to send, begin a STOP if RM = STP = 1; otherwise hold SCL low until I2CDXR is written.
        """
        state = self.state
        if not state.mdr & MDR_TRX:
            self._kind = RECEIVE
            self._begin_byte(now, 0, state.bits())
        elif state.copy_to_xsr(now):
            state.xsr_full = False
            self._kind = SEND
            state.clear(now, STR_ARDY)
            self._begin_byte(now, state.xsr, state.bits())
        elif state.mdr & MDR_RM and state.mdr & MDR_STP:
            self._stop(now)
        else:
            self._kind = SEND
            self._holds = HELD_FOR_DATA
            state.clear(now, STR_XSMT)
            if state.mdr & MDR_RM and self._data_bytes:
                state.set(now, STR_ARDY)

    def dxr_written(self, now: int) -> None:
        state = self.state
        loops_back = state.mdr & MDR_DLB and self.active
        if loops_back and state.options.dlb_delay.assume(state.touched) == "after_dxr_write":
            self._deliver, self.deliver_at = state.dxr, now + 8 * state.tm
        if self._holds == HELD_FOR_DATA:
            self._next_data(now)

    def _sent(self, now: int, ack: bool) -> None:
        state = self.state
        self._data_bytes += 1
        self.counter -= 1
        if not ack:
            self._refused(now)
            return
        if not (not state.mdr & MDR_XA and state.sar == 0 and not state.mdr & MDR_FDF):
            state.clear(now, STR_NACK)
        if state.mdr & MDR_RM:
            state.set(now, STR_ARDY)
        if state.mdr & MDR_STT:
            self._restart(now, False)
        elif state.mdr & MDR_RM:
            if state.mdr & MDR_STP and not state.tx_ready():
                self._stop(now)
            else:
                self._next_data(now)
        elif self.counter == 0:
            self._done(now)
        else:
            self._next_data(now)

    def _done(self, now: int) -> None:
        """Begin the STOP or repeated START that STP or STT commands at the end of the count, or wait for a command."""
        state = self.state
        if state.mdr & MDR_STP:
            self._stop(now)
            return
        state.set(now, STR_ARDY)
        if state.mdr & MDR_STT:
            self._restart(now, False)
        else:
            self._holds = HELD_FOR_COMMAND

    def _refused(self, now: int) -> None:
        """Process a NACK for the address or data byte that was sent."""
        state = self.state
        state.wanted = False
        if state.options.ardy_on_nack.assume(state.touched):
            state.str |= STR_ARDY
        state.nack_received(
            now, as_slave=False, refused=f"address 0x{state.sar:02X}" if self._kind == ADDRESS else "a byte"
        )
        self._addresses, self._restart_next = [], []
        if state.options.hold_scl_after_nack.assume(state.touched):
            self._holds = HELD_FOR_COMMAND
        elif state.mdr & MDR_STP:
            self._stop(now)
        else:
            self._holds = LEFT_HIGH
