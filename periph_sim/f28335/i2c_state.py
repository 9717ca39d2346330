"""The CPU's side of the I2C module: registers, flags, data path, FIFOs and interrupts.

    I2CDXR or TX FIFO --> I2CXSR --> the bit engines        bit engines --> I2CRSR --> I2CDRR or RX FIFO
    flags and I2CIER --> arbiter --> I2CISRC, I2CINT1A      FIFO levels --> I2CINT2A

Knows no edge: the bit engines (`i2c_target`, `i2c_master`) say what happened and when, and
so could a coarser line side. Source: SPRUG03B sections 3 (interrupts), 4 (reset), 5.

Chosen:
- A request dropped before its code was loaded (its flag was cleared) is forgotten.
- In FIFO mode XRDY says that the TX FIFO has room, RRDY that the RX FIFO holds something.
"""

from __future__ import annotations

from ..core.chip import NEVER, Note
from ..core.fifo import Fifo
from .i2c_map import (
    I2C_MAP,
    MDR_BC,
    MDR_IRS,
    MDR_NACKMOD,
    MDR_STP,
    MDR_STT,
    MDR_TRX,
    STR_AAS,
    STR_NACK,
    STR_RRDY,
    STR_RSFULL,
    STR_XRDY,
    STR_XSMT,
)
from .i2c_options import I2cOptions

I2CSTR = I2C_MAP["I2CSTR"]
I2CFFTX, I2CFFRX = I2C_MAP["I2CFFTX"], I2C_MAP["I2CFFRX"]
FFEN = I2CFFTX["I2CFFEN"].mask
FFRST = I2CFFTX["TXFFRST"].mask  # the same places in I2CFFRX from here on
FFINT = I2CFFTX["TXFFINT"].mask
FFINTCLR = I2CFFTX["TXFFINTCLR"].mask
FFIENA = I2CFFTX["TXFFIENA"].mask
FFIL = I2CFFTX["TXFFIL"].mask

DEPTH = 16
COMMANDS = MDR_STT | MDR_STP | MDR_NACKMOD
SRC_AL, SRC_NACK, SRC_ARDY, SRC_RRDY, SRC_XRDY, SRC_SCD, SRC_AAS = (1 << n for n in range(7))
CODE_CLEARS = {1: SRC_AL, 2: SRC_NACK, 6: SRC_SCD}  # I2CISRC code -> flag that its read clears (Table 11)
INT1, INT2 = 1, 2


class I2cState:
    """Everything of the module that is not bits on wires. Times are SYSCLKOUT cycles."""

    __slots__ = (
        "_active",
        "_pending",
        "_rx_was_high",
        "_tx_was_low",
        "bcm",
        "clkh",
        "clkl",
        "cnt",
        "code",
        "code_at",
        "drr",
        "drr_unread",
        "dxr",
        "dxr_behind",
        "dxr_full",
        "emdr_written",
        "ffrx",
        "fftx",
        "held",
        "ier",
        "isrc_high",
        "mdr",
        "nack_as_slave",
        "notes",
        "oar",
        "options",
        "psc",
        "requests",
        "rsr",
        "rx_fifo",
        "sar",
        "str",
        "tm",
        "touched",
        "tx_fifo",
        "wanted",
        "xsr",
        "xsr_full",
    )

    def __init__(self, options: I2cOptions) -> None:
        self.options = options
        self.notes: list[Note] = []
        self.touched: set[str] = set()
        self.requests = 0
        self.held = 0
        self.reset()

    def reset(self) -> None:
        """XRS."""
        self.str = I2CSTR.reset
        self.oar = self.ier = self.clkl = self.clkh = self.cnt = self.mdr = self.psc = 0
        self.sar = I2C_MAP["I2CSAR"].reset
        self.bcm = self.options.bcm_reset if self.options.emdr_present else 1
        self.emdr_written = False
        self.isrc_high = 0
        self.tm = 1  # module clock in cycles, as taken over when IRS last rose
        self.dxr = self.xsr = self.drr = self.rsr = 0
        self.dxr_full = self.xsr_full = False
        self.drr_unread = False
        self.dxr_behind: list[int] = []  # bytes written behind a full I2CDXR (dxr_write_while_full)
        self.fftx = self.ffrx = 0
        self.tx_fifo = Fifo(DEPTH)
        self.rx_fifo = Fifo(DEPTH)
        self._tx_was_low = self._rx_was_high = False
        self.wanted = False  # a transmitter is in a transfer: data requests make sense
        self.nack_as_slave = False
        self.code = 0
        self.code_at = NEVER
        self._pending = 0  # requests whose code was not loaded yet
        self._active = 0
        self.requests = self.held = 0

    # Flags -------------------------------------------------------------------

    def set(self, now: int, flags: int) -> None:
        self.str |= flags
        self.update(now)

    def clear(self, now: int, flags: int) -> None:
        self.str &= ~flags
        self.update(now)

    def sources(self) -> int:
        """The flags that are enabled to ask, as bits in the order of I2CIER."""
        status = self.str
        active = (status & 0x3F | (SRC_AAS if status & STR_AAS else 0)) & self.ier
        if active & SRC_XRDY and not self.wanted:
            self.touched.add("xrdyint_when_idle")
            if self.options.xrdyint_when_idle == "only_addressed":
                active &= ~SRC_XRDY
        if active & SRC_NACK and self.nack_as_slave:
            self.touched.add("nackint_in_slave_tx")
            if not self.options.nackint_in_slave_tx:
                active &= ~SRC_NACK
        return active

    def update(self, now: int) -> None:
        """After any change of flags or enables: new requests are noted, and a code is on its way if none stands."""
        if not self.ier and not self._active:
            return
        active = self.sources()
        rising = active & ~self._active
        self._active = active
        self._pending = (self._pending | rising) & active
        if self.code and not active >> (self.code - 1) & 1:
            self.touched.add("isrc_follows_flag")
            if self.options.isrc_follows_flag == "vanishes":
                self._show(now, 0)
        if self._pending and self.code_at == NEVER and (not self.code or self._outranks()):
            self.code_at = now + self.options.event_to_isrc_delay
            self.touched.add("event_to_isrc_delay")
            if not self.options.event_to_isrc_delay:
                self.load_code(now)

    def _outranks(self) -> bool:
        self.touched.add("isrc_preempt")
        return self.options.isrc_preempt == "highest" and self._rank(self._first()) < self._rank(self.code)

    def _rank(self, code: int) -> int:
        return code if self.options.int_priority == "ascending" else -code

    def _first(self) -> int:
        """The code that goes first among the pending requests, or 0."""
        codes = [bit + 1 for bit in range(7) if self._pending >> bit & 1]
        if len(codes) > 1:
            self.touched.add("int_priority")
        return min(codes, key=self._rank, default=0)

    def load_code(self, now: int) -> None:
        """The arbiter's delay is over: the pending request of highest rank becomes INTCODE."""
        self.code_at = NEVER
        code = self._first()
        if not code or (self.code and not self._outranks()):
            return
        if self.code:  # replaced before it was read: it waits again
            self._pending |= 1 << (self.code - 1)
        else:
            self.requests |= INT1
        self._pending &= ~(1 << (code - 1))
        self._show(now, code)

    def _show(self, now: int, code: int) -> None:
        self.code = code
        if self.options.int_line == "level":
            self.held = self.held & ~INT1 | (INT1 if code else 0)

    def read_isrc(self, now: int) -> int:
        code = self.code
        if code:
            self._show(now, 0)
            cleared = CODE_CLEARS.get(code, 0)
            if code == 7:
                self.touched.add("isrc_read_clears_aas")
                if self.options.isrc_read_clears_aas:
                    cleared = STR_AAS
            if cleared:
                self.clear(now, cleared)
            self.touched.add("int_line")
            self.code_at = NEVER
            self.load_code(now)
        return code | self.isrc_high

    def irs_reset(self, now: int) -> None:
        """IRS went to 0: status to its defaults; what survives is the options' business."""
        keep_bb = self.str & I2CSTR["BB"].mask if self.options.bb_on_irs_reset == "keep" else 0
        self.touched.add("bb_on_irs_reset")
        if self.dxr_full or self.xsr_full:
            self.touched.add("dxr_survives_irs")
        if self.options.dxr_survives_irs != "kept_and_still_sent":
            self.dxr_full = False
            self.dxr_behind.clear()
        self.xsr_full = False
        self.wanted = False
        self.str = I2CSTR.reset | keep_bb
        if self.code:
            self.touched.add("irs_clears_isrc")
            if self.options.irs_clears_isrc:
                self._show(now, 0)
        self.code_at = NEVER
        self._pending = 0
        self._active = self.sources() if self.mdr & MDR_IRS else 0
        self.drr_unread = False
        if self.mdr & COMMANDS:
            self.touched.add("irs_clears_commands")
            if self.options.irs_clears_commands:
                self.mdr &= ~COMMANDS
        if self.tx_fifo or self.rx_fifo:
            self.touched.add("irs_clears_fifo")
            if self.options.irs_clears_fifo:
                self.tx_fifo.clear()
                self.rx_fifo.clear()

    # Data path, sending --------------------------------------------------------

    @property
    def fifo(self) -> bool:
        return bool(self.fftx & FFEN)

    @property
    def tx_ready(self) -> bool:
        """Whether a byte waits to go to I2CXSR."""
        return bool(self.tx_fifo) or self.dxr_full if self.fifo else self.dxr_full

    def write_dxr(self, now: int, value: int) -> None:
        value &= 0xFF
        if self.fifo:
            if not self.fftx & FFRST:
                self.notes.append(
                    Note(
                        "lost",
                        "a byte was written to I2CDXR while TXFFRST = 0 holds the TX FIFO empty",
                        "SPRUG03B Table 21",
                    )
                )
            elif self._extra_stage and not self.dxr_full:
                self.dxr, self.dxr_full = value, True
            elif not self.tx_fifo.push(value):
                self.notes.append(Note("lost", "a byte was written to a full TX FIFO", "SPRUG03B section 5.12"))
            self.fifo_levels(now)
            self.set(now, STR_XSMT)
            return
        if self.dxr_full:
            self.touched.add("dxr_write_while_full")
            policy = self.options.dxr_write_while_full
            if policy == "ignored":
                return
            if policy == "queued_behind_xsr":
                self.dxr_behind.append(value)
                return
        self.dxr, self.dxr_full = value, True
        self.str = self.str & ~STR_XRDY | STR_XSMT
        self.update(now)

    @property
    def _extra_stage(self) -> bool:
        self.touched.add("fifo_extra_stage")
        return self.options.fifo_extra_stage == "dxr_drr_behind"

    def copy_to_xsr(self, now: int, xrdy: bool = True) -> bool:
        """I2CDXR (or the TX FIFO's head) goes to I2CXSR; False if there is nothing. xrdy: XRDY rises with it."""
        if self.fifo:
            if self._extra_stage:
                if not self.dxr_full:
                    return False
                self.xsr = self.dxr
                self.dxr_full = bool(self.tx_fifo)
                if self.tx_fifo:
                    self.dxr = self.tx_fifo.pop()
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
            return True
        self.dxr_full = False
        if xrdy:
            self.set(now, STR_XRDY)
        return True

    # Data path, receiving --------------------------------------------------------

    @property
    def rx_blocked(self) -> bool:
        """Whether a further byte finds no place."""
        if self.fifo:
            room = DEPTH + (1 if self._extra_stage else 0)
            return len(self.rx_fifo) >= room if self.ffrx & FFRST else False
        return self.drr_unread

    def received(self, now: int, value: int) -> None:
        """I2CRSR is copied to I2CDRR, or to the RX FIFO."""
        if self.fifo:
            if self.ffrx & FFRST:
                self.rx_fifo.words.append(value)
                self.fifo_levels(now)
                self.set(now, STR_RRDY)
            return
        self.drr = value
        self.drr_unread = True
        self.set(now, STR_RRDY)

    def read_drr(self, now: int) -> int:
        if self.fifo:
            if self.rx_fifo:
                self.drr = self.rx_fifo.pop()
                if not self.rx_fifo:
                    self.str &= ~STR_RRDY
                self.fifo_levels(now)
        else:
            self.drr_unread = False
            self.str &= ~STR_RRDY
        self.update(now)
        return self.drr

    def rrdy_cleared(self) -> None:
        """RRDY was cleared by writing 1 to it."""
        self.touched.add("rrdy_clear_reads_drr")
        if self.options.rrdy_clear_reads_drr:
            self.drr_unread = False

    # FIFO registers ----------------------------------------------------------------

    def fifo_levels(self, now: int) -> None:
        """After any change of a FIFO: the level flags and their request."""
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
        level = self.options.fifo_int_mode == "level"
        if condition and (level or not before) and not register & FFINT:
            self.touched.add("fifo_int_mode")
            register |= FFINT
            if register & FFIENA:
                self.requests |= INT2
        return register

    def write_fftx(self, now: int, value: int) -> None:
        before = self.fftx
        self.fftx, fired = I2CFFTX.write(before, value)
        if not self.fftx & FFRST:
            self.tx_fifo.clear()
            if self.xsr_full:
                self.touched.add("txfifo_reset_flushes_xsr")
                if self.options.txfifo_reset_flushes_xsr:
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

    # Small things the engines ask ---------------------------------------------------

    @property
    def bits(self) -> int:
        """Bits of the next data byte."""
        return self.mdr & MDR_BC or 8

    @property
    def trx(self) -> bool:
        return bool(self.mdr & MDR_TRX)

    @property
    def setup(self) -> int:
        """Cycles from a bit on SDA to the release of SCL; never 0, both at once could be a START or a STOP."""
        return max(1, self.options.sda_setup_before_scl_release * self.tm)

    def nack_received(self, now: int, as_slave: bool) -> None:
        self.nack_as_slave = as_slave
        self.set(now, STR_NACK)

    def overrun(self, now: int) -> None:
        self.set(now, STR_RSFULL)

    def duty(self, text: str, source: str) -> None:
        self.notes.append(Note("duty", text, source))
