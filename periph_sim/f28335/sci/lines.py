"""Line side of the SCI module: RXD and TXD, the requests RXINT and TXINT, clocks, debugger stops and scheduling.

    RXD --> SciRxBits --deliver--> SciRx --> RXINT
                 ^ loop-back
    TXD <-------------------------- SciTx --> TXINT

The CPU's side in `module` configures receiver and transmitter.

Chosen, where the manual is silent:
- In loop-back the level of TXD passes through the receiver's synchroniser in place of the level of RXD. The frames are
  also on the pin TXD. The autobaud detector receives its levels before the synchroniser.
- rx_int_extra delays every receive request that the line causes, including those of breaks and errors. A request that a
  CPU access causes is immediate.
- When the debugger halts the CPU with FREE = 0 and SOFT = 1, each direction completes its frame in progress. Then its
  clock stops. In the receiver, a frame is in progress after its start bit was accepted, until it is complete or a break
  drops it. With SOFT = 0 both clocks stop at once.
- Reception that a break has ended (option rx_after_break) begins again only after SW RESET or a system reset, not after
  SCIRST = 0, a change of CDC, or autobaud. Autobaud then sets ABD and the divider, but its character is not received.
- In autobaud three things happen in the same cycle, after 7/8 of the stop bit: the character is received, ABD is set,
  and the baud divider is set.

Source: TI SPRUFZ5A; SPRUFB0D section 5.1 for the clock gate.
"""

# core: compiled

from __future__ import annotations

from ...core.chip import ANY_CHANGED, NEVER, NO_CHANGE, PINS_CHANGED, Chip, Note
from ...core.state import State
from .autobaud import SciAutobaud
from .character_format import SciFormat
from .clock import SciClock
from .options import SciOptions
from .receiver import SciRx
from .receiver_bits import BREAK, FAR, FE, FRAME, IDLE, IDLE_TICKS, PE, SciRxBits
from .register_map import ABD, CDC, FREE, LOOPBKENA, SCI_MAP, SOFT, ST_BRKDT, ST_RXWAKE
from .transmitter import SciTx

RECEIVED = 1 << SCI_MAP["SCIRXBUF"].offset | 1 << SCI_MAP["SCIRXEMU"].offset

RXINT = 1
TXINT = 2

SHORT_BREAK = (
    "RX was low for longer than a character, but rose before BRKDT, which needs ten low bits after the missing "
    "stop bit; a break of LIN has 13 in all"
)


# Attributes of receiver and transmitter that are numbers of SCICLK ticks.
RX_TICKS = ("next_tick", "_low_from", "_high_from", "_idle_base", "_start", "_missing_stop", "_break_at")
TX_TICKS = ("next_tick", "_began", "_end", "_last_end", "_start_at", "_load_at", "_edge_at")
LONGEST_PAUSE = 256  # length of the pause that FFTXDLY = 255 may select, in `fftxdly_unit` (option `fftxdly_max`)


def since(tick: int, now: int, least: int) -> int:
    """Return a tick relative to `now`, but at least `least`. A tick that no run reaches is returned as it is."""
    return tick if abs(tick) >= FAR else max(tick - now, least)


class SciLines(Chip):
    """Base class of the SCI: its pins, receiver, transmitter and clocks. The subclass `Sci` adds register accesses.

    name: the module's name in notes. options: answers to open questions of the manual.
    """

    STATE = State(
        "_layout _rx_clock _tx_clock _bits _rx _tx _autobaud _rxd _gated _suspended _rx_stopping _ccr "
        "_ctl1 _ffct _pri _abd_requested _listening",
        cycles="_rx_at _tx_at _request_at",
    )

    MAP = SCI_MAP
    _sync: int
    INPUTS: tuple[str, ...] = ("RXD",)
    OUTPUTS: tuple[str, ...] = ("TXD",)

    def __init__(self, name: str = "SCI-A", options: SciOptions = SciOptions()) -> None:  # noqa: B008 (frozen)
        super().__init__()
        self.name = name
        self.options = options
        self.out = 1
        self._layout = SciFormat(0, options)
        self._rx_clock = SciClock()
        self._tx_clock = SciClock()
        self._bits = SciRxBits(self._layout, options, self.touched)
        self._rx = SciRx(options, self.touched)
        self._tx = SciTx(options, self._tx_clock, self._layout, self.touched)
        self._autobaud = SciAutobaud()
        self.filter_width = self._sync = options.rx_sync_stages.unrecorded()  # `_run_rx` records the use of the option
        self._rxd = 1
        self._listening = False  # True if the bit receiver evaluates the line
        self._rx_at = self._tx_at = NEVER  # cycles of the next events of receiver and transmitter
        self.reset(0)

    def reset(self, now: int) -> None:
        self._run(now)
        self._ccr = self._ffct = self._pri = 0
        self._ctl1 = 0  # SCICTL1 without TXWAKE, which `SciTx` has
        self._gated = True  # True if the module has no clock, because its bit in PCLKCR0 is 0
        self._suspended = False
        self._rx_stopping = False  # True if the receiver's clock stops when its frame is complete
        self._abd_requested = False  # True if ABD has requested TXINT since CDC was set
        self._request_at = NEVER
        self._rx_clock.reset(now)
        self._tx_clock.reset(now)
        self._layout = SciFormat(0, self.options)
        self._rx.reset()
        self._tx.reset()
        self._tx.set_layout(now, self._layout, False)
        self._arm_receiver(now)
        self._bits.set_layout(self._rx_clock.passed(now), self._layout, False)
        self._line(now, self._rxd)
        self._after_write(now)

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return the SCICLK ticks in the state, counted from the present SCICLK tick. See `proof.normal_state`."""
        received, sent = self._rx_clock.passed(cycle), self._tx_clock.passed(cycle)
        pause = -8 * (LONGEST_PAUSE if self._tx.delay == LONGEST_PAUSE - 1 else self._tx.delay) - 1
        found: dict[str, object] = {
            f"_bits.{name}": since(getattr(self._bits, name), received, -IDLE_TICKS - 1) for name in RX_TICKS
        }
        found |= {f"_tx.{name}": since(getattr(self._tx, name), sent, pause) for name in TX_TICKS}
        found["_bits._toggles"] = tuple([at - received for at in self._bits._toggles])
        found["_tx._edges"] = tuple([at - sent for at in self._tx._edges])
        if self.options.tx_phase.unrecorded() == "next_bit_tick":
            found["_tx_clock._tick"] = sent % 8
        return found

    @property
    def marks(self) -> SciTx:
        """The transmitter, which stores the mark (see `WriteOrigins`) of each word until the word has been sent."""
        return self._tx

    # Inputs: pin, time, clock, debugger -------------------------------------

    def pins(self, now: int, levels: int) -> int:
        level = levels & 1
        if level == self._rxd:
            return NO_CHANGE
        planned = self.next_wake
        if now > planned:
            self._run(now - 1)
        self._rxd = level
        if not self._ccr & LOOPBKENA:
            self._line(now, level)
        if now > planned:
            return ANY_CHANGED
        return PINS_CHANGED if self.next_wake != planned else NO_CHANGE  # the edge takes effect in a later wake-up

    def wake(self, now: int) -> int:
        self._run(now)
        return ANY_CHANGED

    def gate(self, now: int, on: bool) -> None:
        """Switch the module's clock on or off in cycle `now` (PCLKCR0)."""
        self._run(now)
        self._gated = not on
        self._set_clocks(now, self._tx.stopping)

    def set_lspclk(self, now: int, divider: int, phase: int) -> None:
        """Set the period of LSPCLK to `divider` cycles, with an edge in each cycle n with n % divider == phase."""
        self._run(now)
        self._rx_clock.set_lspclk(now, divider, phase)
        self._tx_clock.set_lspclk(now, divider, phase)
        self._replan()

    def suspend(self, now: int, on: bool) -> None:
        """Stop because the debugger has halted the CPU, as FREE and SOFT select. If `on` is False, resume."""
        self._run(now)
        self._suspended = on
        self._rx_stopping = False
        tx_finishes = False
        if on and not self._pri & FREE:
            rx_tick = self._rx_clock.passed(now)
            self._bits.settle(rx_tick)
            soft = bool(self._pri & SOFT)
            self._rx_stopping = soft and self._bits.framed
            tx_finishes = soft and self._tx.active
        self._set_clocks(now, tx_finishes)

    def _set_clocks(self, now: int, tx_finishes: bool) -> None:
        stopped = self._suspended and not self._pri & FREE
        for clock, finishes in ((self._rx_clock, self._rx_stopping), (self._tx_clock, tx_finishes)):
            if self._gated or (stopped and not finishes):
                clock.stop(now)
            else:
                clock.start(now)
        self._tx.resume(now)
        self._tx.stopping = tx_finishes
        self._replan()

    def _line(self, now: int, level: int) -> None:
        """Set the level of the receiver's input from `now` on."""
        if self._autobaud.armed:
            self._autobaud.edge(now, level)
            self._schedule()
        if self._bits.toggle(self._rx_clock.from_cycle(now + self._sync), level):
            self._rx_at = self._rx_clock.at(self._bits.next_tick)
            self._schedule()

    # Events -----------------------------------------------------------------

    def _run(self, now: int) -> None:
        """Process everything due up to `now`, in order of time."""
        while self.next_wake <= now:
            at = self.next_wake
            if self._tx_at <= at:
                self._run_tx(at)
            if self._rx_at <= at:
                self._run_rx(at)
            if self._autobaud.due <= at:
                self._finish_autobaud(at)
            if self._request_at <= at:
                self._request_at = NEVER
                self.requests |= RXINT
            self._schedule()

    def _schedule(self) -> None:
        due = self._rx_at if self._rx_at < self._tx_at else self._tx_at
        if self._request_at < due:
            due = self._request_at
        if self._autobaud.due < due:
            due = self._autobaud.due
        self.next_wake = due

    def _replan(self) -> None:
        """Compute the next wake-up after a change of the clocks or of the next events of receiver and transmitter."""
        self._plan_tx()
        self._rx_at = self._rx_clock.at(self._bits.next_tick)
        self._schedule()

    def _plan_tx(self) -> None:
        due = self._tx_clock.at(self._tx.next_tick)
        between = self._tx.next_cycle
        self._tx_at = due if due < between else between

    def _run_tx(self, at: int) -> None:
        tx = self._tx
        tx.run(at)
        if tx.request:
            tx.request = False
            self.requests |= TXINT
        if tx.stopping and not tx.active:
            tx.stopping = False
            self._tx_clock.stop(at)
        self._plan_tx()
        self._set_out(at)

    def _set_out(self, now: int) -> None:
        level = self._tx.level
        if level != self.out:
            self.out = level
            if self._ccr & LOOPBKENA:
                self._line(now, level)

    def _run_rx(self, at: int) -> None:
        bits = self._bits
        tick = self._rx_clock.passed(at)
        while bits.next_tick <= tick:
            event = bits.step(tick)
            if event == FRAME:
                self.options.rxrdy_point.assume(self.touched)
                self.options.rx_sync_stages.assume(self.touched)
                if bits.address and not self._layout.address:
                    self.options.rxwake_idle_point.assume(self.touched)
                self._move(at, bits.word, bits.address)
            elif event == IDLE:
                if self.options.rxwake_idle_point.assume(self.touched) == "tenth_bit" and self._rx.enabled:
                    self._rx.status |= ST_RXWAKE
            elif event == BREAK:
                if self._rx.line_break():
                    self._arm_receiver(at)
                self._request_rx(at)
            if self._rx_stopping and event in (FRAME, BREAK):  # a break drops the frame in progress
                self._rx_stopping = False
                self._rx_clock.stop(at)
        if bits.short_break:
            bits.short_break = False
            if self._rx.enabled:
                self._note("lost", SHORT_BREAK, "SPRUFZ5A T2-7")
        self._watch_idle(at)
        self._rx_at = self._rx_clock.at(bits.next_tick)

    def _move(self, now: int, word: int, address: int) -> None:
        """Pass a received character to `SciRx`, which moves it to SCIRXBUF or the FIFO or drops it."""
        rx = self._rx
        rx.deliver(word, address, bool(word & FE) and self._is_break_like(word, address))
        self._load_received()
        self._request_rx(now)

    def _load_received(self) -> None:
        """Report a new word in SCIRXBUF, even one that is equal to the old word, in `Chip.loaded`."""
        if self._rx.loaded:
            self._rx.loaded = False
            self.loaded |= RECEIVED

    def _is_break_like(self, word: int, address: int) -> bool:
        """Return True if every bit of the frame, up to the first stop bit, was 0.

        word: the received word with the flags FE and PE. The parity bit is derived from PE.
        """
        if word & ~PE != FE or (address and self._layout.address):
            return False
        return not self._layout.parity or bool(word & PE) != self._layout.even

    def _request_rx(self, now: int) -> None:
        """Request RXINT, after the delay `rx_int_extra`, if an event on the line has set `SciRx.request`."""
        if not self._rx.request:
            return
        self._rx.request = False
        extra = self.options.rx_int_extra.assume(self.touched)
        if extra:
            self._request_at = min(self._request_at, now + extra)
        else:
            self.requests |= RXINT

    def _watch_idle(self, now: int) -> None:
        """Make the bit receiver report idle lines only while an idle line can set RXWAKE."""
        rx = self._rx
        watch = rx.enabled and not rx.status & ST_RXWAKE and not self._layout.address
        if watch != self._bits.watch_idle:
            self._bits.set_watch(self._rx_clock.passed(now), watch)
            self._rx_at = self._rx_clock.at(self._bits.next_tick)

    # Autobaud ---------------------------------------------------------------

    def _finish_autobaud(self, at: int) -> None:
        auto = self._autobaud
        clock = self._rx_clock
        brr = auto.brr(clock.divider, clock.phase, self.options.autobaud_brr_rule.assume(self.touched) == "nearest")
        self._set_brr(at, brr)
        word = auto.character
        self._ffct |= ABD
        if not self._abd_requested:
            self._abd_requested = True
            self.requests |= TXINT
        self._arm_receiver(at)
        if not self._is_blocked():
            self._move(at, word, 0)
        self._replan()

    def _arm_receiver(self, now: int) -> None:
        """Connect RXD to the autobaud detector if CDC = 1 and ABD = 0, else to the bit receiver if no break blocks it.

        While SW RESET = 0 or SCIRST = 0, connect RXD to neither of them.
        """
        listening = self._tx.running
        waits = listening and self._ffct & (CDC | ABD) == CDC
        was_listening = self._listening
        self._autobaud.arm(waits)
        self._listening = listening and not waits and not self._is_blocked()
        if self._listening and not was_listening:
            self._bits.open(self._rx_clock.passed(now) + 1)
        elif was_listening and not self._listening:
            self._bits.close()

    def _is_blocked(self) -> bool:
        """Return True if nothing is received because BRKDT = 1, as the option rx_after_break selects."""
        return self._rx.status & ST_BRKDT > 0 and self.options.rx_after_break.assume(self.touched) == "blocked"

    # Register effects ---------------------------------------------------------

    def _after_write(self, now: int) -> None:
        rx, tx = self._rx, self._tx
        if rx.request:
            rx.request = False
            self.requests |= RXINT
        if tx.request:
            tx.request = False
            self.requests |= TXINT
        for text in tx.lost:
            self._note("lost", text, "SPRUFZ5A T2-6, T2-9")
        tx.lost.clear()
        self._set_out(now)
        self._watch_idle(now)
        self._replan()

    def _note(self, code: str, text: str, source: str) -> None:
        self.notes.append(Note(code, f"{self.name}: {text}", source))

    def _set_brr(self, now: int, brr: int) -> None:
        at_once = self.options.brr_write_effect.assume(self.touched) == "at_once"
        self._rx_clock.set_brr(now, brr, at_once)
        self._tx_clock.set_brr(now, brr, at_once)
