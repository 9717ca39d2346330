"""The SCI module: register accesses and RXD go in; TXD, RXINT and TXINT come out.

    RXD --> SciRxBits --deliver--> SciRx --> SCIRXBUF, flags, RXINT
                 ^ loop-back
    TXD <-- SciTxBits <--words---- SciTx <-- SCITXBUF, TXINT

This file joins the halves: what a register bit means to each of them, resets, rate,
loop-back, autobaud, debugger stops. `deliver` and `take_words` are the seams for line
sides coarser than edges: they leave out the bits, everything else is the same code.

Chosen, where the manual is silent:
- The clock gate is off after construction and after `reset`; LSPCLK stays as last told.
- Loop-back passes the receiver's synchroniser like the pin, and TXD shows the frames too.
- rx_int_extra delays every receive request that comes from the line (break and errors
  too); a request made by a CPU write comes at once.
- SCIRST = 0 stops both channels in standard mode too; it leaves SCIRXST as it is.
- A debugger stop with SOFT = 1 lets a frame whose start bit was accepted finish; then
  that half's clock stands still, as both do at once with SOFT = 0.
- Autobaud: the character, ABD and the new divider come together, 7/8 into the stop bit.
  CDC must be written 0 before ABD requests TXINT again.

Source: TI SPRUFZ5A; SPRUFB0D section 5.1 for the clock gate.
"""

from __future__ import annotations

from ..core.chip import ALL, NEVER, NOTHING, OUTPUTS, Note
from .sci_autobaud import SciAutobaud
from .sci_clock import SciClock
from .sci_format import SciFormat
from .sci_map import SCI_MAP
from .sci_options import SciOptions
from .sci_rx import SciRx
from .sci_rx_bits import BREAK, FE, FRAME, IDLE, PE, SciRxBits
from .sci_tx import SCIFFENA, SCIRST, SciTx, SentWord

RXINT = 1
TXINT = 2

SCICCR = SCI_MAP["SCICCR"]
LOOPBKENA = SCICCR["LOOPBKENA"].mask
SCICTL1 = SCI_MAP["SCICTL1"]
RXERRINTENA = SCICTL1["RXERRINTENA"].mask
SWRESET = SCICTL1["SWRESET"].mask
TXWAKE = SCICTL1["TXWAKE"].mask
SLEEP = SCICTL1["SLEEP"].mask
TXENA = SCICTL1["TXENA"].mask
RXENA = SCICTL1["RXENA"].mask
SCICTL2 = SCI_MAP["SCICTL2"]
RXBKINTENA = SCICTL2["RXBKINTENA"].mask
TXINTENA = SCICTL2["TXINTENA"].mask
SCIFFCT = SCI_MAP["SCIFFCT"]
ABD = SCIFFCT["ABD"].mask
ABDCLR = SCIFFCT["ABDCLR"].mask
CDC = SCIFFCT["CDC"].mask
FFTXDLY = SCIFFCT["FFTXDLY"].mask
SCIPRI = SCI_MAP["SCIPRI"]
SOFT = SCIPRI["SOFT"].mask
FREE = SCIPRI["FREE"].mask

# Word offsets, as in SCI_MAP.
CCR, CTL1, HBAUD, LBAUD, CTL2, RXST, RXEMU, RXBUF = range(8)
TXBUF, FFTX, FFRX, FFCT, PRI = 0x9, 0xA, 0xB, 0xC, 0xF

LINE_QUESTIONS = ("rxrdy_point", "rx_sync_stages")  # every frame that comes as levels depends on them

AUTOBAUD_LEAST_BIT = 300  # cycles: 500 kbit/s at SYSCLKOUT = 150 MHz


class Sci:
    """name: as notes call the module. options: answers to open questions."""

    MAP = SCI_MAP
    INPUTS: tuple[str, ...] = ("RXD",)
    OUTPUTS: tuple[str, ...] = ("TXD",)
    LINES: tuple[str, ...] = ("RXINT", "TXINT")

    def __init__(self, name: str = "SCI-A", options: SciOptions = SciOptions()) -> None:  # noqa: B008 (frozen)
        self.name = name
        self.options = options
        self.next_wake = NEVER
        self.out = 1
        self.requests = 0
        self.held = 0
        self.notes: list[Note] = []
        self.touched: set[str] = set()
        self._layout = SciFormat(0, options)
        self._rx_clock = SciClock()
        self._tx_clock = SciClock()
        self._bits = SciRxBits(self._layout, options.idle_before_first_frame, self.touched)
        self._rx = SciRx(options, self.touched)
        self._tx = SciTx(options, self._tx_clock, self._layout, self.touched)
        self._autobaud = SciAutobaud()
        self.filter_width = self._sync = options.rx_sync_stages
        self._int_extra = options.rx_int_extra
        self._idle_sets_wake = options.rxwake_idle_point == "tenth_bit"
        self._format_at_once = options.format_write_effect == "at_once"
        self._brr_at_once = options.brr_write_effect == "at_once"
        self._rxd = 1
        self._gated = True  # the clock gate is off
        self._suspended = False
        self._rx_stopping = False  # the receiver's clock stops when its frame is complete
        self._ccr = 0
        self._ctl1 = 0  # without TXWAKE, which lives in SciTx
        self._hbaud = 0
        self._lbaud = 0
        self._ffct = 0
        self._pri = 0
        self._abd_asked = False  # ABD has requested TXINT since CDC was set
        self._listening = False  # the bit receiver follows the line
        self._word_line = False
        # When each part has something to do, in cycles.
        self._rx_at = NEVER
        self._tx_at = NEVER
        self._request_at = NEVER

    # The seams for coarser line sides ---------------------------------------

    def deliver(self, now: int, word: int, address_bit: int = 0) -> None:
        """A frame is complete at `now`.

        word: data with its marks, FE in bit 15 and PE in bit 14. address_bit: the address
        bit; in idle-line mode 1 when at least ten idle bits came before. Lost while SW
        RESET, SCIRST, the clock gate or a debugger hold the module.
        """
        self._run(now)
        if not self._rx_clock.running:
            self._note("lost", f"a frame {word & 0xFF:#04x} came while the module had no clock", "SPRUFB0D §5.1.1")
        elif self._autobaud.armed:
            if word in (0x41, 0x61):
                self._set_abd()
                self._arm_receiver(now)
                self._move(now, word, address_bit)
        elif self._tx.running:
            self._move(now, word, address_bit)
        self._watch_idle(now)
        self._schedule()

    def deliver_break(self, now: int) -> None:
        """A break is complete at `now`; its first frame was delivered before, with FE."""
        self._run(now)
        if self._rx_clock.running and self._tx.running:
            self._take_break(now)
        self._schedule()

    def take_words(self) -> list[SentWord]:
        """From now on words come out in the list returned, which the owner empties, and TXD stays at 1.

        In loop-back frames are made as ever, for the module itself.
        """
        self._word_line = True
        self._tx.word_line = not self._ccr & LOOPBKENA
        return self._tx.sent

    # Inputs: pin, time, clock, debugger -------------------------------------

    def pins(self, now: int, levels: int) -> int:
        level = levels & 1
        if level == self._rxd:
            return NOTHING
        planned = self.next_wake
        if now > planned:
            self._run(now - 1)
        self._rxd = level
        if not self._ccr & LOOPBKENA:
            self._line(now, level)
        if now > planned:
            return ALL
        return OUTPUTS if self.next_wake != planned else NOTHING  # what an edge does shows with a wake-up

    def wake(self, now: int) -> int:
        self._run(now)
        return ALL

    def gate(self, now: int, on: bool) -> None:
        """The module's bit in PCLKCR0."""
        self._run(now)
        self._gated = not on
        self._set_clocks(now, self._tx.stopping)

    def set_lspclk(self, now: int, divider: int, phase: int) -> None:
        """LSPCLK has a period of `divider` SYSCLKOUT cycles, with edges at cycles = phase mod divider."""
        if divider not in (1, 2, 4, 6, 8, 10, 12, 14):
            raise ValueError(f"LSPCLK is SYSCLKOUT / 1, 2, 4, 6, 8, 10, 12 or 14, not / {divider}")
        self._run(now)
        self._rx_clock.set_lspclk(now, divider, phase)
        self._tx_clock.set_lspclk(now, divider, phase)
        self._replan()

    def suspend(self, now: int, on: bool) -> None:
        """A debugger stops the CPU, or lets it run again."""
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
        """The receiver's input is at `level` from `now` on."""
        if self._autobaud.armed:
            self._autobaud.edge(now, level)
            self._schedule()
        if self._bits.toggle(self._rx_clock.from_cycle(now + self._sync), level):
            self._rx_at = self._rx_clock.at(self._bits.next_tick)
            self._schedule()

    # What is due ------------------------------------------------------------

    def _run(self, now: int) -> None:
        """Everything due up to `now`, in order of time."""
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
        """The clocks or what the halves wait for have changed."""
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
        level = self._tx.bits.level
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
                self.touched.update(LINE_QUESTIONS)
                if bits.address and not self._layout.address:
                    self.touched.add("rxwake_idle_point")
                self._move(at, bits.word, bits.address)
                if self._rx_stopping:
                    self._rx_stopping = False
                    self._rx_clock.stop(at)
            elif event == IDLE:
                self.touched.add("rxwake_idle_point")
                self._rx.line_idle()
            elif event == BREAK:
                self._take_break(at)
        self._watch_idle(at)
        self._rx_at = self._rx_clock.at(bits.next_tick)

    def _move(self, now: int, word: int, address: int) -> None:
        """A character leaves RXSHF."""
        rx = self._rx
        rx.deliver(word, address, bool(word & FE) and self._is_break_like(word, address))
        if rx.request:
            self._request_rx(now)

    def _is_break_like(self, word: int, address: int) -> bool:
        """Every bit of the frame was 0; of the parity bit PE tells that."""
        if word & ~PE != FE or (address and self._layout.address):
            return False
        return not self._layout.parity or bool(word & PE) != self._layout.even

    def _take_break(self, now: int) -> None:
        if self._rx.line_break():
            self.touched.add("rx_after_break")
            if self.options.rx_after_break == "blocked":
                self._bits.close()
        if self._rx.request:
            self._request_rx(now)

    def _request_rx(self, now: int) -> None:
        """A receive request that comes from the line."""
        self._rx.request = False
        self.touched.add("rx_int_extra")
        if self._int_extra:
            self._request_at = min(self._request_at, now + self._int_extra)
        else:
            self.requests |= RXINT

    def _watch_idle(self, now: int) -> None:
        """Ask for the tenth idle bit where somebody could see it."""
        rx = self._rx
        watch = self._idle_sets_wake and rx.enabled and not rx.waked and not self._layout.address
        if watch != self._bits.watch_idle:
            self._bits.set_watch(self._rx_clock.passed(now), watch)
            self._rx_at = self._rx_clock.at(self._bits.next_tick)

    # Autobaud ---------------------------------------------------------------

    def _finish_autobaud(self, at: int) -> None:
        auto = self._autobaud
        clock = self._rx_clock
        self.touched.add("autobaud_brr_rule")
        brr = auto.brr(clock.divider, clock.phase, self.options.autobaud_brr_rule == "nearest")
        self._hbaud, self._lbaud = brr >> 8, brr & 0xFF
        self._set_brr(at)
        word = auto.character
        self._set_abd()
        self._arm_receiver(at)
        self._move(at, word, 0)
        self._replan()

    def _set_abd(self) -> None:
        self._ffct |= ABD
        if not self._abd_asked:
            self._abd_asked = True
            self.requests |= TXINT

    def _arm_receiver(self, now: int) -> None:
        """Who listens to RXD: nobody in reset, autobaud while it waits, else the bit receiver."""
        listening = self._tx.running
        waits = listening and self._ffct & (CDC | ABD) == CDC
        was_listening = self._listening
        self._autobaud.arm(waits)
        self._listening = listening and not waits
        if self._listening and not was_listening:
            self._bits.open(self._rx_clock.passed(now) + 1)
        elif was_listening and not self._listening:
            self._bits.close()

    # CPU access -------------------------------------------------------------

    def read(self, now: int, offset: int) -> int:
        if now >= self.next_wake:
            self._run(now)
        if self._gated and self._no_clock("read"):
            return 0
        if offset == RXBUF:
            return self._read_rxbuf(now)
        if offset == RXST and self._rx.fifo_mode and self._rx.fifo.words:
            self.touched.add("rxrdy_in_fifo_mode")
        elif offset == CTL2 and self._tx.fifo_mode and self._tx.fifo.words:
            self.touched.add("txrdy_in_fifo_mode")
        return self._show(now, offset)

    def peek(self, now: int, offset: int) -> int:
        if now >= self.next_wake:
            self._run(now)
        return self._show(now, offset)

    def write(self, now: int, offset: int, value: int) -> None:
        if now >= self.next_wake:
            self._run(now)
        if self._gated and self._no_clock("written"):
            return
        if offset == TXBUF:
            self._tx.write_buffer(now, value)
        elif offset == FFTX:
            self._write_fftx(now, value)
        elif offset == FFRX:
            self._rx.write_fifo(value)
        elif offset == CCR:
            self._write_ccr(now, value)
        elif offset == CTL1:
            self._write_ctl1(now, value)
        elif offset == HBAUD:
            self._hbaud = value & 0xFF
            self._set_brr(now)
        elif offset == LBAUD:
            self._lbaud = value & 0xFF
            self._set_brr(now)
        elif offset == CTL2:
            self._rx.set_enables(bool(value & RXBKINTENA), bool(self._ctl1 & RXERRINTENA))
            self._tx.set_int_enabled(bool(value & TXINTENA))
        elif offset == FFCT:
            self._write_ffct(now, value)
        elif offset == PRI:
            self._pri = value & (SOFT | FREE)
        else:
            self._check_offset(offset)
        self._after_write(now)

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

    def _read_rxbuf(self, now: int) -> int:
        rx = self._rx
        word = rx.read_buffer()
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
            return rx.show_fifo()
        if offset == RXBUF:
            return rx.show_buffer()
        if offset == RXEMU:
            return rx.show_buffer() & 0xFF
        if offset == CTL2:
            enables = (RXBKINTENA if rx.bk_enabled else 0) | (TXINTENA if tx.int_enabled else 0)
            return tx.show_flags(now) | enables
        if offset == FFTX:
            return tx.show_fifo()
        if offset == TXBUF:
            return tx.txbuf
        if offset == CTL1:
            return self._ctl1 | (TXWAKE if tx.txwake else 0)
        if offset == CCR:
            return self._ccr
        if offset == HBAUD:
            return self._hbaud
        if offset == LBAUD:
            return self._lbaud
        if offset == FFCT:
            return self._ffct
        if offset == PRI:
            return self._pri
        self._check_offset(offset)
        return 0

    def _check_offset(self, offset: int) -> None:
        if not 0 <= offset <= 0xF:
            raise ValueError(f"{self.name} has offsets 0 to 0xF, not {offset:#x}")

    def _no_clock(self, what: str) -> bool:
        """True if an access without a clock finds nothing."""
        self.touched.add("clock_gate_access")
        self._note(
            "duty", f"was {what} while its PCLKCR0 bit is 0; the clock is to be turned on first", "SPRUFB0D §5.1.1"
        )
        return self.options.clock_gate_access == "reads_0"

    def _note(self, code: str, text: str, source: str) -> None:
        self.notes.append(Note(code, f"{self.name}: {text}", source))

    def _set_brr(self, now: int) -> None:
        brr = self._hbaud << 8 | self._lbaud
        self.touched.add("brr_write_effect")
        self._rx_clock.set_brr(now, brr, self._brr_at_once)
        self._tx_clock.set_brr(now, brr, self._brr_at_once)

    def _write_ccr(self, now: int, value: int) -> None:
        before = self._ccr
        self._ccr = value & 0xFF
        self._layout = SciFormat(self._ccr, self.options)
        self._rx.parity = self._layout.parity
        tick = self._rx_clock.passed(now)
        self._bits.settle(tick)
        if self._bits.framed or self._tx.active:
            self.touched.add("format_write_effect")
        self._bits.set_layout(tick, self._layout, self._format_at_once)
        self._tx.set_layout(now, self._layout, self._format_at_once)
        if (before ^ self._ccr) & LOOPBKENA:
            looped = self._ccr & LOOPBKENA
            self._tx.word_line = self._word_line and not looped
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
                self._enter_swreset()
            self._set_running(now)

    def _enter_swreset(self) -> None:
        self._tx.halt()
        self._rx.clear_flags()
        if self._rx.fifo.words or self._tx.fifo.words:
            self.touched.add("swreset_fifo_effect")
        if self.options.swreset_fifo_effect == "cleared":
            self._rx.clear_fifo()
            self._tx.clear_fifo()

    def _write_fftx(self, now: int, value: int) -> None:
        tx = self._tx
        before = tx.scifftx
        tx.write_fifo(now, value)
        self._rx.set_fifo_mode(bool(tx.scifftx & SCIFFENA))
        if (before ^ value) & SCIRST:
            if not value & SCIRST:
                tx.halt()
                self.touched.add("scirst_scope")
                if self.options.scirst_scope == "shifters_and_fifos":
                    self._rx.clear_fifo()
                    tx.clear_fifo()
            self._set_running(now)

    def _set_running(self, now: int) -> None:
        """SW RESET or SCIRST has changed."""
        if self._ctl1 & SWRESET and self._tx.scifftx & SCIRST:
            self._tx.release(now)
        self._arm_receiver(now)

    def _write_ffct(self, now: int, value: int) -> None:
        before = self._ffct
        self._ffct, strobes = SCIFFCT.write(before, value)
        if strobes & ABDCLR:
            self._ffct &= ~ABD
        if not self._ffct & CDC:
            self._abd_asked = False
        elif not before & CDC and self._rx_clock.brr != 1 and 8 * self._rx_clock.period < AUTOBAUD_LEAST_BIT:
            self._note(
                "duty",
                f"CDC was set with BRR = {self._rx_clock.brr}, over 500 kbit/s; expected is 1 or a slower rate",
                "SPRUFZ5A §1.2.10.3",
            )
        self._tx.delay = self._ffct & FFTXDLY
        self._tx.replan(now)
        self._arm_receiver(now)

    # System reset -----------------------------------------------------------

    def reset(self, now: int) -> None:
        self._run(now)
        self._ccr = self._ctl1 = self._hbaud = self._lbaud = self._ffct = self._pri = 0
        self._gated = True
        self._suspended = self._rx_stopping = False
        self._abd_asked = False
        self._request_at = NEVER
        self._rx_clock.stop(now)
        self._tx_clock.stop(now)
        self._rx_clock.reset()
        self._tx_clock.reset()
        self._layout = SciFormat(0, self.options)
        self._rx.reset()
        self._tx.reset()
        self._tx.set_layout(now, self._layout, False)
        self._tx.word_line = self._word_line
        self._arm_receiver(now)
        self._bits.set_layout(self._rx_clock.passed(now), self._layout, False)
        self._line(now, self._rxd)
        self._after_write(now)
