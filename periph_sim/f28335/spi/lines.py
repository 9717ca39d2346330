"""Line side of the SPI module: its pins, clocks, debugger stops, requests and scheduling.

    A master sends two bits, CLKPOLARITY = 0, CLK_PHASE = 0. h: half a bit, the longer half if SPIBRR + 1 is odd.

    STE    1 0 . . . . . . . . . 1
    CLK    0 . . 1 . 0 . 1 . 0 . .
    SIMO         b15 . . b14
             |<h>|

With CLK_PHASE = 0, data change at the leading edge and are latched at the trailing edge. STE rises half a bit after the
last trailing edge. With CLK_PHASE = 1, data are latched at the leading edge. They change before the first leading edge,
by half a bit or as `ste_lead` says, and at each trailing edge. STE rises at the last trailing edge.

A master counts LSPCLK edges from one edge of SPICLK to the next (`LspclkTimer`); a slave follows the pins. The CPU's
side is in `module`.

`driven` is the mask of the pins that the module drives. `out` is 1 for the other pins. The level of a wire with several
outputs is the AND of all outputs, so it is the level of the one output that is driven.

Chosen, where the manual is silent:
- If a word waits in SPITXBUF at the last edge of SPICLK, it is sent without a gap. The same holds for a word in the
  FIFO if TXDLY = 0. A word that is written later begins like the first word. If SPISTE has not risen yet, SPISTE stays
  low.
- A slave loads the next word at the last edge of the previous word. TXDLY has an effect on masters only.
- If SPISTE of a slave rises in the cycle of an edge of SPICLK, the edge counts. If SPISTE falls in this cycle, the edge
  does not count.
- SIMO and SOMI keep their last output level, which is 0 after reset.
- A change between master and slave drops the character in progress and the one in SPITXBUF.
- When the debugger halts the CPU with FREE = 0 and SOFT = 1, the module still sends all written words if a character is
  in progress. For a master it is in progress from the first edge of SPICLK until the transfer ends, for a slave from
  the first latched bit to the last edge of SPICLK. Otherwise, and with SOFT = 0, the module stops at once.
- In loop-back the transfer is also on the pins of a master. Loop-back has no effect on a slave.

Source: TI SPRUEU3 sections 1.3.2, 1.4.3, 1.5, 2.1.9 and 2.1.10; SPRS439M, SPI timing, for SPISTE of a master; SPRUFB0D
section 5.1 for the clock gate.
"""

from __future__ import annotations

from ...core.chip import ANY_CHANGED, NEVER, NO_CHANGE, WAKE_CHANGED, Chip, Note
from ...core.options import TextOption
from ...core.state import State
from .clock import LspclkTimer
from .data_path import ReceiveBuffer, SpiShifter, TransmitBuffer
from .options import SpiOptions
from .register_map import CLKPOLARITY, FREE, MASTER_SLAVE, SOFT, SPI_MAP, SPILBK, SPIRST, SPISWRESET, TALK

RXINT = 1
TXINT = 2

# Bits of pin levels.
SIMO, SOMI, CLK, STE = 1, 2, 4, 8
PINS = ("SIMO", "SOMI", "CLK", "STE")


RECEIVED = 1 << SPI_MAP["SPIRXBUF"].offset | 1 << SPI_MAP["SPIRXEMU"].offset


# Next event of the master's timer: none, start of a transfer, leading edge of SPICLK, trailing edge, end of TXDLY, rise
# of SPISTE.
IDLE, BEGIN, LEADING, TRAILING, DELAY, RELEASE = range(6)


class SpiLines(Chip):
    """Base class of the SPI: its pins, clock, timer and outputs. The subclass `Spi` adds register accesses.

    name: the module's name in notes.
    options: answers to open questions of the manual.
    driven: bit i is 1 if the module drives OUTPUTS[i].
    """

    STATE = State(
        "driven _shifter _tx _rx _timer _step _begun _clk_active _ste _levels _gated _suspended "
        "_finishing _ccr _ctl _brr _ffct _pri",
        cycles="_inputs _last_leading",
    )
    MAP = SPI_MAP
    INPUTS: tuple[str, ...] = PINS
    OUTPUTS: tuple[str, ...] = PINS

    def __init__(self, name: str = "SPI-A", options: SpiOptions = SpiOptions()) -> None:  # noqa: B008 (frozen)
        super().__init__()
        self.name = name
        self.options = options
        # `_clock_edge` records the use of this option.
        self.filter_width = self._latency = options.input_latency.unrecorded()
        self._shifter = SpiShifter()
        self._tx = TransmitBuffer(options, self.touched)
        self._rx = ReceiveBuffer(options, self.touched)
        self._timer = LspclkTimer()
        self._levels = SIMO | SOMI | CLK | STE  # levels of the pins `_latency` cycles ago
        self._inputs: list[tuple[int, int]] = []  # levels of the pins that take effect later: (cycle, levels)
        self._last_leading = -NEVER  # cycle of the last leading edge of SPICLK at a slave
        self.reset(0)

    def reset(self, now: int) -> None:
        self._run(now)
        self._ccr = self._ctl = self._brr = self._ffct = self._pri = 0
        self._gated = True  # True if the module has no clock, because its bit in PCLKCR0 is 0
        self._suspended = False
        self._finishing = False  # True while the module still sends words although the debugger has halted the CPU
        self._halt()
        self._shifter = SpiShifter()
        self._tx.reset()
        self._rx.reset()
        self._set_clock(now)
        self._show(now)

    def _halt(self) -> None:
        """Drop the character in progress and the one in SPITXBUF. SPICLK and SPISTE of a master become inactive."""
        self._timer.cancel()
        self._step = IDLE
        self._clk_active = False  # True if SPICLK of a master is at its active level
        self._release()
        self._shifter.finish()
        self._tx.full = False

    def _release(self) -> None:
        """End the transfer of a master: SPISTE rises."""
        self._begun = False  # True if a master has made the first edge of SPICLK and has not ended the transfer yet
        self._ste = STE  # level that a master drives on SPISTE

    # State ------------------------------------------------------------------

    @property
    def _is_master(self) -> bool:
        return self._ctl & MASTER_SLAVE > 0

    @property
    def _enabled(self) -> bool:
        """True if neither SW RESET nor SPIRST holds the module in reset."""
        return self._ccr & SPISWRESET > 0 and self._tx.fifo.control & SPIRST > 0

    @property
    def _halves(self) -> tuple[int, int]:
        """Two numbers of LSPCLK cycles: for how long SPICLK is active in a bit, and for how long it is idle."""
        period = self._brr + 1 if self._brr >= 3 else 4
        return period // 2, period - period // 2

    # Inputs: pins, time, clock, debugger --------------------------------------

    def pins(self, now: int, levels: int) -> int:
        if self._latency:
            self._inputs = [(at, before) for at, before in self._inputs if at != now + self._latency]
            self._inputs.append((now + self._latency, levels))
            self._schedule()
            return WAKE_CHANGED
        late = self.next_wake < now
        if late:
            self._run(now - 1)
        shows = not self._is_master and (self._levels ^ levels) & (CLK | STE)
        self._apply_inputs(now, levels)
        return ANY_CHANGED if late or shows else NO_CHANGE

    def wake(self, now: int) -> int:
        self._run(now)
        return ANY_CHANGED

    def gate(self, now: int, on: bool) -> None:
        """Switch the module's clock on or off in cycle `now` (PCLKCR0)."""
        self._run(now)
        self._gated = not on
        self._set_clock(now)

    def set_lspclk(self, now: int, divider: int, phase: int) -> None:
        """Set the period of LSPCLK to `divider` cycles, with an edge in each cycle n with n % divider == phase."""
        if divider not in (1, 2, 4, 6, 8, 10, 12, 14):
            raise ValueError(f"LSPCLK is SYSCLKOUT / 1, 2, 4, 6, 8, 10, 12 or 14, not / {divider}")
        self._run(now)
        self._timer.set_lspclk(now, divider, phase)
        self._schedule()

    def suspend(self, now: int, on: bool) -> None:
        """Stop because the debugger has halted the CPU, as FREE and SOFT select. If `on` is False, resume."""
        self._run(now)
        was_stopped = self._is_stopped
        self._suspended = on
        self._finishing = on and (self._begun or self._shifter.bits > 0) and self._pri & SOFT > 0
        if was_stopped and self._cuts(self.options.bits_after_suspend, "whole_character"):
            self._shifter.bits = 0
        self._set_clock(now)

    @property
    def _is_stopped(self) -> bool:
        return self._suspended and not self._finishing and not self._pri & FREE

    def _set_clock(self, now: int) -> None:
        if self._gated or self._is_stopped:
            self._timer.stop(now)
        else:
            self._timer.start(now)
        self._schedule()

    # Events -----------------------------------------------------------------

    def _run(self, now: int) -> None:
        """Process everything due up to `now`, in order of time. In one cycle, inputs precede the timer's event."""
        while self.next_wake <= now:
            at = self.next_wake
            if self._inputs and self._inputs[0][0] <= at:
                self._apply_inputs(at, self._inputs.pop(0)[1])
            if self._timer.at <= at:
                self._advance(at)
                self._show(at)

    def _schedule(self) -> None:
        self.next_wake = min(self._timer.at, self._inputs[0][0]) if self._inputs else self._timer.at

    def _show(self, now: int) -> None:
        """Update outputs, requests, notes and the next wake-up."""
        if self._finishing and not (self._begun or self._shifter.busy or self._tx.waiting):
            self._finishing = False
            self._set_clock(now)
        for source, line in ((self._rx, RXINT), (self._rx.fifo, RXINT), (self._tx.fifo, TXINT)):
            if source.request:
                source.request = False
                self.requests |= line
        if self._rx.loaded:
            self._rx.loaded = False
            self.loaded |= RECEIVED
        for text in self._tx.lost:
            self._note("lost", text, "SPRUEU3 §2.1.7, §2.1.9")
        self._tx.lost.clear()
        self._set_outputs()
        self._schedule()

    def _set_outputs(self) -> None:
        levels = self._ste | (SIMO | SOMI if self._shifter.level else 0)
        if bool(self._ccr & CLKPOLARITY) != self._clk_active:
            levels |= CLK
        if self._is_master:
            self.driven = CLK | STE | (SIMO if self._ctl & TALK else 0)
        else:
            self.driven = SOMI if self._ctl & TALK and not self._levels & STE else 0
        self.out = levels & self.driven | (SIMO | SOMI | CLK | STE) & ~self.driven

    def _note(self, code: str, text: str, source: str) -> None:
        self.notes.append(Note(code, f"{self.name}: {text}", source))

    # Slave --------------------------------------------------------------------

    def _apply_inputs(self, now: int, levels: int) -> None:
        """Apply the levels of the pins. A selected slave shifts at edges of SPICLK."""
        before, self._levels = self._levels, levels
        selected = not (self._is_master or before & STE or self._gated or self._is_stopped) and self._enabled
        if selected and (before ^ levels) & CLK:
            leading = bool(levels & CLK) != bool(self._ccr & CLKPOLARITY)
            if leading:
                period, self._last_leading = now - self._last_leading, now
                if period < 4 * self._timer.divider:
                    self._note(
                        "duty",
                        f"a slave had an SPICLK period of {period} SYSCLKOUT cycles; at least four LSPCLK cycles are "
                        "expected",
                        "SPRUEU3 §1.3.2, §2.1.4",
                    )
            self._clock_edge(leading)
        if selected and levels & STE and self._cuts(self.options.ste_high_mid_character, "restarts"):
            self._shifter.bits = 0
        self._show(now)

    def _cuts(self, option: TextOption, answer: str) -> bool:
        """Return True if a character is in progress, and is cut off because `option` has the value `answer`."""
        return self._shifter.bits > 0 and option.assume(self.touched) == answer

    # Slave and master ---------------------------------------------------------

    def _clock_edge(self, leading: bool) -> bool:
        """Shift at an edge of SPICLK, as master or slave. Return True if this was the last edge of the character."""
        shifter = self._shifter
        if self._is_master and self._ccr & SPILBK:
            data = shifter.level
        else:
            self.options.input_latency.assume(self.touched)
            data = int(self._levels & (SOMI if self._is_master else SIMO) > 0)
        shifter.edge(leading, data)
        if not shifter.complete:
            return False
        if leading == (shifter.delayed and self.options.int_flag_point.assume(self.touched) == "latch_edge"):
            self._rx.deliver(shifter.dat)
        if leading:
            return False
        shifter.finish()
        if not self._is_master:
            self._load_next()
        return True

    def _load_next(self) -> None:
        if self._tx.waiting:
            self._shifter.load(self._tx.pop())
            self._shifter.present()

    # Master -------------------------------------------------------------------

    def _wait(self, now: int, step: int, edges: int) -> None:
        self._step = step
        self._timer.plan(now, edges)

    def _fill(self, now: int) -> None:
        """Load a waiting word into SPIDAT if SPIDAT has no character. A master then begins a transfer.

        With the option txdly_first_word = "delay", a master first waits for TXDLY.
        """
        if not self._enabled or self._shifter.busy or not self._tx.waiting or self._step == DELAY:
            return
        if not self._is_master:
            self._load_next()
        elif self._delay and self.options.txdly_first_word.assume(self.touched) == "delay":
            self._wait(now, DELAY, self._delay)
        else:
            self._shifter.load(self._tx.pop())
            self._begin(now)

    @property
    def _delay(self) -> int:
        """TXDLY in LSPCLK cycles; 0 in standard mode."""
        return self._ffct * sum(self._halves) if self._tx.fifo.on else 0

    def _begin(self, now: int) -> None:
        """Begin a transfer of a master, unless one is in progress."""
        if self._step in (IDLE, DELAY, RELEASE):
            aligned = self.options.start_point.assume(self.touched) == "bit_clock"
            edges = self._timer.edges_to_multiple(now, sum(self._halves)) if aligned else 1
            self._wait(now, BEGIN, edges)

    def _advance(self, at: int) -> None:
        """Process the timer event of a master."""
        step, self._step = self._step, IDLE
        self._timer.cancel()
        active, idle = self._halves
        if step == BEGIN:
            lead = 0
            if self._ste and self.options.ste_lead.assume(self.touched) == "three_half_bits":
                lead = active + idle
            self._ste = 0
            self._shifter.present()
            self._wait(at, LEADING, lead + idle)
        elif step == LEADING:
            self._begun = self._clk_active = True
            self._clock_edge(True)
            self._wait(at, TRAILING, active)
        elif step == TRAILING:
            self._clk_active = False
            if self._clock_edge(False):
                self._follow(at)
            else:
                self._wait(at, LEADING, idle)
        elif step == DELAY:
            self._ste = 0
            self._load_next()
            self._wait(at, LEADING, idle)
        elif step == RELEASE:
            self._release()

    def _follow(self, at: int) -> None:
        """After the last edge of a character, continue with the next word, wait for TXDLY, or end the transfer."""
        if not self._tx.waiting:
            if self._shifter.delayed:
                self._release()
            else:
                self._wait(at, RELEASE, self._halves[1])
        elif self._delay:
            if self.options.ste_in_txdly.assume(self.touched) == "high":
                self._ste = STE
            self._wait(at, DELAY, self._delay)
        else:
            self._load_next()
            self._wait(at, LEADING, self._halves[1])
