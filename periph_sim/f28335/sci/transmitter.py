"""SCI transmitter: sends frames from SCITXBUF and the FIFO, with flags and the transmit request.

    write --> SCITXBUF or FIFO --load--> TXSHF, WUT --start--> [ticks of the edges] --> level
                                  |
                                  +--> TXRDY, TXFFST, TXFFINT --> request

Times are SCICLK ticks. With the default options a word is loaded into TXSHF at the tick of its start bit.

Chosen, where the manual is silent:
- TXWAKE works in FIFO mode as in standard mode: it applies to the next word that is loaded into TXSHF.
- A word that is written less than FFTXDLY after the end of the previous word waits for the rest of FFTXDLY.
- SCIFFENA selects whether words are sent from the FIFO or from SCITXBUF. When it changes, both keep their words. A
  word that waits in SCITXBUF stays there in FIFO mode: writes add words to the FIFO only.
- Words written to the FIFO while SW RESET = 0 wait. So do words written while SCIRST = 0, if scirst_scope = "shifters".
- If SW RESET sets TXRDY to 1, TXINT is not requested.
- TXFIFOXRESET = 0 does not prevent TXFFINT: the FIFO is empty then, so TXFFST <= TXFFIL for every TXFFIL.

Source: TI SPRUFZ5A sections 1.2.3 to 1.2.10, tables 2-4, 2-6, 2-9, 2-11.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER
from ...core.state import State
from ..interrupt_fifo import InterruptFifo
from .character_format import SciFormat
from .clock import SciClock
from .options import SciOptions
from .receiver_bits import FAR
from .register_map import SCI_MAP, SCIFFENA, SCIRST, TXEMPTY, TXRDY


@final
class SciTx:
    """The transmitter.

    The mark of a word is the number of the record of the write that put the word in SCITXBUF. An entry of the FIFO has
    a word in its low eight bits, and the mark of this word in the bits above.

    level: level of TXD.
    wut: True if TXWAKE was 1 when the word in TXSHF was loaded (WUT in the manual). If so, the word is sent
        with address bit 1 in address-bit mode, and replaced by an idle time in idle-line mode.
    request: True if TXINT was requested since the owner last set this to False.
    mark: the mark of the next word that is written to SCITXBUF; set by the owner.
    out_mark: the mark of the word that is being sent or was sent last; 0 after a reset of the transmitter.
    """

    STATE = State(
        "request level frames lost enabled running in_swreset stopping int_enabled delay "
        "txbuf txwake wut fifo fifo_mode active next_tick _layout _waiting _drain _loaded _txshf "
        "_data_frame _began _end _last_end _start_at _load_at _edges _edge_at",
        cycles="next_cycle _load_cycle _empty_until",
        records="mark out_mark _txbuf_mark _txshf_mark",
        results="frames",
        expires="_empty_until",
    )

    def __init__(self, options: SciOptions, clock: SciClock, layout: SciFormat, touched: set[str]) -> None:
        self.options = options
        self.touched = touched
        self.frames = 0  # number of frames whose start bits have begun, since construction
        self.lost: list[str] = []  # texts of notes about lost words; the owner adds the notes and clears this list
        self.mark = 0
        self._edges: list[int] = []  # ticks of the coming edges, the last one first
        self.fifo = InterruptFifo(SCI_MAP["SCIFFTX"], False, options.fifo_int_mode, touched)
        self._clock = clock
        self._layout = layout
        self._txshf = 0
        self._txbuf_mark = 0
        self._txshf_mark = 0
        self._began = 0  # first tick of the frame or idle time that is being sent
        self.reset()

    # Resets -----------------------------------------------------------------

    def reset(self) -> None:
        """Reset by XRS."""
        self.halt()
        self.request = False
        # Enables and modes, copied here from the registers of the whole module.
        self.enabled = False  # TXENA
        self.in_swreset = True
        self.stopping = False  # True if the transmitter stops after the present frame, because the debugger halted it
        self.int_enabled = False
        self.delay = 0  # FFTXDLY
        self.fifo_mode = False  # SCIFFENA
        # The transmitter's own state.
        self.txbuf = 0
        self.txwake = False
        self.fifo.reset()

    def halt(self) -> None:
        """Stop and reset the transmitter: unsent words in SCITXBUF and TXSHF are lost, and TXD becomes 1."""
        self.running = False  # True if neither SW RESET nor SCIRST holds the transmitter in reset
        self.active = False  # True if a frame or an idle time is being sent
        self.wut = False
        self._waiting = False  # True if SCITXBUF holds a character
        self._drain = 0  # number of words that are still sent although TXENA = 0
        self._loaded = False  # True if TXSHF holds a word whose start bit has not begun
        self._data_frame = False  # True if the present or last transmission is a frame, not an idle time
        self._end = FAR  # tick at which the frame or idle time ends
        self._start_at = FAR  # tick of the next start bit
        self._load_at = FAR  # tick of the next load
        self._load_cycle = NEVER  # cycle of the next load, if it is due at an LSPCLK edge, not at an SCICLK tick
        self._last_end = -FAR  # tick at which the last frame or idle time ended
        self._empty_until = 0  # before this cycle TXEMPTY still reads 1, although a word was written (`txempty_fall`)
        self.level = 1
        self._edge_at = FAR  # tick at which the level changes next
        self.out_mark = 0
        self.next_tick = FAR
        # The SYSCLKOUT cycle of the next event that is not due at an SCICLK tick: `_load_cycle` or `_empty_until`.
        self.next_cycle = NEVER

    def release(self, now: int) -> None:
        """Release the transmitter from reset."""
        self.running = True
        self.replan(now)

    def clear_fifo(self) -> None:
        """Empty the FIFO and clear TXFFINT. No interrupt is requested.

        In FIFO mode the empty FIFO may then set TXFFINT at once, because TXFFST <= TXFFIL.
        """
        self.fifo.clear()
        self.fifo.watch(self.fifo_mode and not self._is_held())

    # Time -------------------------------------------------------------------

    def run(self, now: int) -> None:
        """Process what is due at `now`: the load of a word, the end of a frame, a start bit, or an edge."""
        tick = self._clock.passed(now)
        if self.stopping and self._end <= tick:
            self._finish()
            self._set_next(now)
            return
        if (self._load_cycle <= now and self._clock.running) or self._load_at <= tick:
            self._load()
        if self._end <= tick:
            self._finish()
        if self._start_at <= tick:
            self._start(now)
        if self._edge_at <= tick:
            self._edges.pop()
            self.level ^= 1
            self._edge_at = self._edges[-1] if self._edges else FAR
        self._set_next(now)

    def replan(self, now: int) -> None:
        """Reschedule the next word. Call after any change that affects when this word is sent."""
        self._plan(now)
        self._set_next(now)

    def resume(self, now: int) -> None:
        """Reschedule the next word after the clock was started or stopped: for the next tick or later."""
        self.stopping = False
        coming = self._clock.passed(now) + 1
        self._start_at = max(self._start_at, coming)
        self._load_at = max(self._load_at, coming)
        self.replan(now)

    def _finish(self) -> None:
        self.active = False
        self._last_end = self._end
        self._end = FAR

    def _plan(self, now: int) -> None:
        """Compute when the next word is loaded and when its start bit begins. Cancel both if no word can be sent."""
        if self._loaded:
            return
        planned = self._start_at
        waiting = len(self.fifo) > 0 if self.fifo_mode else self._waiting
        if not (waiting and self.running and (self.enabled or self._drain > 0)):
            self._start_at = self._load_at = FAR
            self._load_cycle = NEVER
        elif self.active:
            self._plan_after_frame(now)
        elif planned == FAR:
            self._plan_from_idle(now)

    def _plan_after_frame(self, now: int) -> None:
        """Schedule the next word, to be sent after the present frame or idle time."""
        if self.fifo_mode:
            self._start_at = self._load_at = self._end + self._pause()
            return
        self._start_at = self._load_at = self._end
        if self._data_frame and self.options.tx_reload_point.assume(self.touched) == "stop_begin":
            stop = self._end - 8 * self._layout.stops
            self._load_at = max(stop, self._clock.passed(now) + 1)

    def _plan_from_idle(self, now: int) -> None:
        """Schedule the next word of an idle transmitter; the option `tx_phase` determines when the word begins."""
        clock = self._clock
        phase = self.options.tx_phase.assume(self.touched)
        if phase == "restart":
            clock.restart(now)
        begin = clock.passed(now) + 1
        if phase == "next_bit_tick":
            begin = -(-begin // 8) * 8
        pause = self._pause() if self.fifo_mode else 0
        if pause:
            if self.options.fftxdly_first_word.assume(self.touched) == "delay":
                begin += pause
            begin = max(begin, self._last_end + pause)
        self._start_at = self._load_at = begin
        if not pause and self.options.txrdy_point.assume(self.touched) == "next_lspclk":
            self._load_at = FAR
            self._load_cycle = clock.lspclk_after(now)

    def _pause(self) -> int:
        """Return FFTXDLY in ticks."""
        delay = self.delay
        if not delay:
            return 0
        if delay == 255:
            delay = self.options.fftxdly_max.assume(self.touched)
        return delay * 8 if self.options.fftxdly_unit.assume(self.touched) == "bit" else delay

    def _load(self) -> None:
        """Move the next word from SCITXBUF or the FIFO to TXSHF, and TXWAKE to WUT."""
        self._load_at = FAR
        self._load_cycle = NEVER
        self._loaded = True
        self.wut = self.txwake
        self.txwake = False
        self._drain = max(0, self._drain - 1)
        if self.fifo_mode:
            word = self.fifo.pop()
            self._txshf_mark, self._txshf = word >> 8, word & 0xFF
            self.watch_level()
            return
        self._txshf_mark, self._txshf = self._txbuf_mark, self.txbuf
        self._waiting = False
        if self.int_enabled:
            self.request = True

    def _start(self, now: int) -> None:
        """Begin to send the word in TXSHF, or the idle time that TXWAKE requests instead."""
        layout = self._layout
        tick = self._start_at
        self._start_at = FAR
        self._loaded = False
        self.active = True
        self._began = tick
        self._data_frame = layout.address or not self.wut
        if self._data_frame:
            self._end = tick + layout.end
            self.frames += 1
            self.out_mark = self._txshf_mark
            self._set_edges(tick, self._levels(layout), layout.bits)
        else:
            self._end = tick + (88 if self.options.txwake_idle_len.assume(self.touched) == "11_bits" else layout.end)
        self._plan(now)

    def _set_edges(self, tick: int, levels: int, bits: int) -> None:
        """Set the edges of a frame that begins at `tick` after a high level. Bit 0 of `levels` is sent first."""
        changes = levels ^ (levels << 1 | 1)
        edges = [tick + 8 * bit for bit in range(bits - 1, -1, -1) if changes >> bit & 1]
        self._edges = edges
        self._edge_at = edges[-1] if edges else FAR

    def _levels(self, layout: SciFormat) -> int:
        word = self._txshf
        whole_byte = False
        if layout.parity and word & ~layout.data_mask:
            whole_byte = self.options.parity_of_short_chars.assume(self.touched) == "whole_byte"
        return layout.levels(word, int(self.wut), whole_byte)

    def _set_next(self, now: int) -> None:
        due = self._edge_at
        if self._end < due:
            due = self._end
        if self._start_at < due:
            due = self._start_at
        if self._load_at < due:
            due = self._load_at
        self.next_tick = due
        self.next_cycle = self._load_cycle if self._clock.running else NEVER
        if now < self._empty_until < self.next_cycle:
            self.next_cycle = self._empty_until

    # From the CPU -----------------------------------------------------------

    def write_buffer(self, now: int, value: int) -> None:
        """Process a CPU write of SCITXBUF: the word waits there or, in FIFO mode, in the FIFO, or is lost (`lost`)."""
        was_empty = self._is_empty()
        before = self._txbuf_mark, self.txbuf
        self._txbuf_mark, self.txbuf = self.mark, value & 0xFF
        if self.fifo_mode:
            self._to_fifo()
            if self._waiting:
                self._txbuf_mark, self.txbuf = before
        elif self.in_swreset and self.options.txbuf_write_in_swreset.assume(self.touched) == "lost":
            self.lost.append(f"SCITXBUF was written {value & 0xFF:#04x} while SW RESET = 0: the character is lost")
            return
        elif self._waiting:
            self.lost.append(f"SCITXBUF was written {value & 0xFF:#04x} while TXRDY = 0: one character is lost")
            if self.options.txbuf_write_when_full.assume(self.touched) == "ignored":
                self._txbuf_mark, self.txbuf = before
        else:
            self._waiting = True
        self.replan(now)
        if was_empty and self._start_at != FAR and self.options.txempty_fall.assume(self.touched) == "halfway":
            self._empty_until = now + (self._clock.at(self._start_at) - now) // 2
            self._set_next(now)

    def _to_fifo(self) -> None:
        word = self.mark << 8 | self.txbuf
        if not self.fifo.is_released():
            self.lost.append("SCITXBUF was written while TXFIFOXRESET = 0 holds the transmit FIFO: the word is lost")
        elif self._is_held():
            self.lost.append("SCITXBUF was written while SCIRST = 0 holds the transmit channel: the word is lost")
        elif not self.fifo.push(word):
            self.lost.append("SCITXBUF was written while TXFFST = 16: one word is lost")
            if self.options.txfifo_write_when_full.assume(self.touched) == "overwrites_last":
                self.fifo.words[-1] = word
        else:
            self.watch_level()

    def write_fifo(self, now: int, value: int) -> None:
        """Process a CPU write of SCIFFTX. The owner applies SCIRST and SCIFFENA to the rest of the module."""
        was_on = self.fifo_mode
        enabled_later = self.fifo.write(value)
        self.fifo_mode = self.fifo.control & SCIFFENA > 0
        if self.fifo_mode != was_on:
            self._drain = 0
        if self.fifo_mode and (enabled_later or (not was_on and self.fifo.is_requesting())):
            self.request = True
        self.watch_level()
        self.replan(now)

    def watch_level(self) -> None:
        """In FIFO mode, set TXFFINT if TXFFST has fallen to TXFFIL, and then request TXINT if TXFFIENA = 1."""
        if self.fifo.watch(self.fifo_mode and not self._is_held()):
            self.request = True

    def _is_held(self) -> bool:
        """Return True if SCIRST = 0 holds the FIFO empty and its flag at 0, as the option scirst_scope selects."""
        return not self.fifo.control & SCIRST and self.options.scirst_scope.assume(self.touched) == "shifters_and_fifos"

    def set_enabled(self, now: int, on: bool) -> None:
        """Set TXENA. If it becomes 0, waiting words are sent only if the option txena_clear_drains says so."""
        if on == self.enabled:
            return
        self.enabled = on
        self._drain = 0
        waiting = len(self.fifo) if self.fifo_mode else int(self._waiting)
        if not on and waiting and self.options.txena_clear_drains.assume(self.touched) == "all_written":
            self._drain = waiting
        self.replan(now)

    def set_int_enabled(self, on: bool) -> None:
        """Set TXINTENA. If it becomes 1 while TXRDY = 1, TXINT is requested at once (standard mode)."""
        if on and not self.int_enabled and not self.fifo_mode and self.show_flags(0) & TXRDY:
            self.request = True
        self.int_enabled = on

    def set_layout(self, now: int, layout: SciFormat, at_once: bool) -> None:
        """Set the format of the next frames and, with `at_once`, of the present frame."""
        self._layout = layout
        if at_once and self.active and self._data_frame:
            done = (self._clock.passed(now) - self._began) // 8 + 1
            bits = max(layout.bits, done)
            self._end = self._began + 8 * bits
            levels = self._levels(layout) & -(1 << done) | (-self.level & (1 << done) - 1)
            self._set_edges(self._began, levels, bits)
            while self._edges and self._edges[-1] < self._began + 8 * done:
                self._edges.pop()
            self._edge_at = self._edges[-1] if self._edges else FAR
        self.replan(now)

    def show_flags(self, now: int) -> int:
        """Return TXRDY and TXEMPTY in their positions in SCICTL2."""
        if self.in_swreset:
            return TXRDY | TXEMPTY
        if not self.fifo_mode:
            ready = not self._waiting
        else:
            ready = not self.fifo.words or self.options.txrdy_in_fifo_mode.assume(self.touched) == "stays_1"
        empty = self._is_empty() or now < self._empty_until
        return (TXRDY if ready else 0) | (TXEMPTY if empty else 0)

    def _is_empty(self) -> bool:
        waiting = len(self.fifo) > 0 if self.fifo_mode else self._waiting
        return not (waiting or self.active or self._loaded)
