"""The I2C module as slave: responds to START, STOP and the edges of SCL, and sets flags.

    OFF --START--> ADDRESS --match--> RECEIVE or TRANSMIT --STOP--> OFF
                      +--no match, NACK of address, or NACK received--> IGNORE --START or STOP-->

    7-bit     AAAAAAA r/w
    10-bit    11110AA w   AAAAAAAA   [Sr  11110AA r]

A byte has n bits: 8 in an address, BC (0: 8) in data. `bit` counts the rises of SCL in the present byte. "Rise 8" and
"fall 8" are the edges of the byte's n-th SCL pulse, "rise 9" and "fall 9" those of the pulse of the acknowledge bit.

Source: SPRUG03B sections 2, 3 and 5.8, Table 1, Table 10, Figure 17.

Chosen:
- A slave that has sent a NACK for a data byte continues to receive until the next START or STOP.
- At the fall of SCL that ends a NACK, NACKSNT is set, and NACKMOD is cleared if it was 1 at rise 8.
- With BCM = 1 and dxr_to_xsr_copy_point = eager_reloaded_at_address, fall 8 of a matching read address reloads I2CXSR.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER
from .register_map import (
    MDR_FDF,
    MDR_MST,
    MDR_NACKMOD,
    MDR_TRX,
    MDR_XA,
    SCL,
    SDA,
    STR_AAS,
    STR_AD0,
    STR_BB,
    STR_NACKSNT,
    STR_SCD,
    STR_SDIR,
    STR_XRDY,
)
from .slave_data import ADDRESS, ADDRESS_LOW, IGNORE, LISTENS, OFF, RECEIVE, TRANSMIT, I2cSlaveData

GENERAL_CALL, START_BYTE = 0, 1
TEN_BIT = 0b11110
MANY = 1 << 30  # result of `silent_edges` if the transfer is for other devices, so that no edge of SCL has an effect


@final
class I2cSlave(I2cSlaveData):
    """Slave side of the module.

    pulls: mask of the lines that the slave holds low.
    due: the cycle of the next call of `timer`, or NEVER.
    """

    def follows(self) -> bool:
        """Return True if this transfer is, or may be, for this module."""
        return self.phase >= LISTENS

    def silent_edges(self, high: bool) -> int:
        """Return how many of the next SCL edges do no more than shift a bit. high: True if SCL is high now."""
        phase, bit, n = self.phase, self.bit, self._n
        if phase < LISTENS:
            return MANY
        if self.pulls & SCL or bit > n:
            return 0
        if bit == n:
            return 0 if high else self._silent_answer()
        loud = n  # number of SCL rises in this byte before the first fall that has an effect
        if phase == TRANSMIT:
            if not self._shifting or (high and not bit):
                return 0
            last = 0 if self.pulls & SDA else 1
            loud = bit if high else bit + 1
            while loud < n and self.state.xsr >> (n - 1 - loud) & 1 == last:
                loud += 1
        edges = 2 * (loud - bit) - (not high)
        address = phase != RECEIVE and phase != TRANSMIT
        return edges - 1 if address and self.state.options.aas_sdir_point.unrecorded() == "rise8" else edges

    def _silent_answer(self) -> int:
        """Return 1 if rise 9, which is the next edge of SCL, has no effect; else 0."""
        options = self.state.options
        if self.phase == TRANSMIT:
            return 0
        if not self._ack:
            return 1
        if self.phase == RECEIVE:
            return int(options.rrdy_point.unrecorded() != "rise9")
        return int(not self._read or options.dxr_to_xsr_copy_point.unrecorded() != "ack_rise9")

    # Skipped bits (see `bus.i2c.bit_skip`) -----------------------------------------------

    def waits_for_byte(self) -> bool:
        """Return True before the first bit of a byte of eight bits, if the slave waits for nothing but edges of SCL."""
        if self.bit or self._n != 8 or self.due != NEVER or self.pulls & SCL:
            return False
        return self.phase != TRANSMIT or self._shifting

    def is_not_addressed(self) -> bool:
        """Return False while the slave transfers data bytes or expects the second byte of its address, else True."""
        return self.phase in (ADDRESS, IGNORE, OFF)

    def byte(self) -> int:
        """Return the byte that is shifted out; 0xFF if the module does not transmit."""
        return self.state.xsr & 0xFF if self.phase == TRANSMIT else 0xFF

    def set_bit_position(self, shown: int, bit: int) -> None:
        """Set the state that the slave has after `bit` bits, 0 or 7, of the byte `shown` have passed on the bus."""
        if self.phase == TRANSMIT:
            self.bit = bit
            self._drive(self.state.xsr >> (7 - bit) & 1)
        elif self.phase >= LISTENS:
            self.bit = bit
            self._shift = shown >> (8 - bit)

    # Line events --------------------------------------------------------------------

    def start(self, now: int) -> None:
        state = self.state
        self._release_lines()
        flags = STR_AD0
        if state.str & STR_SDIR and state.options.sdir_clear.assume(state.touched) == "any_start_or_stop":
            flags |= STR_SDIR
        if not state.mdr & MDR_XA:
            flags |= STR_AAS
        state.str &= ~flags
        state.wanted = False
        state.set(now, STR_BB)
        if state.oar != self._latched and state.options.oar_latch.assume(state.touched) == "at_start":
            self._latched = state.oar
        self.bit = self._shift = self._sent = 0
        self._n = 8
        self._nack_armed = False
        self.phase = ADDRESS
        self._first_byte = True
        if state.mdr & MDR_FDF and not state.mdr & MDR_MST:
            self.own_transfer = True
            self._n = state.bits()
            self.phase = TRANSMIT if state.mdr & MDR_TRX else RECEIVE

    def stop(self, now: int) -> None:
        state, options = self.state, self.state.options
        self._release_lines()
        if self.own_transfer or options.scd_foreign.assume(state.touched) == "every_stop":
            state.str |= STR_SCD
        flags = STR_BB | STR_AD0 | STR_AAS
        if state.str & STR_SDIR and options.sdir_clear.assume(state.touched) == "any_start_or_stop":
            flags |= STR_SDIR
        state.wanted = False
        state.clear(now, flags)
        self.phase = OFF
        self.own_transfer = self._selected = False

    def rise(self, now: int, sda: int) -> None:
        phase = self.phase
        if phase < LISTENS:
            return
        self.bit = bit = self.bit + 1
        n = self._n
        if bit <= n:
            if phase != TRANSMIT:
                self._shift = self._shift << 1 | sda
                if bit == n:  # rise 8, at which NACKMOD is sampled
                    self._nack_armed = bool(self.state.mdr & MDR_NACKMOD)
                    # With aas_sdir_point = "rise8" the address is compared here. The use of the option is recorded at
                    # fall 8.
                    compared = phase != RECEIVE and self.state.options.aas_sdir_point.unrecorded() == "rise8"
                    if compared and not self.muted and self._is_ours():
                        self._address_flags(now)
        elif phase == TRANSMIT:
            self._answered(now, sda)
        elif self._ack:
            if phase == RECEIVE and not self._rsr_waits and self.state.rrdy_rises_at("rise9"):
                self._store_byte(now)
            if self._read and phase == ADDRESS:
                self._copy_at_rise9(now)

    def fall(self, now: int) -> None:
        phase = self.phase
        if phase < LISTENS:
            return
        bit, n = self.bit, self._n
        if bit < n:
            if phase == TRANSMIT:
                if bit == 0 and self._first_byte:
                    self._begin_byte(now, first=True)
                else:
                    self._drive(self.state.xsr >> (n - 1 - bit) & 1)
        elif bit == n:
            if phase == TRANSMIT:
                self._drive(1)
                self._shifting = False
                self._eager(now)
            elif phase == RECEIVE:
                self._data_complete(now)
            else:
                self._address_complete(now)
        else:
            self._slot_ends(now)

    # Address ------------------------------------------------------------------------

    def _is_ours(self) -> bool:
        """Return True if the received byte addresses this module. Also update `_read`, the R/W bit of the byte."""
        state, options = self.state, self.state.options
        byte, second = self._shift & 0xFF, self.phase == ADDRESS_LOW
        if self.muted:  # as the master, the module itself sent this byte
            if byte != GENERAL_CALL or second:
                return False
            self._read = False
            return options.own_general_call.assume(state.touched) == "answered"
        own = state.oar
        if own != self._latched and options.oar_latch.assume(state.touched) != "live":
            own = self._latched
        self._read = False
        if second:
            return byte == own & 0xFF
        if byte == GENERAL_CALL:
            return options.general_call.assume(state.touched) == "acknowledged"
        if byte == START_BYTE:
            self._read = True
            if own or state.mdr & MDR_XA:
                return False
            return options.oar_zero.assume(state.touched) == "own_address_too"
        self._read = bool(byte & 1)
        if state.mdr & MDR_XA:
            if byte >> 3 != TEN_BIT or byte >> 1 & 3 != own >> 8 & 3:
                return False
            return self._selected or not self._read
        return byte >> 1 == own & 0x7F

    def _address_complete(self, now: int) -> None:
        state, options = self.state, self.state.options
        self._ack = self._is_ours()
        if not self._ack:
            start_byte = self._shift & 0xFF == START_BYTE and not self.muted
            if start_byte and options.start_byte_ad0.assume(state.touched) == "set":
                state.str |= STR_AD0
            if state.mdr & MDR_XA:
                state.clear(now, STR_AAS)
                self._selected = False
            if state.str & STR_SDIR and options.sdir_clear.assume(state.touched) == "until_next_address":
                state.str &= ~STR_SDIR
            self.phase = IGNORE
            return
        if self._nack_armed and options.nackmod_on_address.assume(state.touched) == "address_too":
            self._ack = False
        self.own_transfer = True
        if self._read and state.tx_ready():
            if options.stale_byte_next_read.assume(state.touched) == "discarded":
                state.dxr_full = False
                state.set(now, STR_XRDY)
            if state.bcm and self._copies_at("eager_reloaded_at_address"):
                state.copy_to_xsr(now)
        if options.aas_sdir_point.assume(state.touched) == "fall8":
            self._address_flags(now)
        if self._ack:
            self.pulls |= SDA

    def _address_flags(self, now: int) -> None:
        state = self.state
        whole = self.phase == ADDRESS_LOW or self._read or self._shift & 0xFF == GENERAL_CALL
        if state.mdr & MDR_XA and not whole:  # only the first byte of a 10-bit address has arrived
            return
        flags = STR_AAS
        if self._read:
            flags |= STR_SDIR
            state.wanted = state.bcm_at_address() == 1
        elif state.str & STR_SDIR and state.options.sdir_clear.assume(state.touched) == "until_next_address":
            state.str &= ~STR_SDIR
        if self._shift & 0xFF == 0 and self.phase == ADDRESS:
            flags |= STR_AD0
        state.set(now, flags)

    # The acknowledge slot -----------------------------------------------------------

    def _slot_ends(self, now: int) -> None:
        state = self.state
        phase = self.phase
        self.pulls &= ~SDA
        if phase == TRANSMIT:
            self._begin_byte(now, first=False)
            return
        if not self._ack:
            if self._nack_armed:
                state.mdr &= ~MDR_NACKMOD
            state.set(now, STR_NACKSNT)
        elif phase in (ADDRESS, ADDRESS_LOW) and state.options.aas_sdir_point.assume(state.touched) == "fall9":
            self._address_flags(now)
        if phase == RECEIVE:
            self._data_slot_ends(now)
        if self._ack and not self._read and state.bcm and state.tx_ready() and self._copies_at("any_ack_fall9"):
            state.copy_to_xsr(now)
        self._next_byte(now)

    def _next_byte(self, now: int) -> None:
        state = self.state
        phase, low = self.phase, self.phase == ADDRESS_LOW
        self.bit = 0
        self._nack_armed = False
        self._first_byte = False
        if phase in (ADDRESS, ADDRESS_LOW) and not self._ack:
            self.phase = IGNORE
        elif phase == ADDRESS and state.mdr & MDR_XA and not self._read and self._shift & 0xFF:
            self.phase = ADDRESS_LOW
        elif phase in (ADDRESS, ADDRESS_LOW) and self._read:
            self.phase = TRANSMIT
            self._begin_byte(now, first=True)
        elif phase in (ADDRESS, ADDRESS_LOW):
            self._selected = self._selected or low
            self.phase = RECEIVE
        self._n = 8 if self.phase == ADDRESS_LOW else state.bits()
        if self.phase != TRANSMIT and self._n == 8:
            self._shift = 0

    def release_bus(self) -> None:
        """End a stretch of SCL, because IRS = 1 was written again and `irs_write1_releases_bus` is True."""
        self.pulls &= ~SCL
        self._waits_for_data = self._waits_for_room = False
        self._copy_at = self._release_at = self.due = NEVER
