"""Recognition of the module's own address: compares address bytes with I2COAR.

    7-bit     AAAAAAA r/w
    10-bit    11110AA w   AAAAAAAA   [Sr  11110AA r]

Source: SPRUG03B sections 2.5, 5.8, Table 10 (AAS, AD0).
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.state import State
from .register_map import MDR_XA
from .registers import I2cRegisters

GENERAL_CALL, START_BYTE = 0, 1
TEN_BIT = 0b11110


@final
class I2cAddress:
    """Recognizer of the own address.

    read: the last byte compared requests data from this module.
    selected: a 10-bit address has matched in full in this transfer.
    """

    STATE = State("read selected _latched")

    def __init__(self, state: I2cRegisters) -> None:
        self.read = False
        self.selected = False
        self._state = state
        self._latched = 0

    def latch(self) -> None:
        """Latch the present I2COAR, for the values of `oar_latch` other than "live"."""
        self._latched = self._state.oar

    def start(self) -> None:
        """Latch I2COAR if `oar_latch` does so at a START."""
        state = self._state
        if state.oar != self._latched and state.options.oar_latch.assume(state.touched) == "at_start":
            self.latch()

    def is_ours(self, byte: int, second: bool) -> bool:
        """Return True if the byte addresses this module; set `read`. second: the byte has the lower 8 of 10 bits."""
        state, options = self._state, self._state.options
        own = state.oar
        if own != self._latched and options.oar_latch.assume(state.touched) != "live":
            own = self._latched
        self.read = False
        if second:
            return byte == own & 0xFF
        if byte == GENERAL_CALL:
            return options.general_call.assume(state.touched) == "acknowledged"
        if byte == START_BYTE:
            self.read = True
            if own or state.mdr & MDR_XA:
                return False
            return options.oar_zero.assume(state.touched) == "own_address_too"
        self.read = bool(byte & 1)
        if state.mdr & MDR_XA:
            if byte >> 3 != TEN_BIT or byte >> 1 & 3 != own >> 8 & 3:
                return False
            return self.selected or not self.read
        return byte >> 1 == own & 0x7F

    def is_answered_by_master(self, byte: int, second: bool) -> bool:
        """Return True if the module acknowledges this byte as the master that sent it: only ever a general call."""
        if byte != GENERAL_CALL or second:
            return False
        self.read = False
        return self._state.options.own_general_call.assume(self._state.touched) == "answered"

    def is_whole(self, byte: int, second: bool) -> bool:
        """Return False for the first byte of a 10-bit address, which does not set flags yet."""
        return not self._state.mdr & MDR_XA or second or self.read or byte == GENERAL_CALL
