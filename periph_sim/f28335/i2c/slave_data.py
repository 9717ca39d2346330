"""The data bytes of the I2C slave: sends I2CXSR, acknowledges and stores received bytes, and stretches SCL.

    I2CDXR --copy--> I2CXSR --_send--> bit after bit --> acknowledge bit --ACK--> next byte
                        +--empty--> underflow: SCL held low until I2CDXR is written
    bits --> ACK or NACK --> I2CDRR, or I2CRSR while I2CDRR is unread: SCL held low until I2CDRR is read

The diagram shows the default options. `slave` handles START, STOP and addresses, and calls these methods for data.

Source: SPRUG03B sections 2 and 3, Tables 1, 8, 10, Figure 17.

Chosen:
- In free data format I2CXSR is loaded at the fall of SCL after START.
- With BCM = 0 and SCL held low, I2CDXR is copied to I2CXSR one module clock after it was written. SCL is released when
  the setup time of SDA has passed (option `sda_setup_before_scl_release`).
"""

# core: compiled

from __future__ import annotations

from ...core.chip import NEVER
from ...core.options import TextOption
from ...core.state import State
from .register_map import (
    MDR_FDF,
    MDR_IRS,
    MDR_MST,
    MDR_TRX,
    SCL,
    SDA,
    STR_AAS,
    STR_NACK,
    STR_RSFULL,
    STR_XRDY,
    STR_XSMT,
)
from .registers import I2cRegisters

OFF, IGNORE, ADDRESS, ADDRESS_LOW, RECEIVE, TRANSMIT = range(6)
LISTENS = ADDRESS  # in this phase and those with greater values, bytes on the bus may be for this module
ONES = 0xFF


class I2cSlaveData:
    """Data bytes of the slave.

    pulls: mask of the lines that the slave holds low.
    due: the cycle of the next call of `timer`, or NEVER.
    """

    STATE = State(
        "pulls phase bit muted own_transfer _n _shift _ack _nack_armed _read _selected _latched _waits_for_data "
        "_waits_for_room _rsr_waits _sent _first_byte _shifting",
        cycles="due _copy_at _release_at",
    )

    def __init__(self, state: I2cRegisters) -> None:
        self.state = state
        self._copy_point: TextOption = state.options.dxr_to_xsr_copy_point
        self.muted = False  # True while this module is the master, so that it does not answer to its own address
        self._n = 8
        self._shift = self._sent = 0
        self._nack_armed = self._first_byte = False
        self._read = False  # True if R/W = 1 in the last byte that was compared with the own address
        self._latched = 0  # latched value of I2COAR; not used if the option `oar_latch` is "live"
        self.reset()

    def _release_lines(self) -> None:
        self.pulls = 0
        self._waits_for_data = self._waits_for_room = self._shifting = self._ack = False
        self._copy_at = self._release_at = self.due = NEVER

    def reset(self) -> None:
        """Release the lines and abort the transfer, as a change of IRS does."""
        self._release_lines()
        self.phase = OFF
        self.bit = 0
        self._rsr_waits = self.own_transfer = False
        self._selected = False  # True if a 10-bit address has matched in full in this transfer
        if self.state.mdr & MDR_IRS:
            self._latched = self.state.oar

    # Sending ------------------------------------------------------------------------

    def _copies_at(self, point: str) -> bool:
        """Return True if I2CDXR is copied to I2CXSR at `point`, a value of the option dxr_to_xsr_copy_point."""
        return self._copy_point.assume(self.state.touched) == point

    def _copies_at_once(self) -> bool:
        point = self._copy_point.assume(self.state.touched)
        if point == "eager_if_trx":
            return self.state.mdr & MDR_TRX > 0
        return point == "eager" or point == "eager_reloaded_at_address"

    def _eager(self, now: int) -> None:
        state = self.state
        if not self._shifting and not state.xsr_full and state.tx_ready() and self._copies_at_once():
            state.copy_to_xsr(now)

    def dxr_written(self, now: int) -> None:
        """Process a write of I2CDXR: send the byte if the slave waits for it, else copy it to I2CXSR if options say so.

        With BCM = 0, a byte for which the slave waits is sent one module clock later.
        """
        state = self.state
        if self._waits_for_data:
            if state.bcm:
                state.copy_to_xsr(now)
                self._send(now)
                self._waits_for_data = False
                self._release(now)
            elif self._copy_at == NEVER:
                state.wanted = False
                if state.options.xsmt_rule.assume(state.touched) == "figure":
                    state.clear(now, STR_XSMT)
                self._copy_at = now + state.tm
                self.due = min(self.due, self._copy_at)
            return
        if not self.muted and not state.mdr & MDR_MST:
            self._eager(now)

    def _release(self, now: int) -> None:
        self._release_at = now + self.state.setup()
        self.due = min(self._release_at, self._copy_at)

    def timer(self, now: int) -> None:
        """Copy I2CDXR to I2CXSR or release SCL, whichever is due at `due`."""
        if self._copy_at <= now:
            self._copy_at = NEVER
            self._waits_for_data = False
            self.state.copy_to_xsr(now)
            self.state.set(now, STR_XSMT)
            self._send(now)
            self._release(now)
        if self._release_at <= now:
            self._release_at = NEVER
            self.pulls &= ~SCL
        self.due = min(self._copy_at, self._release_at)

    def _begin_byte(self, now: int, first: bool) -> None:
        """Begin to send a data byte, or handle an underflow. Call at fall 9 of an acknowledged byte.

        In free data format, the first call is at the fall of SCL after START.
        first: True for the first data byte of a read.
        """
        state, options = self.state, self.state.options
        self.bit = 0
        self._n = state.bits()
        self._first_byte = False
        if state.cnt and self._sent >= state.cnt and options.cnt_in_slave_tx.assume(state.touched) == "counts_bytes":
            state.xsr, state.xsr_full = ONES, True
            self._send(now)
            return
        if not state.bcm:
            state.copy_to_xsr(now)
        elif state.tx_ready() or state.xsr_full:
            point = self._copy_point.assume(state.touched)
            if not state.xsr_full or point == "any_ack_fall9" or point == "ack_fall9":
                state.copy_to_xsr(now)
            elif point == "ack_rise9" and not state.dxr_full:
                state.set(now, STR_XRDY)
        if state.xsr_full:
            self._send(now)
        else:
            self._underflow(now, first)

    def _underflow(self, now: int, first: bool) -> None:
        state, options = self.state, self.state.options
        if state.bcm or options.xsmt_rule.assume(state.touched) == "text":
            state.str &= ~STR_XSMT
        state.wanted = True
        state.update(now)
        if state.bcm:
            if first:
                if not options.stretch_after_address_ack.assume(state.touched):
                    self._send(now)
                    return
            else:
                policy = options.tx_underflow_policy.assume(state.touched)
                if policy != "stretch":
                    if policy == "send_ones":
                        state.xsr = ONES
                    self._send(now)
                    return
        self.pulls |= SCL
        self._waits_for_data = True

    def _send(self, now: int) -> None:
        """Begin to shift out I2CXSR: put its first bit on SDA."""
        state = self.state
        state.xsr_full = False
        self._shifting = True
        self._sent += 1
        self._drive(state.xsr >> (self._n - 1) & 1)

    def _drive(self, level: int) -> None:
        if level:
            self.pulls &= ~SDA
        else:
            self.pulls |= SDA

    def _answered(self, now: int, sda: int) -> None:
        """Process rise 9 of a byte that this module has sent. sda: 0 for ACK, 1 for NACK."""
        state, options = self.state, self.state.options
        if sda == 0:
            state.clear(now, STR_NACK)
            self._copy_at_rise9(now)
            return
        self.phase = IGNORE
        state.wanted = False
        state.str &= ~STR_AAS
        if state.tx_ready():
            if options.nack_clears_dxr.assume(state.touched):
                state.dxr_full = False
                state.str |= STR_XRDY
        else:
            if options.xsmt_on_final_nack.assume(state.touched) == "0_without_stretch":
                state.str &= ~STR_XSMT
        state.nack_received(now, as_slave=True, refused="a byte")

    def _copy_at_rise9(self, now: int) -> None:
        """Copy I2CDXR to I2CXSR at rise 9 if dxr_to_xsr_copy_point is "ack_rise9" and BCM = 1.

        XRDY rises at the copy or at fall 9, as the option xrdy_rise_point selects.
        """
        state = self.state
        if state.bcm and state.tx_ready() and self._copies_at("ack_rise9"):
            state.copy_to_xsr(now, xrdy=state.options.xrdy_rise_point.assume(state.touched) == "at_copy")

    # Receiving ----------------------------------------------------------------------

    def _policy(self) -> str:
        """Return what to do with a received byte that cannot be stored: "stretch", "nack" or "overwrite"."""
        state = self.state
        if state.fifo:
            return state.options.fifo_17th_byte.assume(state.touched)
        return state.options.rx_overrun_policy.assume(state.touched).partition("_")[0]

    def _stretches(self, point: str) -> bool:
        """Return True if the slave begins to hold SCL low at `point` when a received byte cannot be stored.

        point: "before_ack" or "after_fall9".
        """
        return self.state.options.rsfull_stretch_point.assume(self.state.touched) == point

    def _data_complete(self, now: int) -> None:
        """Process fall 8 of a received data byte: pull SDA low for ACK, leave it released for NACK, or hold SCL low.

        The byte is stored now if SCL is held or the option `rrdy_point` is "fall8", else at rise 9 or fall 9.
        """
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
        """Copy the complete byte to I2CDRR, or keep it in I2CRSR until there is room."""
        if self.state.store(now, self._shift, self._n):
            self._rsr_waits = True

    def drr_read(self, now: int) -> None:
        """Copy a byte that waits in I2CRSR, and end a stretch of SCL, after the CPU has read I2CDRR."""
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
