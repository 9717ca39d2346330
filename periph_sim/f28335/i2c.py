"""The I2C module: register accesses, SCL and SDA go in; SCL, SDA, I2CINT1A and I2CINT2A come out.

    SCL, SDA --noise filter--> START, STOP, rise, fall --> I2cTarget, I2cMaster --> pulls --> SCL, SDA
    registers <--> I2cState (flags, data path, FIFOs, interrupts) <--> the two

This file joins them: what each register write means, resets, the clock gate, loopback,
debugger halts; and it decides when anybody must be woken. An edge whose effect nobody can
see (traffic for others, data bits in mid-byte) waits in a short list and is worked off
with the next input.

Source: SPRUG03B; clock gate SPRUFB0D section 5.1.

Chosen:
- With the clock gated off the module lets go of both lines and hears nothing; its registers keep their values.
- A filtered edge acts one filter width after the edge; a shorter pulse is never seen.
- A debugger halt as slave holds SCL low from the fall that ends the byte (or the transfer) on.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from ..core.chip import ALL, NEVER, NOTHING, OUTPUTS
from . import i2c_map as at
from .i2c_map import (
    I2C_MAP,
    MDR_BC,
    MDR_DLB,
    MDR_FDF,
    MDR_FREE,
    MDR_IRS,
    MDR_MST,
    MDR_STP,
    MDR_STT,
    MDR_XA,
    SCL,
    SDA,
    STR_RRDY,
    STR_SDIR,
    STR_XRDY,
)
from .i2c_master import I2cMaster
from .i2c_options import I2cOptions
from .i2c_state import DEPTH, I2cState
from .i2c_target import IGNORE, OFF, I2cTarget

SCL_PIN, SDA_PIN = 0, 1  # indices in INPUTS and OUTPUTS
I2CSTR, I2CMDR = I2C_MAP["I2CSTR"], I2C_MAP["I2CMDR"]
BOTH = SCL | SDA
BYTE_ENABLES = I2C_MAP["I2CIER"]["XRDY"].mask | I2C_MAP["I2CIER"]["RRDY"].mask
SEVEN_BIT_LEFTOVER = 0x380  # bits 9 to 7 of an address register
MODULE_CLOCK_HZ = (7_000_000, 12_000_000)
SYSCLK_HZ = 150_000_000  # what the check of the module clock assumes


class I2c:
    MAP = I2C_MAP
    INPUTS: tuple[str, ...] = ("SCL", "SDA")
    OUTPUTS: tuple[str, ...] = ("SCL", "SDA")
    LINES: tuple[str, ...] = ("I2CINT1A", "I2CINT2A")

    def __init__(self, options: I2cOptions = I2cOptions()) -> None:  # noqa: B008 (frozen)
        self.options = options
        self.state = I2cState(options)
        self.target = I2cTarget(self.state)
        self.master = I2cMaster(self.state)
        self.next_wake = NEVER
        self._timer = NEVER  # the first of all timers inside, as of the last input
        self.out = BOTH
        self.requests = 0
        self.held = 0
        self.notes = self.state.notes
        self.touched = self.state.touched
        self._clocked = False
        self._raw = BOTH  # the pins as they are
        self._scl = self._sda = 1  # behind the filter
        self._pending: deque[tuple[int, int, int]] = deque()  # (due, index, level) of edges in the filter
        self._waiting: list[tuple[int, int, int]] = []  # the same, of edges before those that nobody sees
        self._filter = options.noise_filter_cycles
        self._passive = False  # enabled, no master, no loopback, no halt: edges only wait for the filter
        self._width = 0  # of the filter, in cycles
        self._patient = False  # passive, and no edge is in the filter that anybody will see
        self._quiet = 0  # then so many edges of SCL can wait, and those of SDA while SCL is low
        self._moved = [0, 0]  # when SCL and SDA changed last
        self._suspended = False
        self._frozen_pull = 0  # what a halted slave pulls until the CPU runs on
        self._rise8_matters = options.aas_sdir_point == "rise8"
        self._rise9_matters = options.rrdy_point == "rise9" or options.dxr_to_xsr_copy_point == "ack_rise9"

    # Pins ------------------------------------------------------------------------

    def pin(self, now: int, index: int, level: int) -> int:
        raw = self._raw
        if raw >> index & 1 == level:
            return NOTHING
        self._raw = raw ^ (1 << index)
        since, self._moved[index] = self._moved[index], now
        if self._patient and now - since >= self._width:
            return self._into_the_filter(now + self._width, index, level)
        planned = self.next_wake
        self._advance(now)
        self._pending.extend(self._waiting)
        self._waiting.clear()
        if self._passive:
            self.master.scl, self.master.sda = raw & SCL, raw >> 1
        if not self.state.mdr & MDR_DLB:
            self._edge(now, index, level)
        self._plan()
        return OUTPUTS if self._passive and planned > now else ALL

    def _into_the_filter(self, due: int, index: int, level: int) -> int:
        """The usual case: other devices move the lines, and no edge is on its way that anybody will see."""
        if index:
            if not self._raw & SCL:
                self._waiting.append((due, index, level))
                return NOTHING
        elif self._quiet:
            self._quiet -= 1
            self._waiting.append((due, index, level))
            return NOTHING
        self._patient = False
        self._pending.append((due, index, level))
        if due < self.next_wake:
            self.next_wake = due
        return OUTPUTS

    def _tell_master(self) -> None:
        """The master hears of the lines edge by edge when it works; else when it may begin to."""
        if self._passive:
            self.master.scl, self.master.sda = self._raw & SCL, self._raw >> 1

    def _edge(self, now: int, index: int, level: int) -> None:
        """A line of the bus, or in loopback our own output, changed."""
        if not self._clocked:
            if index:
                self._sda = level
            else:
                self._scl = level
            return
        if self.master.active:
            self.master.line(now, index, level)
        else:
            if index:
                self.master.sda = level
            else:
                self.master.scl = level
        width = self._filter * self.state.tm
        if not width:
            self._event(now, index, level)
            return
        pending = self._pending
        for i, (_, line, _) in enumerate(pending):
            if line == index:  # shorter than the filter: it was never there
                del pending[i]
                return
        pending.append((now + width, index, level))

    def _event(self, now: int, index: int, level: int) -> None:
        """An edge behind the filter."""
        if index:
            self._sda = level
            if self._scl and self.state.mdr & MDR_IRS:
                if level:
                    self.target.stop(now)
                    self.master.bus_free(now)
                    self.target.muted = self.master.active
                else:
                    self.target.start(now)
            return
        self._scl = level
        if not self.state.mdr & MDR_IRS:
            return
        if level:
            if self.master.active:
                self.master.rise(now, self._sda)
                self.target.muted = self.master.active
            self.target.rise(now, self._sda)
        else:
            if self.master.active:
                self.master.fell(now)
            self.target.fall(now)
            if self._suspended:
                self._halt_target()

    # Whole pulses at once ------------------------------------------------------------

    @property
    def filter_width(self) -> int:
        """Cycles an edge takes through the noise filter."""
        return self._width

    def pulses_left(self, now: int) -> int:
        """How many whole pulses of SCL, low at `now`, can pass before anybody sees more of it than bits on SDA."""
        if not self._patient or self._timer <= now:
            return 0
        if self._waiting:
            self._work_off(now)
        return 0 if self._waiting or self._scl else self.target.pulses_left()

    def sends(self, pulses: int) -> list[int]:
        """SDA as this module drives it now and after each of so many pulses; empty if it does not send."""
        return self.target.sends(pulses)

    def follow(self, last_fall: int, sda: Sequence[int]) -> None:
        """Pulses have passed, as many as `pulses_left` allows, and their last edges have passed the filter.

        sda: the level of SDA before the first pulse and after each.
        """
        self.target.follow(sda)
        self._sda = sda[-1]
        self._raw = sda[-1] << 1
        self._moved = [last_fall, last_fall]
        self.out = self._levels()
        self._quiet = self.target.quiet_edges(0, self._rise8_matters, self._rise9_matters)

    # Time ------------------------------------------------------------------------

    def wake(self, now: int) -> int:
        if self._waiting:
            self._work_off(now)
        if self._passive and self._timer > now and self.target.in_mid_byte:
            pending = self._pending
            if len(pending) == 1 and pending[0][0] <= now and not pending[0][1]:  # SCL falls: the next bit we send
                pending.clear()
                self._scl = 0
                self.target.fall(now)
                self.out = self._levels()
                self.next_wake = self._timer
                self._quiet = self.target.quiet_edges(0, self._rise8_matters, self._rise9_matters)
                self._patient = True
                return OUTPUTS
        self._advance(now)
        self._show()
        return ALL

    def _work_off(self, now: int) -> None:
        """The edges that could wait and have passed the filter: no flag moves, nothing is planned anew."""
        waiting, target = self._waiting, self.target
        done = 0
        for due, index, level in waiting:
            if due > now or due >= self._timer:
                break
            done += 1
            if index:
                self._sda = level
            else:
                self._scl = level
                if level:
                    target.rise(due, self._sda)
        del waiting[:done]
        if waiting and waiting[0][0] <= now:  # a timer comes first
            self._pending.extendleft(reversed(waiting))
            waiting.clear()

    def _advance(self, now: int) -> None:
        """Everything that is due by `now`, in order of time; filtered edges before timers."""
        if self._waiting:
            self._work_off(now)
        pending = self._pending
        if self._timer > now and (not pending or pending[0][0] > now):
            return
        while True:
            edge = pending[0][0] if pending else NEVER
            timer = self._timer
            if edge <= timer:
                if edge > now:
                    return
                _, index, level = pending.popleft()
                self._event(edge, index, level)
            elif timer > now:
                return
            else:
                self._timer_due(timer)
            if self.state.mdr & MDR_DLB:
                self._loop(min(timer, edge))
            self._timer = self._next_timer()

    def _next_timer(self) -> int:
        master = self.master
        timer = master.next_due if master.active else master.due
        if self.target.due < timer:
            timer = self.target.due
        return self.state.code_at if self.state.code_at < timer else timer

    def _timer_due(self, now: int) -> None:
        self._tell_master()
        if self.state.code_at == now:
            self.state.load_code(now)
        elif self.master.next_due == now:
            self.master.sees_idle = bool(self._scl and self._sda)
            self.master.timer(now)
            self.target.muted = self.master.active
        else:
            self.target.timer(now)

    def _loop(self, now: int) -> None:
        """In loopback the module hears its own outputs."""
        out = self._levels()
        for index in (0, 1):
            level = out >> index & 1
            if level != (self.master.sda if index else self.master.scl):
                self._edge(now, index, level)

    def _levels(self) -> int:
        if not self._clocked or not self.state.mdr & MDR_IRS:
            return BOTH
        return BOTH & ~(self.target.pulls | self.master.pulls)

    def _plan(self) -> None:
        """After an input that may have set or stopped a timer."""
        self._timer = self._next_timer() if self._clocked else NEVER
        self._show()

    def _show(self) -> None:
        """Outputs and wake-up after an input."""
        if not self._clocked:
            self.out, self.next_wake = BOTH, NEVER
            self._passive = self._patient = False
            return
        state = self.state
        if state.requests:
            self.requests |= state.requests
            state.requests = 0
        self.held = state.held
        self._width = self._filter * state.tm
        mode = state.mdr & (MDR_IRS | MDR_DLB)
        self._passive = mode == MDR_IRS and self._width > 0 and not self.master.active and not self._suspended
        self._patient = False
        self.out = self._levels()
        self.next_wake = self._timer
        if self._pending:
            self._patient = False
            if self._pending[0][0] < self._timer:
                self.next_wake = self._pending[0][0]
        elif self._passive:
            self._patient = True
            self._quiet = self.target.quiet_edges(self._scl, self._rise8_matters, self._rise9_matters)
            for _, index, _ in self._waiting:
                self._quiet -= not index

    # Registers -----------------------------------------------------------------------

    def read(self, now: int, offset: int) -> int:
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
        self.touched.add("clock_gate_access")
        return self.options.clock_gate_access == "accessible"

    def peek(self, now: int, offset: int) -> int:
        if self._waiting or self._pending or self._timer <= now:
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
            return state.fftx | len(state.tx_fifo) << 8
        if offset == at.FFRX:
            return state.ffrx | min(len(state.rx_fifo), DEPTH) << 8
        if offset == at.EMDR:
            state.touched.add("emdr_present")
            if not state.emdr_written:
                state.touched.add("bcm_reset")
            return state.bcm if self.options.emdr_present else 0
        return {
            at.OAR: state.oar,
            at.IER: state.ier,
            at.CLKL: state.clkl,
            at.CLKH: state.clkh,
            at.CNT: state.cnt,
            at.SAR: state.sar,
            at.DXR: state.dxr,
            at.PSC: state.psc,
        }.get(offset, 0)

    def write(self, now: int, offset: int, value: int) -> None:
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
            self._write_mdr(now, value & ~(1 << 12))
        elif offset == at.IER:
            state.ier = value & 0x7F
            self._check_fifo_enables()
            state.update(now)
        elif offset == at.FFTX:
            before = state.fifo
            state.write_fftx(now, value)
            if not before:
                self._check_fifo_enables()
        elif offset == at.FFRX:
            state.write_ffrx(now, value)
        else:
            self._write_plain(now, offset, value)
        self._loop_and_plan(now)

    def _loop_and_plan(self, now: int) -> None:
        if self.state.mdr & MDR_DLB:
            self._loop(now)
        self._plan()

    def _write_plain(self, now: int, offset: int, value: int) -> None:
        """Registers that only hold a value; with the duties that TI names for them."""
        state = self.state
        if offset == at.OAR:
            state.oar = value & 0x3FF
            self._check_address("I2COAR", state.oar)
            if state.mdr & MDR_IRS:
                state.touched.add("oar_latch")
                state.duty("I2COAR was written with IRS = 1; configuration belongs into IRS = 0", "SPRUG03B section 4")
        elif offset == at.SAR:
            state.sar = value & 0x3FF
            self._check_address("I2CSAR", state.sar)
        elif offset in (at.CLKL, at.CLKH):
            name = "I2CCLKL" if offset == at.CLKL else "I2CCLKH"
            if state.mdr & MDR_IRS:
                state.duty(f"{name} was written with IRS = 1; configuration belongs into IRS = 0", "SPRUG03B section 4")
            if offset == at.CLKL:
                state.clkl = value & 0xFFFF
            else:
                state.clkh = value & 0xFFFF
            if not value & 0xFFFF:
                state.duty(f"{name} was written 0; expected 1 to 65535", "SPRUG03B Tables 13, 14")
        elif offset == at.CNT:
            state.cnt = value & 0xFFFF
            if self.options.cnt_copy_point == "write":
                self.master.load_counter()
        elif offset == at.ISRC:
            state.isrc_high = value & 0xF00
            if state.isrc_high:
                state.duty("I2CISRC bits 11 to 8 were not written 0", "SPRUG03B Table 11")
        elif offset == at.EMDR:
            self._write_emdr(value)
        elif offset == at.PSC:
            self._write_psc(value & 0xFF)

    def _check_fifo_enables(self) -> None:
        state = self.state
        if state.fifo and state.ier & BYTE_ENABLES:
            state.duty("I2CIER enables XRDY or RRDY in FIFO mode; expected 0 there", "SPRUG03B Table 9")

    def _write_emdr(self, value: int) -> None:
        self.touched.add("emdr_present")
        if self.options.emdr_present:
            self.state.bcm = value & 1
            self.state.emdr_written = True
            if value & ~1:
                self.state.duty("I2CEMDR bits 15 to 1 were not written 0", "SPRUG03B Table 8")

    def _write_psc(self, value: int) -> None:
        state = self.state
        if state.mdr & MDR_IRS:
            self.touched.add("psc_write_irs1")
            state.duty("I2CPSC was written with IRS = 1, where it has no effect; write it in IRS = 0", "SPRUG03B §1.4")
            if self.options.psc_write_irs1 == "dropped":
                return
        state.psc = value
        least, most = MODULE_CLOCK_HZ
        if not least <= SYSCLK_HZ // (value + 1) <= most:
            mhz = SYSCLK_HZ / (value + 1) / 1e6
            state.duty(
                f"I2CPSC = {value} gives a module clock of {mhz:.2f} MHz at 150 MHz; expected 7 to 12 MHz",
                "SPRUG03B §1.4",
            )

    def _check_address(self, name: str, value: int) -> None:
        if value & SEVEN_BIT_LEFTOVER and not self.state.mdr & MDR_XA:
            self.state.duty(
                f"{name} = {value:#05x} has bits 9 to 7 set with XA = 0; expected 0 there", "SPRUG03B §5.8, §5.9"
            )

    def _write_str(self, now: int, value: int) -> None:
        state = self.state
        if value & state.str & STR_RRDY:
            state.rrdy_cleared()
        state.str, _ = I2CSTR.write(state.str, value)
        if value & state.str & STR_XRDY:
            self.touched.add("xrdy_w1c")
            if self.options.xrdy_w1c == "yes":
                state.str &= ~STR_XRDY
        state.update(now)

    # I2CMDR -----------------------------------------------------------------------------

    def _write_mdr(self, now: int, value: int) -> None:
        self._tell_master()
        state = self.state
        old = state.mdr
        commands = MDR_STT | MDR_STP
        if not old & MDR_IRS:
            if value & MDR_IRS and value & commands:
                self.touched.add("stt_with_irs_write")
            if not value & MDR_IRS or self.options.stt_with_irs_write == "dropped":
                value = value & ~commands | old & commands
        if (value ^ old) & MDR_BC and state.tx_ready:
            state.duty("BC was changed after I2CDXR was written; expected BC first", "SPRUG03B §5.12")
        state.mdr = value
        if value & MDR_IRS and not old & MDR_IRS:
            self._enable(now)
        elif old & MDR_IRS and not value & MDR_IRS:
            self._disable(now)
            return
        elif value & MDR_IRS and (self.target.pulls | self.master.pulls) & SCL:
            self.touched.add("irs_write1_releases_bus")
            if self.options.irs_write1_releases_bus:
                self.target.release_bus()
        if value & MDR_DLB:
            self._loopback_on(now, old)
        if value & MDR_IRS:
            if not value & MDR_MST and self.master.active and not value & MDR_DLB:
                state.duty("MST was cleared in the middle of a transfer", "SPRUG03B Table 5")
            self.master.command(now, value)
            self.target.muted = self.master.active

    def _loopback_on(self, now: int, old: int) -> None:
        value = self.state.mdr
        self.state.clear(now, STR_SDIR)
        if not value & MDR_MST and not old & MDR_DLB:
            self.state.duty("DLB was set with MST = 0; loopback needs a master", "SPRUG03B Table 5")
        if value & MDR_FDF:
            self.state.duty("DLB and FDF are both 1; free data format has no loopback", "SPRUG03B §2.5.3")

    def _enable(self, now: int) -> None:
        state = self.state
        state.tm = state.psc + 1
        state.touched.add("noise_filter_cycles")
        self.target.reset()
        state.fifo_levels(now)
        state.update(now)

    def _disable(self, now: int) -> None:
        self.target.reset()
        self.master.reset()
        self._frozen_pull = 0
        self.target.muted = False
        self.state.irs_reset(now)

    # Clock, debugger, reset ----------------------------------------------------------------

    def gate(self, now: int, on: bool) -> None:
        """PCLKCR0.I2CAENCLK acts from `now` on."""
        self._advance(now)
        if on and not self._clocked:
            self._scl, self._sda = self._raw & 1, self._raw >> 1
            self.master.scl, self.master.sda = self._scl, self._sda
        self._clocked = on
        self._pending.clear()
        self._waiting.clear()
        self._plan()

    def suspend(self, now: int, on: bool) -> None:
        """A breakpoint was reached (True), or the debugger lets the CPU run on."""
        self._advance(now)
        self._tell_master()
        self._suspended = on and not self.state.mdr & MDR_FREE
        if self._suspended:
            self.master.halt(now)
        else:
            self.master.go_on(now)
            self.target.pulls &= ~self._frozen_pull
            self._frozen_pull = 0
        self._plan()

    def _halt_target(self) -> None:
        target = self.target
        if self.master.active or target.phase in (OFF, IGNORE):
            return
        self.touched.add("free_slave_unit")
        complete = self.options.free_slave_unit == "byte" or not target.own_transfer
        if complete and target.bit == 0 and not target.pulls & SCL:
            target.pulls |= SCL
            self._frozen_pull = SCL

    def reset(self, now: int) -> None:
        """XRS: every register takes its reset value, the clock gate is off."""
        self.state.reset()
        self.target.reset()
        self.master.reset()
        self._clocked = False
        self._pending.clear()
        self._waiting.clear()
        self._suspended = False
        self._frozen_pull = 0
        self._plan()
