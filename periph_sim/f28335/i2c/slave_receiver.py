"""The I2C module as slave-receiver: answers data bytes, fills I2CDRR, and stretches while there is no room.

    bits --> answer ACK or NACK --> I2CDRR, or I2CRSR if that is unread: SCL held until I2CDRR is read

`slave` handles addresses and enters this state. Source: SPRUG03B sections 2 and 3, Table 1, Table 10.
"""

# core: compiled

from __future__ import annotations

from .register_map import MDR_FDF, SCL, SDA, STR_AAS, STR_RSFULL
from .slave_transmitter import I2cSlaveTransmitter


class I2cSlaveReceiver(I2cSlaveTransmitter):
    """Receiving half of the slave."""

    def _policy(self) -> str:
        """Return the policy for a byte without room: "stretch", "nack" or "overwrite"."""
        state = self.state
        if state.fifo:
            return state.options.fifo_17th_byte.assume(state.touched)
        return state.options.rx_overrun_policy.assume(state.touched).partition("_")[0]

    def _stretches(self, point: str) -> bool:
        """Return True if the module begins to stretch here for a byte without room."""
        return self.state.options.rsfull_stretch_point.assume(self.state.touched) == point

    def _data_complete(self, now: int) -> None:
        """Process fall 8 of a data byte."""
        state = self.state
        if (
            self._first_byte
            and state.mdr & MDR_FDF
            and state.options.aas_fdf_point.assume(state.touched) == "end_of_byte"
        ):
            state.set(now, STR_AAS)
        self._ack = not self._nack_armed
        blocked = state.rx_blocked()
        if blocked and self._policy() == "nack":
            self._ack = False
        if self._ack:
            if blocked and self._policy() == "stretch" and self._stretches("before_ack"):
                self.pulls |= SCL
                self._waits_for_room = True
            else:
                self.pulls |= SDA
        if state.rrdy_rises_at("fall8") or self._waits_for_room:
            self._store_byte(now)

    def _store_byte(self, now: int) -> None:
        """Copy the complete I2CRSR, or let it wait for room."""
        state = self.state
        value = self._value()
        if state.rx_blocked():
            self._rsr_waits = True
            state.rsr = value
            state.overrun(now)
        else:
            state.received(now, value)

    def _value(self) -> int:
        if self._n == 8:
            return self._shift & 0xFF
        if self.state.options.bc_less_than_8_upper_bits.assume(self.state.touched) == "zeros":
            return self._shift & (1 << self._n) - 1
        return self._shift & 0xFF

    def drr_read(self, now: int) -> None:
        """Copy a waiting byte and end a stretch after the CPU has read I2CDRR."""
        if not self._rsr_waits or self.state.rx_blocked():
            return
        self._rsr_waits = False
        self.state.str &= ~STR_RSFULL
        self.state.received(now, self.state.rsr)
        if self._waits_for_room:
            self._waits_for_room = False
            if self.bit == self._n:
                self.pulls |= SDA
            self.pulls &= ~SCL

    def _data_slot_ends(self, now: int) -> None:
        state = self.state
        if state.rrdy_rises_at("fall9") or (not self._ack and state.rrdy_rises_at("rise9")):
            self._store_byte(now)
        if self._first_byte and state.mdr & MDR_FDF:
            state.set(now, STR_AAS)
        if self._rsr_waits and self._ack and self._policy() == "stretch" and self._stretches("after_fall9"):
            self.pulls |= SCL
            self._waits_for_room = True
