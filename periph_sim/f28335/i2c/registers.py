"""The CPU's side of the I2C module: registers, and the data path between them and the bit engines.

    I2CDXR or TX FIFO --> I2CXSR --> the bit engines        bit engines --> I2CRSR --> I2CDRR or RX FIFO
    flags and I2CIER --> arbiter --> I2CISRC, I2CINT1A      FIFO levels --> I2CINT2A

The base class in `requests` has the flags, interrupts and FIFOs. The bit engines `slave` and `master` process SCL and
SDA bit by bit. They call the methods of `I2cRegisters`, so that this class does not depend on edges of SCL and SDA.

Source: SPRUG03B sections 4 (reset), 5.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER, Note
from ...core.state import State
from ...form.c_types import Text
from ..interrupt_fifo import DEPTH, FLAG
from . import register_map as i2c_map
from .options import I2cOptions
from .register_map import (
    I2C_MAP,
    MDR_BC,
    MDR_IRS,
    MDR_NACKMOD,
    MDR_STP,
    MDR_STT,
    STR_NACK,
    STR_RRDY,
    STR_RSFULL,
    STR_XRDY,
    STR_XSMT,
)
from .requests import I2cRequests

COMMANDS = MDR_STT | MDR_STP | MDR_NACKMOD

RECEIVED, SENDING = 1 << i2c_map.DRR, 1 << i2c_map.DXR  # bits of `loaded`: I2CDRR or I2CDXR got a byte


@final
class I2cRegisters(I2cRequests):
    """Registers, flags and data path of the module, without the state of SCL and SDA. Times are SYSCLKOUT cycles."""

    STATE = State(
        "bcm clkh clkl cnt drr drr_unread dxr dxr_behind dxr_full emdr_written filter_width loaded "
        "nack_of oar psc rsr sar tm xsr",
        cycles="nack_since",
        results="nack_of nack_since",
    )

    def __init__(self, options: I2cOptions) -> None:
        super().__init__(options)
        self.loaded = 0  # RECEIVED and SENDING, or 0; `I2cLines` moves these bits to its attribute `Chip.loaded`
        self.reset()

    def reset(self) -> None:
        """Reset by XRS."""
        self.reset_requests()
        self.oar = self.clkl = self.clkh = self.cnt = self.psc = 0
        self.sar: int = I2C_MAP["I2CSAR"].reset
        self.bcm = self.options.bcm_reset.unrecorded() if self.options.emdr_present.unrecorded() else 1
        self.emdr_written = False
        self.tm = 1  # period of the module clock in cycles, as latched when IRS last became 1
        self.filter_width: int = self.options.noise_filter_cycles.unrecorded()  # width of the noise filter in cycles
        self.dxr = self.xsr = self.drr = self.rsr = 0
        self.dxr_full = self.drr_unread = False
        self.nack_since = 0  # while I2CSTR.NACK = 1: the cycle at which it was set
        self.nack_of: str = ""  # description of the byte that was refused at `nack_since`
        self.dxr_behind: list[int] = []  # bytes queued after a full I2CDXR (dxr_write_while_full)

    def irs_reset(self, now: int) -> None:
        """Set I2CSTR to its reset value and drop requests because IRS becomes 0. Options decide what is kept."""
        busy = self.str & i2c_map.STR_BB
        if busy and self.options.bb_on_irs_reset.assume(self.touched) == "clear":
            busy = 0
        full = self.dxr_full or self.xsr_full
        if full and self.options.dxr_survives_irs.assume(self.touched) != "kept_and_still_sent":
            self.dxr_full = False
            self.dxr_behind.clear()
        self.xsr_full = False
        self.wanted = False
        self.str = i2c_map.STR_RESET | busy
        if self.code and self.options.irs_clears_isrc.assume(self.touched):
            self._show(now, 0)
        self.code_at = NEVER
        self._pending = self._active = 0  # all requests are dropped
        self.drr_unread = False
        if self.mdr & COMMANDS and self.options.irs_clears_commands.assume(self.touched):
            self.mdr &= ~COMMANDS
        if (self.tx_fifo or self.rx_fifo) and self.options.irs_clears_fifo.assume(self.touched):
            self.tx_fifo.words.clear()
            self.rx_fifo.words.clear()

    # Data path, sending --------------------------------------------------------

    def tx_ready(self) -> bool:
        """Return True if a byte waits in I2CDXR or, in FIFO mode, in I2CDXR or the TX FIFO."""
        return bool(self.tx_fifo) or self.dxr_full if self.fifo else self.dxr_full

    def write_dxr(self, now: int, value: int) -> None:
        value &= 0xFF
        if self.fifo:
            if not self.tx_fifo.is_released():
                self.notes.append(
                    Note(
                        "lost",
                        "a byte was written to I2CDXR while TXFFRST = 0 holds the TX FIFO empty",
                        "SPRUG03B Table 21",
                    )
                )
            elif self._extra_stage() and not self.dxr_full:
                self.dxr, self.dxr_full = value, True
                self.loaded |= SENDING
            elif not self.tx_fifo.push(value):
                self.notes.append(Note("lost", "a byte was written to a full TX FIFO", "SPRUG03B section 5.12"))
            self.fifo_levels(now)
            self.set(now, STR_XSMT)
            return
        if self.dxr_full:
            policy = self.options.dxr_write_while_full.assume(self.touched)
            if policy == "ignored":
                return
            if policy == "queued_behind_xsr":
                self.dxr_behind.append(value)
                return
        self.dxr, self.dxr_full = value, True
        self.loaded |= SENDING
        self.str = self.str & ~STR_XRDY | STR_XSMT
        self.update(now)

    def _extra_stage(self) -> bool:
        return self.options.fifo_extra_stage.assume(self.touched) == "dxr_drr_behind"

    def copy_to_xsr(self, now: int, xrdy: bool = True) -> bool:
        """Copy I2CDXR, or the oldest byte in the TX FIFO, to I2CXSR. Return False if there is no byte.

        xrdy: True to set XRDY if the copy empties I2CDXR. It has no effect in FIFO mode.
        """
        if self.fifo:
            if self._extra_stage():
                if not self.dxr_full:
                    return False
                self.xsr = self.dxr
                self.dxr_full = bool(self.tx_fifo)
                if self.tx_fifo:
                    self.dxr = self.tx_fifo.pop()
                    self.loaded |= SENDING
            elif self.tx_fifo:
                self.xsr = self.tx_fifo.pop()
            else:
                return False
            self.xsr_full = True
            self.fifo_levels(now)
            return True
        if not self.dxr_full:
            return False
        self.xsr, self.xsr_full = self.dxr, True
        if self.dxr_behind:
            self.dxr = self.dxr_behind.pop(0)
            self.loaded |= SENDING
            return True
        self.dxr_full = False
        if xrdy:
            self.set(now, STR_XRDY)
        return True

    # Data path, receiving --------------------------------------------------------

    def rx_blocked(self) -> bool:
        """Return True if there is no room for another received byte."""
        if self.fifo:
            room = DEPTH + (1 if self._extra_stage() else 0)
            return self.rx_fifo.is_released() and len(self.rx_fifo) >= room
        return self.drr_unread

    def rrdy_rises_at(self, edge: str) -> bool:
        """Return True if a received byte is copied to I2CDRR at this edge: "fall8", "rise9" or "fall9"."""
        return self.options.rrdy_point.assume(self.touched) == edge

    def store(self, now: int, shifted: int, bits: int) -> bool:
        """Copy a received byte of `bits` bits to I2CDRR or to the RX FIFO.

        If there is no room for it, keep the byte in I2CRSR and return True.
        """
        value = shifted & 0xFF
        if bits < 8 and self.options.bc_less_than_8_upper_bits.assume(self.touched) == "zeros":
            value = shifted & (1 << bits) - 1
        if not self.rx_blocked():
            self.received(now, value)
            return False
        self.rsr = value
        self.set(now, STR_RSFULL)
        return True

    def received(self, now: int, value: int) -> None:
        """Store a received byte in I2CDRR or the RX FIFO. A FIFO that is held in reset drops the byte."""
        if self.fifo:
            if self.rx_fifo.is_released():
                if not self.rx_fifo:
                    self.loaded |= RECEIVED
                self.rx_fifo.words.append(value)
                self.fifo_levels(now)
                self.set(now, STR_RRDY)
            return
        self.drr = value
        self.loaded |= RECEIVED
        self.drr_unread = True
        self.set(now, STR_RRDY)

    def read_drr(self, now: int) -> int:
        if self.fifo and self.rx_fifo:
            self.drr = self.rx_fifo.pop()
            if self.rx_fifo:
                self.loaded |= RECEIVED
            else:
                self.str &= ~STR_RRDY
            self.fifo_levels(now)
        else:
            self.drr_unread = False
            self.str &= ~STR_RRDY
        self.update(now)
        return self.drr

    # Settings ------------------------------------------------------------------------

    def write_emdr(self, value: int) -> None:
        if self.options.emdr_present.assume(self.touched):
            self.bcm = value & 1
            self.emdr_written = True
            if value & ~1:
                self.duty("I2CEMDR bits 15 to 1 were not written 0", "SPRUG03B Table 8")

    def emdr(self) -> int:
        """Return the value of I2CEMDR; 0 if the F28335 has no such register (option `emdr_present`)."""
        if not self.options.emdr_present.assume(self.touched):
            return 0
        return self.bcm if self.emdr_written else self.options.bcm_reset.assume(self.touched)

    def bcm_at_address(self) -> int:
        """Return the value of BCM that applies to a transfer.

        This is the value last written to I2CEMDR, or its reset value before the first write. If the F28335 has no
        I2CEMDR (option `emdr_present`), it is 1.
        """
        if not self.emdr_written and not self.options.bcm_reset.assume(self.touched):
            return 0 if self.options.emdr_present.assume(self.touched) else 1
        return self.bcm

    def write_psc(self, value: int) -> None:
        if self.mdr & MDR_IRS:
            self.duty(
                "I2CPSC was written with IRS = 1, where it has no effect; write it while IRS = 0", "SPRUG03B §1.4"
            )
            if self.options.psc_write_irs1.assume(self.touched) == "dropped":
                return
        self.psc = value

    # Queries of the bit engines and the module ------------------------------------------

    def stored(self, offset: int) -> int:
        """Return the value of a register that only stores its value; 0 at an offset without such a register."""
        if offset == i2c_map.CNT:
            return self.cnt
        if offset == i2c_map.DXR:
            return self.dxr
        if offset == i2c_map.OAR:
            return self.oar
        if offset == i2c_map.IER:
            return self.ier
        if offset == i2c_map.CLKL:
            return self.clkl
        if offset == i2c_map.CLKH:
            return self.clkh
        if offset == i2c_map.SAR:
            return self.sar
        return self.psc if offset == i2c_map.PSC else 0

    def readable(self) -> int:
        """Return a number of 63 bits that changes if an edge or timer changes anything that the CPU can read."""
        registers = self.dxr << 44 | self.code << 40 | self.drr << 32 | self.mdr << 16 | self.str
        if not self.fifo:
            return registers
        levels: int = len(self.rx_fifo) << 5 | len(self.tx_fifo)
        return (self.rx_fifo.control & FLAG) << 55 | levels << 52 | (self.tx_fifo.control & FLAG) << 36 | registers

    def bits(self) -> int:
        """Return the number of bits of the next data byte."""
        return self.mdr & MDR_BC or 8

    def setup(self) -> int:
        """Return the setup time of SDA, in cycles, before SCL is released after it was held low. It is at least 1."""
        return max(1, self.options.sda_setup_before_scl_release.assume(self.touched) * self.tm)

    def nack_received(self, now: int, as_slave: bool, refused: Text) -> None:
        """Set NACK. as_slave: True if this module sent the byte as a slave.

        refused: description of the refused byte; "" if NACK is set although a general call was acknowledged.
        """
        self.nack_as_slave = as_slave
        if not self.str & STR_NACK:
            self.nack_since, self.nack_of = now, refused
        self.set(now, STR_NACK)
