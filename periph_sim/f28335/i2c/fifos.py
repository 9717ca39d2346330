"""The FIFOs of the I2C module, with their level flags and requests on I2CINT2A.

    I2CFFTX, I2CFFRX --> TXFFINT where TXFFST <= TXFFIL, RXFFINT where RXFFST >= RXFFIL --enabled--> I2CINT2A

Source: SPRUG03B sections 5.11 and 5.12, Tables 21, 22.

Chosen:
- In FIFO mode XRDY = 1 if the TX FIFO has room, RRDY = 1 if the RX FIFO is not empty.
"""

# core: compiled

from __future__ import annotations

from ...core.fifo import Fifo
from ...core.state import State
from .interrupts import I2cInterrupts
from .register_map import I2C_MAP, MDR_IRS, STR_XRDY

I2CFFTX, I2CFFRX = I2C_MAP["I2CFFTX"], I2C_MAP["I2CFFRX"]
FFEN = I2CFFTX["I2CFFEN"].mask
FFRST = I2CFFTX["TXFFRST"].mask  # the same places in I2CFFRX from here on
FFINT = I2CFFTX["TXFFINT"].mask
FFINTCLR = I2CFFTX["TXFFINTCLR"].mask
FFIENA = I2CFFTX["TXFFIENA"].mask
FFIL = I2CFFTX["TXFFIL"].mask

DEPTH = 16
INT2 = 2


class I2cFifos(I2cInterrupts):
    """FIFOs of both directions. fftx, ffrx: the stored bits of I2CFFTX and I2CFFRX."""

    STATE = State("mdr xsr_full fftx ffrx fifo tx_fifo rx_fifo _tx_was_low _rx_was_high")

    __slots__ = ("_rx_was_high", "_tx_was_low", "ffrx", "fftx", "fifo", "mdr", "rx_fifo", "tx_fifo", "xsr_full")

    def reset_fifos(self) -> None:
        """Reset by XRS."""
        self.mdr = 0
        self.xsr_full = False
        self.fftx = self.ffrx = 0
        self.fifo = False  # both FIFOs are on
        self.tx_fifo = Fifo(DEPTH)
        self.rx_fifo = Fifo(DEPTH)
        self._tx_was_low = self._rx_was_high = False

    def fifo_levels(self, now: int) -> None:
        """Update the level flags and their requests. Call after any change of a FIFO."""
        alive = self.fifo and self.mdr & MDR_IRS
        if alive and self.fftx & FFRST:
            low = len(self.tx_fifo) <= self.fftx & FFIL
            self.fftx = self._level_flag(self.fftx, low, self._tx_was_low)
            self._tx_was_low = low
        else:
            self._tx_was_low = False
        if alive and self.ffrx & FFRST:
            high = len(self.rx_fifo) >= self.ffrx & FFIL
            self.ffrx = self._level_flag(self.ffrx, high, self._rx_was_high)
            self._rx_was_high = high
        else:
            self._rx_was_high = False
        if self.fifo:
            if len(self.tx_fifo) < DEPTH:
                self.str |= STR_XRDY
            else:
                self.str &= ~STR_XRDY
            self.update(now)

    def _level_flag(self, register: int, condition: bool, before: bool) -> int:
        if not condition or register & FFINT:
            return register
        if not before or self.options.fifo_int_mode.assume(self.touched) == "level":
            register |= FFINT
            if register & FFIENA:
                self.requests |= INT2
        return register

    def write_fftx(self, now: int, value: int) -> None:
        before = self.fftx
        self.fftx, fired = I2CFFTX.write(before, value)
        self.fifo = bool(self.fftx & FFEN)
        if not self.fftx & FFRST:
            self.tx_fifo.clear()
            if self.xsr_full and self.options.txfifo_reset_flushes_xsr.assume(self.touched):
                self.xsr_full = False
        self._flag_written(fired, before, "tx")
        self.fifo_levels(now)

    def write_ffrx(self, now: int, value: int) -> None:
        before = self.ffrx
        self.ffrx, fired = I2CFFRX.write(before, value)
        if not self.ffrx & FFRST:
            self.rx_fifo.clear()
        self._flag_written(fired, before, "rx")
        self.fifo_levels(now)

    def _flag_written(self, fired: int, before: int, which: str) -> None:
        register = self.fftx if which == "tx" else self.ffrx
        if fired & FFINTCLR:
            register &= ~FFINT
        elif register & FFINT and register & FFIENA and not before & FFIENA:
            self.requests |= INT2
        if which == "tx":
            self.fftx = register
        else:
            self.ffrx = register
