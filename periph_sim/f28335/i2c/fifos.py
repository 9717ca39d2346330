"""The FIFOs of the I2C module, with their requests on I2CINT2A.

    I2CFFTX, I2CFFRX --> FIFOs, which both FFEN and IRS enable --> TXFFINT, RXFFINT --enabled--> I2CINT2A

Source: SPRUG03B sections 5.11 and 5.12, Tables 21, 22.

Chosen:
- In FIFO mode XRDY = 1 if the TX FIFO has room, RRDY = 1 if the RX FIFO is not empty.
- A FIFO that a reset holds empty does not set its interrupt flag; the flag stays as it is.
- Setting an enable while its flag is set requests at once, even with FFEN = 0; setting FFEN does not request.
"""

# core: compiled

from __future__ import annotations

from ...core.state import State
from ..interrupt_fifo import DEPTH, InterruptFifo
from .interrupts import I2cInterrupts
from .options import I2cOptions
from .register_map import I2C_MAP, MDR_IRS, STR_XRDY

FFEN = I2C_MAP["I2CFFTX"]["I2CFFEN"].mask
INT2 = 2


class I2cFifos(I2cInterrupts):
    """FIFOs of both directions. fifo: both are on."""

    STATE = State("mdr xsr_full fifo tx_fifo rx_fifo")

    __slots__ = ("fifo", "mdr", "rx_fifo", "tx_fifo", "xsr_full")

    def __init__(self, options: I2cOptions) -> None:
        super().__init__(options)
        self.tx_fifo = InterruptFifo(I2C_MAP["I2CFFTX"], False, options.fifo_int_mode, self.touched)
        self.rx_fifo = InterruptFifo(I2C_MAP["I2CFFRX"], True, options.fifo_int_mode, self.touched)

    def reset_fifos(self) -> None:
        """Reset by XRS."""
        self.mdr = 0
        self.xsr_full = False
        self.fifo = False
        self.tx_fifo.reset()
        self.rx_fifo.reset()

    def fifo_levels(self, now: int) -> None:
        """Update the level flags and their requests. Call after any change of a FIFO."""
        on = self.fifo and self.mdr & MDR_IRS > 0
        if self.tx_fifo.watch(on and self.tx_fifo.is_released()):
            self.requests |= INT2
        if self.rx_fifo.watch(on and self.rx_fifo.is_released()):
            self.requests |= INT2
        if self.fifo:
            if len(self.tx_fifo) < DEPTH:
                self.str |= STR_XRDY
            else:
                self.str &= ~STR_XRDY
            self.update(now)

    def write_fftx(self, now: int, value: int) -> None:
        if self.tx_fifo.write(value):
            self.requests |= INT2
        self.fifo = self.tx_fifo.control & FFEN > 0
        if (
            self.xsr_full
            and not self.tx_fifo.is_released()
            and self.options.txfifo_reset_flushes_xsr.assume(self.touched)
        ):
            self.xsr_full = False
        self.fifo_levels(now)

    def write_ffrx(self, now: int, value: int) -> None:
        if self.rx_fifo.write(value):
            self.requests |= INT2
        self.fifo_levels(now)
