"""Line side of the I2C module: events on SCL and SDA, output levels, clock gate, debugger halts and scheduling.

    SCL, SDA --noise filter--> START, STOP, rise, fall --> I2cSlave, I2cMaster --> pulls --> SCL, SDA

The CPU's side is in `module`.

Source: SPRUG03B; clock gate SPRUFB0D section 5.1.

Chosen:
- While its clock is off, the module releases both lines and ignores their levels. Its registers keep their values.
- An edge takes effect one filter width later; a pulse that is shorter than this width has no effect.
- After a debugger halt with FREE = 0, a slave holds SCL low from the fall that ends the present byte. With
  `free_slave_unit` = whole_transfer, it completes the present transfer, and holds SCL low from the first fall of the
  next transfer.
"""

# core: compiled without checks for None

from __future__ import annotations

from fractions import Fraction

from ...core.chip import ANY_CHANGED, NEVER, NO_CHANGE, PINS_CHANGED, WAKE_CHANGED, Chip
from ...core.state import State
from . import register_map as at
from .limits import I2cLimits
from .master import I2cMaster
from .noise_filter import I2cNoiseFilter
from .options import I2cOptions
from .register_map import I2C_MAP, MDR_DLB, MDR_FDF, MDR_FREE, MDR_IRS, SCL, SDA
from .registers import I2cRegisters
from .slave import I2cSlave

BOTH = SCL | SDA


class I2cLines(Chip):
    """Base class of the I2C module: its pins, clock, timers and outputs. The subclass `I2c` adds register accesses."""

    STATE = State(
        "state target limits master _lines _pins _clocked _suspended _bus_busy _frozen_pull _readable",
        cycles="_timer",
    )
    MAP = I2C_MAP
    INPUTS: tuple[str, ...] = ("SCL", "SDA")
    OUTPUTS: tuple[str, ...] = ("SCL", "SDA")
    mid_byte: tuple[int, ...] = (at.MDR, at.CLKL, at.CLKH)
    steady: tuple[int, ...] = (at.OAR, at.IER, at.CLKL, at.CLKH, at.SAR, at.EMDR, at.PSC)

    def __init__(self, options: I2cOptions = I2cOptions()) -> None:  # noqa: B008 (frozen)
        super().__init__()
        self.options = options
        self.state = I2cRegisters(options)
        self.target = I2cSlave(self.state)
        self.limits = I2cLimits(self.state)
        self.master = I2cMaster(self.state, self.limits)
        self._timer = NEVER  # cycle of the next event that is not an edge, as computed by `_next_timer`
        self.out = self._pins = BOTH
        self.notes, self.touched = self.state.notes, self.state.touched
        self._clocked = self._suspended = False
        self._lines = I2cNoiseFilter(options.unequal_arrival.matches("one_sample"), self.touched)
        self.filter_width = self.state.filter_width
        self._bus_busy = False  # True between a START and a STOP, even if they came while IRS was 0
        self._frozen_pull = 0  # mask of the lines that the slave holds low only because the debugger has halted the CPU
        self._readable = -1  # result of `I2cRegisters.readable` after the last edge or timer; -1 after any other input

    # Pins ------------------------------------------------------------------------

    def pins(self, now: int, levels: int) -> int:
        if levels == self._pins:
            return NO_CHANGE
        self._pins = levels
        late = self.next_wake <= now
        if late:
            self._advance(now)
        if not self.state.mdr & MDR_DLB:
            self._update_lines(now, levels)
        if late or not self.filter_width:
            visible = self._visible_changes()
            self._timer = self._next_timer() if self._clocked else NEVER
            self._show()
            return ANY_CHANGED if late else visible
        if self.master.active and self._clocked:
            self._timer = self._next_timer()
        self.next_wake = self._timer if self._timer < self._lines.due else self._lines.due
        return WAKE_CHANGED

    def _update_lines(self, now: int, levels: int) -> None:
        """Apply `levels` to the inputs: the levels of the bus or, in loopback, of the module's own outputs."""
        lines, master = self._lines, self.master
        if master.active:
            master.lines_changed(now, levels)
        else:
            master.lines = levels
        if not self._clocked:
            lines.settle(levels)
            return
        lines.sample(now, levels, self.filter_width, self.state.tm)
        if lines.due <= now:
            self._lines_moved(now)

    def _lines_moved(self, now: int) -> None:
        """Process the filtered edges of cycle `now`. If both lines change at once, only the edge of SCL counts."""
        before, levels = self._lines.levels, self._lines.apply_due(now)
        if before & levels & SCL:
            self._bus_busy = not levels & SDA
        if not self.state.mdr & MDR_IRS:
            return
        master, target = self.master, self.target
        if not (before ^ levels) & SCL:
            if not levels & SCL:
                return
            if levels & SDA:
                target.stop(now)
                master.stop_seen(now)
            else:
                target.start(now)
                master.start_seen(now)
            target.muted = master.active
        elif levels & SCL:
            sda = levels >> 1
            if master.active:
                master.rise(now, sda)
                target.muted = master.active
            target.rise(now, sda)
        else:
            if master.active:
                master.fell(now)
            target.fall(now)
            if self._suspended:
                self._halt_target()

    # Time ------------------------------------------------------------------------

    def wake(self, now: int) -> int:
        self._advance(now)
        self._show()
        return self._visible_changes()

    def _visible_changes(self) -> int:
        """Return ANY_CHANGED if a readable register has changed since the last call, or there is a note.

        Else return PINS_CHANGED. The first call after an access, reset, halt or gate change returns ANY_CHANGED.
        """

        before, self._readable = self._readable, self.state.readable()
        return PINS_CHANGED if before == self._readable and not self.notes else ANY_CHANGED

    def _advance(self, now: int) -> None:
        """Process everything due by `now`, in order of time. In one cycle, a filtered edge precedes a timer."""
        lines = self._lines
        if self._timer > now and lines.due > now:
            return
        while True:
            edge, timer = lines.due, self._timer
            if edge <= timer:
                if edge > now:
                    return
                self._lines_moved(edge)
            elif timer > now:
                return
            else:
                self._timer_due(timer)
            if self.state.mdr & MDR_DLB:
                self._update_lines(min(timer, edge), self._levels())  # in loopback the module receives its own outputs
            self._timer = self._next_timer()

    def _next_timer(self) -> int:
        master = self.master
        timer = master.due
        if master.deliver_at < timer:
            timer = master.deliver_at
        if self.target.due < timer:
            timer = self.target.due
        return self.state.code_at if self.state.code_at < timer else timer

    def next_output(self) -> int:
        """Return the first cycle at which a timer is due, or a filtered edge does more than shift a bit; else NEVER."""
        return min(self._timer, self._lines.visible_due(self.silent_edges(behind_filter=True)))

    def silent_edges(self, behind_filter: bool = False) -> int:
        """Return how many of the next SCL edges change neither a line nor a readable register.

        Return -1 if every edge may cause such a change. Otherwise, the number is valid if the edges are further apart
        than the filter width. Edges of SDA while SCL is low also change nothing.
        behind_filter: True to count edges at the output of the noise filter, False to count edges at the pins.
        """
        if self.state.mdr & MDR_DLB or self._suspended or self.master.answers_edges():
            return -1
        # With this option, an edge of SDA can delay an edge of SCL. So even a pulse of SCL that is longer than the
        # filter width may vanish.
        if self._lines.unequal_arrival.unrecorded():
            return -1
        silent = self.target.silent_edges(bool(self._lines.levels & SCL))
        return silent - 1 if silent > 0 and not behind_filter and self._lines.scl_moves() else silent

    # Skipped bits (see `bus.i2c.bit_skip`) -----------------------------------------

    def waits_for_byte(self, clocks: bool) -> bool:
        """Return True if SCL is low before a byte, and the module will only transfer or ignore the byte's first 7 bits.

        To transfer a bit is to shift it in or out and, as the master, to generate its clock.
        clocks: True if this module generates SCL during the byte.
        """
        state, lines, master = self.state, self._lines, self.master
        if (not clocks) if master.active else master.due != NEVER:
            return False
        if self._suspended or state.mdr & (MDR_DLB | MDR_FDF):
            return False
        if self._pins & SCL or lines.levels & SCL or lines.due != NEVER:
            return False
        return not self.target.follows() or (self._clocked and self.target.waits_for_byte())

    def only_clocks_byte(self) -> bool:
        """Return True if the module is the master and does nothing now but transfer a byte of eight bits."""
        if not self._clocked or self.state.mdr & (MDR_DLB | MDR_FDF):
            return False
        return self.target.is_not_addressed() and self.master.only_clocks()

    def byte_on_sda(self) -> int:
        """Return the byte that the module shifts out; 0xFF if it leaves SDA released."""
        return self.master.byte() if self.master.active else self.target.byte()

    def set_bit_position(self, shown: int, bit: int) -> None:
        """Set the state that the module has after `bit` bits, 0 or 7, of the byte `shown` have passed on the bus."""
        self._pins = self.master.lines = SDA if shown >> (7 - bit) & 1 else 0
        self._lines.settle(self._pins)
        self.target.set_bit_position(shown, bit)
        if self.master.active:
            self.master.set_bit_position(shown, bit)
            self._timer = self._next_timer()
            self.next_wake = self._timer
        self.out = self._levels()

    def _timer_due(self, now: int) -> None:
        if self.state.code_at == now:
            self.state.load_code(now)
        elif self.master.due == now or self.master.deliver_at == now:
            self.master.sees_idle = self._lines.levels == BOTH
            self.master.timer(now)
            self.target.muted = self.master.active
        else:
            self.target.timer(now)

    def _levels(self) -> int:
        if not self._clocked or not self.state.mdr & MDR_IRS:
            return BOTH
        return BOTH & ~(self.target.pulls | self.master.pulls)

    def _plan(self) -> None:
        """Update timers and outputs. Call this after an access, a reset, or a change of clock or debugger halt."""
        self._readable = -1
        self._timer = self._next_timer() if self._clocked else NEVER
        self._show()

    def _show(self) -> None:
        """Update the outputs and the wake-up after an input."""
        if not self._clocked:
            self.out, self.next_wake = BOTH, NEVER
            return
        state = self.state
        if state.requests:
            self.requests |= state.requests
            state.requests = 0
        if state.loaded:
            self.loaded |= state.loaded
            state.loaded = 0
        self.held = state.held
        self.out = BOTH & ~(self.target.pulls | self.master.pulls) if state.mdr & MDR_IRS else BOTH
        self.next_wake = self._timer if self._timer < self._lines.due else self._lines.due

    # Clock, debugger, reset ----------------------------------------------------------------

    def set_sysclk(self, now: int, hz: Fraction) -> bool:
        """Set the frequency of SYSCLKOUT from `now` on. It is used only for checks of limits in seconds and hertz."""
        self._advance(now)
        changed, self.limits.sysclk_hz = hz != self.limits.sysclk_hz, hz
        if changed and self.state.mdr & MDR_IRS:
            self.limits.module_clock()
        return True

    def gate(self, now: int, on: bool) -> None:
        """Switch the module's clock on or off at `now` (PCLKCR0.I2CAENCLK)."""
        self.writes += 1
        self._advance(now)
        if on != self._clocked:
            self._lines.settle(self._pins)
            self._bus_busy = self._pins != BOTH
            self.master.lines = self._pins
        self._clocked = on
        self._plan()

    def suspend(self, now: int, on: bool) -> None:
        """Halt because the debugger has halted the CPU, unless FREE = 1. If `on` is False, resume."""
        self._advance(now)
        self._suspended = on and not self.state.mdr & MDR_FREE
        if self._suspended:
            self.master.halt(now)
        else:
            self.master.resume_after_halt(now)
            self.target.pulls &= ~self._frozen_pull
            self._frozen_pull = 0
        self._plan()

    def _halt_target(self) -> None:
        target = self.target
        if self.master.active or not target.follows():
            return
        complete = not target.own_transfer or self.options.free_slave_unit.assume(self.touched) == "byte"
        if complete and target.bit == 0 and not target.pulls & SCL:
            target.pulls |= SCL
            self._frozen_pull = SCL
