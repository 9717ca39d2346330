"""The flags and FIFOs of the I2C module, and the interrupts I2CINT1A and I2CINT2A that they request.

    I2CSTR & I2CIER --> pending --event_to_isrc_delay, rank--> INTCODE, I2CINT1A --read of I2CISRC--> the next
    I2CFFTX, I2CFFRX --> FIFOs, which both FFEN and IRS enable --> TXFFINT, RXFFINT --enabled--> I2CINT2A

Source: SPRUG03B sections 3, 5.11, 5.12, Tables 3, 9, 10, 11, 21, 22.

Chosen:
- If a flag is cleared before the code of its request is loaded, the request is dropped.
- In FIFO mode XRDY = 1 if the TX FIFO has room. A received byte sets RRDY. A read of I2CDRR clears RRDY if the RX FIFO
  is then empty. RXFFRST = 0 and I2CFFEN do not change RRDY, so it can be 1 while the RX FIFO is empty.
- While a reset bit holds a FIFO empty, the interrupt flag of the FIFO is not set.
- Setting the enable bit of a FIFO interrupt while its flag is 1 requests the interrupt at once, even with FFEN = 0.
  Setting FFEN while flag and enable bit are 1 does not.
"""

# core: compiled

from __future__ import annotations

from ...core.chip import NEVER, Note
from ...core.state import State
from ..interrupt_fifo import DEPTH, InterruptFifo
from .options import I2cOptions
from .register_map import I2C_MAP, MDR_IRS, STR_AAS, STR_XRDY

SRC_AL, SRC_NACK, SRC_ARDY, SRC_RRDY, SRC_XRDY, SRC_SCD, SRC_AAS = (1 << n for n in range(7))
# For each code in I2CISRC, the flag that a read of I2CISRC with this code clears (Table 11).
CODE_CLEARS = {1: SRC_AL, 2: SRC_NACK, 6: SRC_SCD}
INT1, INT2 = 1, 2
FFEN = I2C_MAP["I2CFFTX"]["I2CFFEN"].mask


class I2cRequests:
    """Flags, interrupt arbiter, and FIFOs of both directions.

    str: I2CSTR.
    fifo: True in FIFO mode.
    requests: bit INT1 is set if I2CINT1A was requested since the owner last set this to 0; bit INT2, if I2CINT2A was.
    code: I2CISRC.INTCODE; 0 if there is none.
    code_at: the cycle at which a code is loaded into INTCODE, or NEVER.
    """

    STATE = State(
        "str ier isrc_high requests held wanted nack_as_slave code _pending _active mdr xsr_full fifo tx_fifo rx_fifo",
        cycles="code_at",
    )

    def __init__(self, options: I2cOptions) -> None:
        self.options = options
        self.notes: list[Note] = []
        self.touched: set[str] = set()
        self.tx_fifo = InterruptFifo(I2C_MAP["I2CFFTX"], False, options.fifo_int_mode, self.touched)
        self.rx_fifo = InterruptFifo(I2C_MAP["I2CFFRX"], True, options.fifo_int_mode, self.touched)

    def reset_requests(self) -> None:
        """Reset by XRS."""
        self.str: int = I2C_MAP["I2CSTR"].reset
        self.ier = self.isrc_high = self.requests = self.held = 0
        self.wanted = False  # True while a transmitter may need data; as slave with BCM = 0, only after an underflow
        self.nack_as_slave = False
        self.code = 0
        self.code_at = NEVER
        self._pending = 0  # requests whose code has not been loaded yet
        self._active = 0
        self.mdr = 0
        self.xsr_full = False
        self.fifo = False
        self.tx_fifo.reset()
        self.rx_fifo.reset()

    def duty(self, text: str, source: str) -> None:
        self.notes.append(Note("duty", text, source))

    # Flags -------------------------------------------------------------------

    def set(self, now: int, flags: int) -> None:
        self.str |= flags
        self.update(now)

    def clear(self, now: int, flags: int) -> None:
        self.str &= ~flags
        self.update(now)

    def sources(self) -> int:
        """Return the flags that request an interrupt, as bits in the order of I2CIER."""
        status = self.str
        active = (status & 0x3F | (SRC_AAS if status & STR_AAS else 0)) & self.ier
        if (
            active & SRC_XRDY
            and not self.wanted
            and self.options.xrdyint_when_idle.assume(self.touched) == "only_addressed"
        ):
            active &= ~SRC_XRDY
        if active & SRC_NACK and self.nack_as_slave and not self.options.nackint_in_slave_tx.assume(self.touched):
            active &= ~SRC_NACK
        return active

    def update(self, now: int) -> None:
        """Record new requests. Schedule the load of a code, unless an unread code must stay in INTCODE.

        Call this after any change of flags or enables.
        """
        if not self.ier and not self._active:
            return
        active = self.sources()
        rising = active & ~self._active
        self._active = active
        self._pending = (self._pending | rising) & active
        if (
            self.code
            and not active >> (self.code - 1) & 1
            and self.options.isrc_follows_flag.assume(self.touched) == "vanishes"
        ):
            self._show(now, 0)
        if self._pending and self.code_at == NEVER and (not self.code or self._outranks()):
            delay = self.options.event_to_isrc_delay.assume(self.touched)
            self.code_at = now + delay
            if not delay:
                self.load_code(now)

    def _outranks(self) -> bool:
        if self.options.isrc_preempt.assume(self.touched) != "highest":
            return False
        first = self._first()
        return first != self.code and self._rank(first) < self._rank(self.code)

    def _rank(self, code: int) -> int:
        """Return the sort key of a code; the code with the lowest key has the highest priority."""
        return code if self.options.int_priority.assume(self.touched) == "ascending" else -code

    def _first(self) -> int:
        """Return the code of the pending request with the highest priority; 0 if no request is pending."""
        codes = [bit + 1 for bit in range(7) if self._pending >> bit & 1]
        if len(codes) > 1:
            return min(codes, key=self._rank)
        return codes[0] if codes else 0

    def load_code(self, now: int) -> None:
        """Load INTCODE, if it is 0, with the pending request of the highest priority, and request I2CINT1A.

        With the option isrc_preempt, the new code may replace an unread one, without a request. Call this after the
        arbiter's delay (`code_at`).
        """
        self.code_at = NEVER
        code = self._first()
        if not code or (self.code and not self._outranks()):
            return
        if self.code:  # the replaced code was not read, so it is pending again
            self._pending |= 1 << (self.code - 1)
        else:
            self.requests |= INT1
        self._pending &= ~(1 << (code - 1))
        self._show(now, code)

    def _show(self, now: int, code: int) -> None:
        self.code = code
        if self.options.int_line.assume(self.touched) == "level":
            self.held = self.held & ~INT1 | (INT1 if code else 0)

    def read_isrc(self, now: int) -> int:
        code = self.code
        if code:
            self._show(now, 0)
            cleared = CODE_CLEARS.get(code, 0)
            if code == 7 and self.options.isrc_read_clears_aas.assume(self.touched):
                cleared = STR_AAS
            if cleared:
                self.clear(now, cleared)
            self.code_at = NEVER
            self.load_code(now)
        return code | self.isrc_high

    # FIFOs -------------------------------------------------------------------

    def fifo_levels(self, now: int) -> None:
        """Update the interrupt flags of the FIFOs, and XRDY in FIFO mode. Call after any change of a FIFO."""
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
