"""The I2C module as the CPU sees it: effects of register accesses, loopback and resets. `lines` handles the pins.

    registers <--> I2cRegisters (flags, data path, FIFOs, interrupts) <--> I2cSlave, I2cMaster

Source: SPRUG03B sections 4 and 5.
"""

# core: compiled without checks for None

from __future__ import annotations

from . import register_map as at
from .lines import I2cLines
from .register_map import MDR_BC, MDR_DLB, MDR_IRS, MDR_MST, MDR_STP, MDR_STT, SCL, STR_XRDY


class I2c(I2cLines):
    """The I2C module. options: answers to open questions of the manual."""

    # Registers -----------------------------------------------------------------------

    def read(self, now: int, offset: int) -> int:
        if self.next_wake <= now:
            self._readable = -1
            self._advance(now)
        if not self._accessible():
            return 0
        state = self.state
        if offset == at.DRR:
            value = state.read_drr(now)
            self.target.drr_read(now)
            self.master.drr_read(now)
        elif offset == at.ISRC:
            value = state.read_isrc(now)
        else:
            return self.peek(now, offset)
        self._loop_and_plan(now)
        return value

    def _accessible(self) -> bool:
        if self._clocked:
            return True
        return self.options.clock_gate_access.assume(self.touched) == "accessible"

    def peek(self, now: int, offset: int) -> int:
        if self.next_wake <= now:
            self._advance(now)
        state = self.state
        if not self._clocked and not self._accessible():
            return 0
        if offset == at.STR:
            return state.str
        if offset == at.MDR:
            return state.mdr
        if offset == at.DRR:
            return state.rx_fifo.words[0] if state.fifo and state.rx_fifo else state.drr
        if offset == at.ISRC:
            return state.code | state.isrc_high
        if offset == at.FFTX:
            return state.tx_fifo.show()
        if offset == at.FFRX:
            return state.rx_fifo.show()
        return state.emdr() if offset == at.EMDR else state.stored(offset)

    def write(self, now: int, offset: int, value: int) -> None:
        self.writes += offset not in (at.DXR, at.STR)
        self._advance(now)
        if not self._accessible():
            return
        state = self.state
        if offset == at.DXR:
            state.write_dxr(now, value)
            self.target.dxr_written(now)
            self.master.dxr_written(now)
        elif offset == at.STR:
            self._write_str(now, value)
        elif offset == at.MDR:
            looped = state.mdr & MDR_DLB
            self._write_mdr(now, value & ~(1 << 12))
            if looped and not state.mdr & MDR_DLB:
                self._update_lines(now, self._pins)  # after loopback, the present levels at the pins apply at once
        elif offset == at.IER:
            state.ier = value & 0x7F
            self.limits.fifo_enables()
            state.update(now)
        elif offset == at.FFTX:
            before = state.fifo
            state.write_fftx(now, value)
            if not before:
                self.limits.fifo_enables()
        elif offset == at.FFRX:
            state.write_ffrx(now, value)
        else:
            self._write_plain(now, offset, value)
        self._loop_and_plan(now)

    def _loop_and_plan(self, now: int) -> None:
        if self.state.mdr & MDR_DLB:
            self._update_lines(now, self._levels())
        self._plan()

    def _write_plain(self, now: int, offset: int, value: int) -> None:
        """Write a register without special effects, such as I2COAR or I2CCNT, and check TI's requirements on it."""
        state = self.state
        if offset == at.OAR:
            state.oar = value & 0x3FF
            if self.limits.written_while_enabled("I2COAR"):
                self.limits.address("I2COAR", state.oar)
        elif offset == at.SAR:
            state.sar = value & 0x3FF
        elif offset == at.CLKL:
            state.clkl = value & 0xFFFF
            self.limits.divisor("I2CCLKL", state.clkl)
        elif offset == at.CLKH:
            state.clkh = value & 0xFFFF
            self.limits.divisor("I2CCLKH", state.clkh)
        elif offset == at.CNT:
            state.cnt = value & 0xFFFF
            if self.options.cnt_copy_point.unrecorded() == "write":  # the use of this option is recorded at START
                self.master.load_counter()
        elif offset == at.ISRC:
            state.isrc_high = value & 0xF00
            if state.isrc_high:
                state.duty("I2CISRC bits 11 to 8 were not written 0", "SPRUG03B Table 11")
        elif offset == at.EMDR:
            state.write_emdr(value)
        elif offset == at.PSC:
            state.write_psc(value & 0xFF)

    def _write_str(self, now: int, value: int) -> None:
        state = self.state
        if value & state.str & at.STR_RRDY and self.options.rrdy_clear_reads_drr.assume(self.touched):
            state.drr_unread = False
        state.str &= ~(value & at.STR_CLEARS)
        if value & state.str & STR_XRDY and self.options.xrdy_w1c.assume(self.touched) == "yes":
            state.str &= ~STR_XRDY
        state.update(now)

    # I2CMDR -----------------------------------------------------------------------------

    def _write_mdr(self, now: int, value: int) -> None:
        state = self.state
        old = state.mdr
        commands = MDR_STT | MDR_STP
        if not old & MDR_IRS:
            commanded = (value ^ old) & commands
            if not value & MDR_IRS or (commanded and self.options.stt_with_irs_write.assume(self.touched) == "dropped"):
                value = value & ~commands | old & commands
        if (value ^ old) & MDR_BC and state.tx_ready():
            state.duty("BC was changed after I2CDXR was written; expected BC first", "SPRUG03B §5.12")
        state.mdr = value
        if value & MDR_IRS and not old & MDR_IRS:
            state.tm = state.psc + 1  # a rise of IRS latches I2CPSC
            self.filter_width = state.filter_width = self.options.noise_filter_cycles.assume(state.touched) * state.tm
            self.limits.module_clock()
            self.limits.address("I2COAR", state.oar)
            self.target.reset()
            state.fifo_levels(now)
            state.update(now)
        elif old & MDR_IRS and not value & MDR_IRS:
            self.target.reset()
            self.master.reset()
            self._frozen_pull = 0
            self.target.muted = False
            state.irs_reset(now)
            return
        held = (self.target.pulls | self.master.pulls) & SCL
        if value & old & MDR_IRS and held and self.options.irs_write1_releases_bus.assume(self.touched):
            self.target.release_bus()
        if value & MDR_DLB:
            state.clear(now, at.STR_SDIR)
            self.limits.loopback(begins=not old & MDR_DLB)
        if value & MDR_IRS:
            if not value & MDR_MST and self.master.active and not value & MDR_DLB:
                state.duty("MST was cleared in the middle of a transfer", "SPRUG03B Table 5")
            if value & MDR_STT and value & MDR_MST and not self.master.active:
                self.limits.start_commanded(self._bus_busy)
            self.master.command(now, value)
            self.target.muted = self.master.active

    # System reset ---------------------------------------------------------------------------

    def reset(self, now: int) -> None:
        """Reset by XRS: every register takes its reset value, and the module's clock is off."""

        self.writes += 1
        self.state.reset()
        self.target.reset()
        self.master.reset()
        self._clocked = self._suspended = False
        self.held = self._frozen_pull = 0
        self.filter_width = self.state.filter_width
        self._lines.settle(self._pins)
        self._plan()
