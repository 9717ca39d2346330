"""The SCI module as the CPU sees it: register accesses and resets, with their effects on receiver and transmitter.

    registers --> Sci --> SciRx, SciTx, SciAutobaud and their clocks (`lines`) <--> RXD, TXD, RXINT, TXINT

Chosen, where the manual is silent:
- The module's clock is off after construction and after `reset`. LSPCLK keeps its last setting.
- SCIRST = 0 stops receiver and transmitter in standard mode, too. It does not change SCIRXST.
- CDC must be written 0 before ABD requests TXINT again.

Source: TI SPRUFZ5A; SPRUFB0D section 5.1 for the clock gate.
"""

# core: compiled

from __future__ import annotations

from .character_format import SciFormat
from .lines import RXINT, SciLines
from .register_map import (
    ABD,
    ABDCLR,
    CDC,
    FFTXDLY,
    FREE,
    LOOPBKENA,
    RXBKINTENA,
    RXENA,
    RXERRINTENA,
    SCI_MAP,
    SCIFFENA,
    SCIRST,
    SLEEP,
    SOFT,
    SWRESET,
    TXENA,
    TXINTENA,
    TXWAKE,
)

SCIFFCT = SCI_MAP["SCIFFCT"]

# Word offsets of the registers, as in SCI_MAP.
CCR, CTL1, HBAUD, LBAUD, CTL2, RXST, RXEMU, RXBUF = range(8)
TXBUF, FFTX, FFRX, FFCT, PRI = 0x9, 0xA, 0xB, 0xC, 0xF

AUTOBAUD_LEAST_BIT = 300  # minimum cycles of a bit: 500 kbit/s at SYSCLKOUT = 150 MHz


class Sci(SciLines):
    """The SCI. name: the module's name in notes. options: answers to open questions of the manual."""

    mid_byte: tuple[int, ...] = (CCR, CTL1, HBAUD, LBAUD, FFTX, FFCT, PRI)

    @property
    def frames_sent(self) -> int:
        """Number of frames whose start bits have begun on TXD. Resets do not clear this number."""
        return self._tx.frames

    @property
    def framing_errors(self) -> int:
        """Number of characters that ended with RXENA = 1 and a first stop bit of 0. Resets do not clear this number."""
        return self._rx.framing_errors

    @property
    def parity_errors(self) -> int:
        """Number of characters that ended with RXENA = 1 and a wrong parity bit. Resets do not clear this number."""
        return self._rx.parity_errors

    @property
    def characters_lost(self) -> int:
        """Number of characters lost by an overrun of the FIFO or of SCIRXBUF. Resets do not clear this number."""
        return self._rx.lost

    # CPU access -------------------------------------------------------------

    def read(self, now: int, offset: int) -> int:
        if now >= self.next_wake:
            self._run(now)
        if self._gated and self._no_clock("read"):
            return 0
        if offset == RXBUF:
            return self._read_rxbuf(now)
        return self._show(now, offset)

    def peek(self, now: int, offset: int) -> int:
        if now >= self.next_wake:
            self._run(now)
        return self._show(now, offset)

    def see(self, now: int, offset: int) -> int:
        if self._gated and self.options.clock_gate_access.assume(self.touched) == "reads_0":
            return 0
        return self.peek(now, offset)

    def write(self, now: int, offset: int, value: int) -> None:
        if now >= self.next_wake:
            self._run(now)
        if self._gated and self._no_clock("written"):
            return
        if offset == TXBUF:
            self._tx.write_buffer(now, value)
            self.loaded |= 1 << TXBUF
        elif offset == FFTX:
            self._write_fftx(now, value)
        elif offset == FFRX:
            self._rx.write_fifo(value)
        elif offset == CCR:
            self._write_ccr(now, value)
        elif offset == CTL1:
            self._write_ctl1(now, value)
        elif offset == HBAUD:
            self._set_brr(now, (value & 0xFF) << 8 | self._rx_clock.brr & 0xFF)
        elif offset == LBAUD:
            self._set_brr(now, self._rx_clock.brr & 0xFF00 | value & 0xFF)
        elif offset == CTL2:
            self._rx.set_enables(bool(value & RXBKINTENA), bool(self._ctl1 & RXERRINTENA))
            self._tx.set_int_enabled(bool(value & TXINTENA))
        elif offset == FFCT:
            self._write_ffct(now, value)
        elif offset == PRI:
            self._pri = value & (SOFT | FREE)
        self._after_write(now)

    def _read_rxbuf(self, now: int) -> int:
        rx = self._rx
        word = rx.read_buffer()
        self._load_received()
        if rx.request:
            rx.request = False
            self.requests |= RXINT
        self._watch_idle(now)
        if self._rx_at < self.next_wake:
            self._schedule()
        return word

    def _show(self, now: int, offset: int) -> int:
        rx, tx = self._rx, self._tx
        if offset == RXST:
            return rx.show_status()
        if offset == FFRX:
            return rx.fifo.show()
        if offset == RXBUF:
            return rx.show_buffer()
        if offset == RXEMU:
            return rx.show_buffer() & 0xFF
        if offset == CTL2:
            enables = (RXBKINTENA if rx.bk_enabled else 0) | (TXINTENA if tx.int_enabled else 0)
            return tx.show_flags(now) | enables
        if offset == FFTX:
            return tx.fifo.show()
        if offset == TXBUF:
            return tx.txbuf
        if offset == CTL1:
            return self._ctl1 | (TXWAKE if tx.txwake else 0)
        if offset == CCR:
            return self._ccr
        if offset == HBAUD:
            return self._rx_clock.brr >> 8
        if offset == LBAUD:
            return self._rx_clock.brr & 0xFF
        if offset == FFCT:
            return self._ffct
        return self._pri if offset == PRI else 0

    def _no_clock(self, what: str) -> bool:
        """Add a note about an access while the module has no clock. Return True if the access has no effect.

        what: "read" or "written".
        """
        self._note("duty", f"was {what} while its PCLKCR0 bit is 0; turn its clock on first", "SPRUFB0D §5.1.1")
        return self.options.clock_gate_access.assume(self.touched) == "reads_0"

    def _write_ccr(self, now: int, value: int) -> None:
        before = self._ccr
        self._ccr = value & 0xFF
        self._layout = SciFormat(self._ccr, self.options)
        self._rx.parity = self._layout.parity
        tick = self._rx_clock.passed(now)
        self._bits.settle(tick)
        under_way = self._bits.framed or self._tx.active
        at_once = under_way and self.options.format_write_effect.assume(self.touched) == "at_once"
        self._bits.set_layout(tick, self._layout, at_once)
        self._tx.set_layout(now, self._layout, at_once)
        if (before ^ self._ccr) & LOOPBKENA:
            looped = self._ccr & LOOPBKENA
            self._line(now, self.out if looped else self._rxd)

    def _write_ctl1(self, now: int, value: int) -> None:
        before = self._ctl1
        self._ctl1 = value & (RXERRINTENA | SWRESET | SLEEP | TXENA | RXENA)
        rx, tx = self._rx, self._tx
        rx.enabled = bool(value & RXENA)
        rx.sleep = bool(value & SLEEP)
        rx.set_enables(rx.bk_enabled, bool(value & RXERRINTENA))
        if value & TXWAKE:
            tx.txwake = True
        tx.set_enabled(now, bool(value & TXENA))
        if (before ^ value) & SWRESET:
            tx.in_swreset = not value & SWRESET
            if tx.in_swreset:
                tx.halt()
                rx.status = 0
                used = tx.fifo_mode or rx.fifo.words or tx.fifo.words
                if used and self.options.swreset_fifo_effect.assume(self.touched) == "cleared":
                    rx.clear_fifo()
                    tx.clear_fifo()
            self._set_running(now)

    def _write_fftx(self, now: int, value: int) -> None:
        tx = self._tx
        before = tx.fifo.control
        tx.write_fifo(now, value)
        self._rx.set_fifo_mode(bool(tx.fifo.control & SCIFFENA))
        if (before ^ value) & SCIRST:
            if not value & SCIRST:
                tx.halt()
                if self.options.scirst_scope.assume(self.touched) == "shifters_and_fifos":
                    self._rx.clear_fifo()
                    tx.clear_fifo()
            self._set_running(now)

    def _set_running(self, now: int) -> None:
        """Release the transmitter if SW RESET and SCIRST are both 1, and start or stop the receiver accordingly."""
        if self._ctl1 & SWRESET and self._tx.fifo.control & SCIRST:
            self._tx.release(now)
        self._arm_receiver(now)

    def _write_ffct(self, now: int, value: int) -> None:
        before = self._ffct
        self._ffct, strobes = SCIFFCT.write(before, value)
        if strobes & ABDCLR:
            self._ffct &= ~ABD
        if not self._ffct & CDC:
            self._abd_requested = False
        elif not before & CDC and self._rx_clock.brr != 1 and 8 * self._rx_clock.period < AUTOBAUD_LEAST_BIT:
            self._note(
                "duty",
                f"CDC was set with BRR = {self._rx_clock.brr}, over 500 kbit/s; expected 1 or a slower rate",
                "SPRUFZ5A §1.2.10.3",
            )
        self._tx.delay = self._ffct & FFTXDLY
        self._tx.replan(now)
        self._arm_receiver(now)
