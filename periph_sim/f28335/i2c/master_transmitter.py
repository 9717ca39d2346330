"""The I2C module as master-transmitter: sends the bytes in I2CDXR, or holds SCL until one is written.

    I2CDXR --> I2CXSR --> bits --ACK--> next byte, hold until one is written, repeated START, STOP

In loopback the sent byte is received a fixed time later. Source: SPRUG03B sections 2.3 to 2.8, Tables 5, 6.
"""

# core: compiled

from __future__ import annotations

from .clock import HELD_FOR_COMMAND, HELD_FOR_DATA
from .master_receiver import RECEIVE, SEND, I2cMasterReceiver
from .register_map import MDR_DLB, MDR_FDF, MDR_RM, MDR_STP, MDR_STT, MDR_TRX, MDR_XA, STR_ARDY, STR_NACK, STR_XSMT


class I2cMasterTransmitter(I2cMasterReceiver):
    """Transmitting half of the master; it also begins the next byte to receive."""

    def _begin_byte(self, now: int, byte: int, n: int) -> None:
        """Begin a byte of n bits: schedule its first bit on SDA."""
        raise NotImplementedError

    def _next_data(self, now: int) -> None:
        """Begin the next data byte, or wait for it. SCL is low and this module owns the bus."""
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
        """Choose the next action when the counter has reached 0."""
        state = self.state
        if state.mdr & MDR_STP:
            self._stop(now)
            return
        state.set(now, STR_ARDY)
        if state.mdr & MDR_STT:
            self._restart(now, False)
        else:
            self._holds = HELD_FOR_COMMAND

    def _loop_back(self, now: int) -> None:
        """Schedule the return of the sent byte n = 8 module clocks after its last bit (or the write of I2CDXR)."""
        state = self.state
        if state.options.dlb_delay.assume(state.touched) == "after_last_bit":
            self._deliver, self.deliver_at = self._byte & 0xFF, now + 8 * state.tm
