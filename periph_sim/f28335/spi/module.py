"""The SPI module as the CPU sees it: register accesses and resets. `lines` handles the pins.

Chosen, where the manual is silent:
- The module's clock is off after construction and after `reset`. LSPCLK keeps its last setting.
- SW RESET = 0 and SPIRST = 0 do not change SPIDAT, SPIRXBUF and SPITXBUF, but clear BUFFULL_FLAG: a waiting word is
  not sent. SPIRST = 0 does not change the other flags of SPISTS.
- Words written to the FIFO while SW RESET = 0 are sent after it becomes 1.
- A write of SPIDAT while a character is in progress replaces all its bits, received ones too, but not their count.
- A new character length, phase or polarity takes effect at once, a new rate from the next edge of SPICLK on.

Source: TI SPRUEU3 chapter 2; SPRUFB0D section 5.1 for the clock gate.
"""

from __future__ import annotations

from .lines import SpiLines
from .register_map import (
    CLK_PHASE,
    CLKPOLARITY,
    INT_FLAG,
    MASTER_SLAVE,
    OVERRUN_FLAG,
    OVERRUNINTENA,
    SPI_MAP,
    SPICHAR,
    SPIFFENA,
    SPIINTENA,
    SPILBK,
    SPIRST,
    SPISWRESET,
)

CCR, CTL, STS, BRR, RXEMU, RXBUF, TXBUF, DAT, FFTX, FFRX, FFCT, PRI = (register.offset for register in SPI_MAP)


class Spi(SpiLines):
    """The SPI. name: the module's name in notes. options: answers to open questions of the manual."""

    # CPU access -------------------------------------------------------------

    def read(self, now: int, offset: int) -> int:
        self._run(now)
        if self._gated and self._is_cut_off("read"):
            return 0
        if offset != RXBUF:
            return self._value(offset)
        word = self._rx.read()
        self._show(now)
        return word

    def peek(self, now: int, offset: int) -> int:
        self._run(now)
        return self._value(offset)

    def see(self, now: int, offset: int) -> int:
        if self._gated and self.options.clock_gate_access.assume(self.touched) == "reads_0":
            return 0
        return self.peek(now, offset)

    def write(self, now: int, offset: int, value: int) -> None:
        self._check_offset(offset)
        self._run(now)
        if self._gated and self._is_cut_off("written"):
            return
        if offset == CCR:
            self._write_ccr(value)
        elif offset == CTL:
            self._write_ctl(value)
        elif offset == STS:
            self._rx.status &= ~(value & OVERRUN_FLAG)
        elif offset == BRR:
            self._check_configuration(self._brr ^ value & 0x7F)
            self._brr = value & 0x7F
        elif offset == TXBUF:
            self._tx.write(value, self._enabled)
            self.loaded |= 1 << TXBUF
        elif offset == DAT:
            self._write_dat(now, value)
        elif offset == FFTX:
            self._write_fftx(value)
        elif offset == FFRX:
            self._rx.fifo.write_register(value)
        elif offset == FFCT:
            self._ffct = value & 0xFF
        elif offset == PRI:
            self._pri = SPI_MAP["SPIPRI"].write(self._pri, value)[0]
        self._fill(now)
        self._show(now)

    def _value(self, offset: int) -> int:
        self._check_offset(offset)
        if offset == STS:
            return self._rx.status | self._tx.show_status()
        if offset in (RXEMU, RXBUF):
            return self._rx.show()
        if offset == TXBUF:
            return self._tx.txbuf
        if offset == DAT:
            return self._shifter.dat
        if offset == FFTX:
            return self._tx.fifo.show()
        if offset == FFRX:
            return self._rx.fifo.show()
        plain = {CCR: self._ccr, CTL: self._ctl, BRR: self._brr, FFCT: self._ffct, PRI: self._pri}
        return plain.get(offset, 0)

    def _check_offset(self, offset: int) -> None:
        if not 0 <= offset <= 0xF:
            raise ValueError(f"{self.name} has offsets 0 to 0xF, not {offset:#x}")

    def _is_cut_off(self, what: str) -> bool:
        """Add a note about an access while the module has no clock. Return True if the access has no effect.

        what: "read" or "written".
        """
        self._note("duty", f"was {what} while its PCLKCR0 bit is 0; turn its clock on first", "SPRUFB0D §5.1.1")
        return self.options.clock_gate_access.assume(self.touched) == "reads_0"

    def _check_configuration(self, changed: int) -> None:
        if changed and self._ccr & SPISWRESET:
            self._note(
                "duty", "its configuration was changed while SPISWRESET = 1; clear SPISWRESET first", "SPRUEU3 §2.1.1"
            )

    def _write_ccr(self, value: int) -> None:
        before, self._ccr = self._ccr, SPI_MAP["SPICCR"].write(self._ccr, value)[0]
        if before & self._ccr & SPISWRESET:
            self._check_configuration((before ^ self._ccr) & (CLKPOLARITY | SPILBK | SPICHAR))
        self._shifter.length = (self._ccr & SPICHAR) + 1
        if not self._ccr & SPISWRESET:
            self._halt()
            self._rx.status = 0
            for fifo in (self._rx.fifo, self._tx.fifo):
                if fifo.words and self.options.swreset_clears_fifos.assume(self.touched):
                    fifo.clear()

    def _write_ctl(self, value: int) -> None:
        before, self._ctl = self._ctl, SPI_MAP["SPICTL"].write(self._ctl, value)[0]
        changed = before ^ self._ctl
        self._check_configuration(changed & (MASTER_SLAVE | CLK_PHASE))
        self._shifter.delayed = self._ctl & CLK_PHASE > 0
        if changed & MASTER_SLAVE:
            self._halt()
        self._rx.set_enables(
            (INT_FLAG if self._ctl & SPIINTENA else 0) | (OVERRUN_FLAG if self._ctl & OVERRUNINTENA else 0)
        )

    def _write_dat(self, now: int, value: int) -> None:
        if not self._enabled:
            self._shifter.dat = value
            self._tx.lost.append(f"SPIDAT was written {value:#06x} while a reset holds the SPI: it is not sent")
            return
        if self._shifter.busy:
            self._tx.lost.append(f"SPIDAT was written {value:#06x} while a character was in it: that one is lost")
        self._shifter.load(value)
        if self._is_master:
            self._begin(now)
        elif not self._shifter.bits:
            self._shifter.present()

    def _write_fftx(self, value: int) -> None:
        fifo = self._tx.fifo
        before = fifo.control
        fifo.write_register(value)
        if (before ^ value) & SPIRST:
            self._set_spirst(value & SPIRST > 0)
        fifo.turn(value & SPIFFENA > 0)
        self._rx.fifo.turn(value & SPIFFENA > 0)

    def _set_spirst(self, released: bool) -> None:
        if not released:
            self._halt()
        clears = self.options.spirst_clears_fifos.assume(self.touched)
        for fifo in (self._rx.fifo, self._tx.fifo):
            fifo.hold(clears and not released)
