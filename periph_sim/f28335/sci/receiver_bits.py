"""SCI receiver, line side: detects frames, breaks and idle lines from the levels on RXD at SCICLK ticks.

    toggle(tick, level) --> [ticks at which the sampled level changed] --step--> FRAME, BREAK, IDLE

Evaluation is lazy: an edge is only recorded. When a frame, a break or an idle line is due (`next_tick`), it is computed
from the recorded edges, with the same result as sampling at every SCICLK. A tick is a sample; changes between two
samples are not seen.

Rules: Four low samples in a row are a start bit; the first of them is sub-sample 1. The value of a bit is the majority
of its sub-samples 4, 5, 6 (stop bit: option `stop_vote_samples`). The search for the next start bit begins inside the
stop bit or, by an erratum, in address-bit mode inside the address bit (option `addrbit_hunt_with_parity`).

Chosen, where the manual is silent:
- After a missing stop bit, a low level counts as a start bit only if a high level was sampled before it. So a break
  yields one frame. Exception: in address-bit mode, a start bit that was accepted by the end of the vote on the stop bit
  stays accepted.
- If a high level is sampled before the low bits of a break (option `break_bits`) are over, the count begins again at
  the next missing stop bit.
- Idle bits are counted from the end of the last programmed stop bit. Any low sample restarts the count, even if it is
  not part of a start bit. The line is idle after 80 high samples (ten bits).
- If SW RESET is released while the line is low, the next four low samples are a start bit as usual.

Source: TI SPRUFZ5A sections 1.2.5 to 1.2.8, table 2-7; SPRZ272N figure 3-1.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.state import State
from .character_format import SciFormat
from .options import SciOptions

FAR = 2**62  # a tick that no run reaches

NOTHING, FRAME, BREAK, IDLE = range(4)

FE = 1 << 15  # framing error, at its position in SCIRXBUF
PE = 1 << 14  # parity error, at its position in SCIRXBUF

IDLE_TICKS = 80  # length of ten bits
SHORT_BREAK = 16  # length of two bits: a longer low level after a missing stop bit was probably meant as a break
VOTE = 0b11101000  # bit n: the result of the vote if the three samples are the bits of the number n


@final
class SciRxBits:
    """Line side of the receiver. The comments call a series of equal samples a run.

    word: after `step` returned FRAME, the received word with FE and PE.
    address: after `step` returned FRAME, 1 for an address frame, else 0.
    framed: True from the acceptance of a start bit until `step` returns FRAME, or a break or `close` drops the frame.
    short_break: True after a frame of zeros if the line then stayed low for more than two bits, but too short for a
        break. The owner reads it and sets it to False.
    """

    STATE = State(
        "next_tick word address watch_idle framed short_break _layout _open _line _toggles _level _low_from "
        "_high_from _idle_base _idle _idle_unreported _start _frame _missing_stop _break_at _sure",
    )

    def __init__(self, layout: SciFormat, options: SciOptions, touched: set[str]) -> None:
        self.next_tick = FAR
        self.word = 0
        self.address = 0
        self.watch_idle = False  # True if `step` returns IDLE for an idle line
        self._layout = layout  # format of the next frame
        self._options = options
        self._touched = touched
        self._open = False
        self._line = 1  # level set by the last `toggle`
        self._toggles: list[int] = []  # ticks at which the sampled level changes; the first one ends the present run
        self._level = 1  # level of the present run
        self._low_from = FAR  # first sample of a low run that may be a start bit; FAR if this run cannot be one
        self._high_from = FAR  # tick from which idle bits are counted in a high run; not before `_idle_base`
        # The tick from which idle bits are counted. It is FAR before the first frame or break, if the option
        # `idle_before_first_frame` is False and the idle-line protocol is used.
        self._idle_base = FAR
        self._idle = False  # True if an idle line (ten idle bits) was detected after the last frame
        self._idle_unreported = False  # True if an idle line was detected, and `step` has not returned IDLE for it yet
        self.framed = False
        self.short_break = False
        self._start = 0  # first low sample of the accepted start bit
        self._frame = layout  # the format of the present frame
        self._missing_stop = 0  # tick of the last voting sample of the missing stop bit that may begin a break
        self._break_at = FAR  # tick at which the break is complete if the line stays low; FAR if there is no break
        self._sure = True  # True if no later edge can change `next_tick`

    # Inputs -----------------------------------------------------------------

    def toggle(self, tick: int, level: int) -> bool:
        """Set the level of the samples from `tick` on. Return True if `next_tick` may have changed."""
        if level == self._line:
            return False
        self._line = level
        toggles = self._toggles
        if toggles and toggles[-1] >= tick:
            toggles.pop()  # the previous level ends before its first sample
        else:
            toggles.append(tick)
        if self._sure:
            if not self._open:
                self._drop(tick - 1)
            return False
        self._plan()
        return True

    def set_layout(self, tick: int, layout: SciFormat, at_once: bool) -> None:
        """Set the format of the next frames and, if `at_once` is True, of the present frame.

        tick: the latest tick that has passed.
        """
        self.settle(tick)
        self._layout = layout
        if at_once:
            self._frame = layout
        self._plan()
        self.next_tick = max(self.next_tick, tick + 1)

    def set_watch(self, tick: int, watch: bool) -> None:
        """Select whether `step` returns IDLE for an idle line. tick: the latest tick that has passed."""
        self.settle(tick)
        self._idle_unreported = False  # do not report an idle line that was detected before this call
        self.watch_idle = watch
        self._plan()

    def settle(self, tick: int) -> None:
        """Process the samples up to `tick`. If they contain a start bit, a frame begins."""
        if self._break_at != FAR:
            self._end_break_on_high(tick)
        if self._open and not self.framed:
            self._hunt(tick)

    def open(self, tick: int) -> None:
        """Drop any frame in progress, and search for a start bit from sample `tick` on."""
        self.close()
        self._open = True
        self._idle = False
        at_once = self._options.idle_before_first_frame
        self._idle_base = tick if self._layout.address or at_once.assume(self._touched) else FAR
        self._resume(tick)
        self._plan()

    def close(self) -> None:
        """Drop the present frame and ignore the line."""
        self._open = False
        self.framed = False
        self._break_at = FAR
        self._plan()

    # Events -----------------------------------------------------------------

    def step(self, tick: int) -> int:
        """Return the next event up to `tick`. If there is none, return NOTHING and set `next_tick` for the next one."""
        if self._open:
            if self._break_at != FAR:
                self._end_break_on_high(tick)
            if not self.framed:
                self._hunt(tick)
            if self._idle_unreported:
                self._idle_unreported = False
                if self.watch_idle:
                    return IDLE
            due = self._start + self._frame.due if self.framed else FAR
            if self._break_at <= tick and self._break_at < due:
                self._wait_for_high()
                return BREAK
            if due <= tick:
                self._finish()
                return FRAME
        self._plan()
        return NOTHING

    def _hunt(self, tick: int) -> None:
        """Process the runs of equal samples up to `tick`, until a start bit is accepted."""
        toggles = self._toggles
        while True:
            end: int = toggles[0] if toggles else FAR
            if self._level:
                if not self._idle and self._high_from + IDLE_TICKS <= min(end, tick):
                    self._idle = True
                    self._idle_unreported = True
            elif end - self._low_from >= 4 and self._low_from + 3 <= tick:
                self.framed = True
                self._start = self._low_from
                self._frame = self._layout
                return
            if end > tick:
                return
            toggles.pop(0)
            self._level ^= 1  # the next run of equal samples begins at `end`
            if self._level:
                self._high_from = max(end, self._idle_base)
            else:
                self._low_from = end

    def _end_break_on_high(self, tick: int) -> None:
        t: int
        for t in self._toggles:
            if t > self._missing_stop:
                if t <= min(tick, self._break_at):
                    self._break_at = FAR
                    self.short_break = t - self._missing_stop > SHORT_BREAK and not self.word & 0xFF
                return

    def _wait_for_high(self) -> None:
        """After a break was detected, drop a frame in progress, and accept no start bit until the line was high."""
        self._drop(self._break_at)
        self._break_at = FAR
        self.framed = False
        self._low_from = FAR
        self._idle_base = 0

    def _finish(self) -> None:
        """Complete the frame: decode it from its samples, and search for the next start bit."""
        start, frame = self._start, self._frame
        stop_at = frame.stop_at
        last = stop_at + 8
        third: int
        fourth: int
        fifth: int
        third = fourth = fifth = 0  # in bit n: the votes for the frame's bit n, from sub-samples 4, 5 and 6
        stop: int = 0  # bit n: the sample n ticks into the stop bit
        t: int
        for t in self._toggles:
            t -= start
            if t > last:
                break
            third ^= -(1 << (t + 4 >> 3))
            fourth ^= -(1 << (t + 3 >> 3))
            fifth ^= -(1 << (t + 2 >> 3))
            stop ^= -(1 << (t - stop_at)) if t > stop_at else -1
        self.framed = False
        self._read_word(third & fourth | third & fifth | fourth & fifth, stop, frame)
        self.address = self.address if frame.address else int(self._idle)
        self._idle = False
        self._idle_base = start + frame.end
        self._resume(start + frame.hunt)
        if frame.address and frame.parity:
            self._options.addrbit_hunt_with_parity.assume(self._touched)
        if not frame.address and stop >> 5 & 7 != 7:
            self._options.start_hunt_point.assume(self._touched)
        if self.word & FE:
            self._after_missing_stop(stop, start, frame)

    def _read_word(self, votes: int, stop: int, frame: SciFormat) -> None:
        """Decode the frame. votes: its bits, beginning with the start bit. stop: the samples of the stop bit."""
        place = 1 + frame.data_bits
        word = votes >> 1 & frame.data_mask
        self.address = votes >> place & 1
        if frame.parity:
            if frame.address:
                place += 1
            if votes >> place & 1 != frame.parity_bit(word, self.address):
                word |= PE
        if (stop >> 2 ^ stop >> 5) & 1:
            self._options.stop_vote_samples.assume(self._touched)
        if not VOTE >> (stop >> frame.vote_at - frame.stop_at & 7) & 1:
            word |= FE
        self.word = word

    def _after_missing_stop(self, stop: int, start: int, frame: SciFormat) -> None:
        """Count the bits of a break, if the line is still low. Accept no further start bit before a high level."""
        voted = start + frame.voted_at
        since_vote = stop >> frame.voted_at - frame.stop_at
        if self._break_at == FAR and not since_vote & 1:
            self._missing_stop = voted
            self._break_at = start + frame.break_at
            options, touched = self._options, self._touched
            for option in (options.break_bits, options.break_count_from, options.stop_vote_samples):
                option.assume(touched)
        if frame.hunt < frame.voted_at:
            self._hunt(voted)
            if not self.framed and not self._level:
                self._low_from = FAR
        else:
            between = (1 << frame.hunt - frame.voted_at + 1) - 1
            if not since_vote & between:
                self._low_from = FAR

    # Scheduling -------------------------------------------------------------

    def _drop(self, tick: int) -> None:
        """Remove the toggles up to `tick`, and set `_level` to the level after them."""
        toggles = self._toggles
        passed: int = 0
        t: int
        for t in toggles:
            if t > tick:
                break
            passed += 1
        if passed:
            del toggles[:passed]
            self._level ^= passed & 1

    def _resume(self, tick: int) -> None:
        """Search for a start bit from sample `tick` on."""
        self._drop(tick)
        self._high_from = self._idle_base
        self._low_from = tick

    def _plan(self) -> None:
        """Compute `next_tick` from all known edges. Set `_sure` to True if no later edge can change it."""
        self._sure = True
        if not self._open:
            self.next_tick = FAR
            return
        due: int = self._break_at
        if self.framed:
            self.next_tick = min(due, self._start + self._frame.due)
            return
        level, low_from, high_from = self._level, self._low_from, self._high_from
        watch = self.watch_idle and not self._idle
        end: int
        for end in self._toggles:
            if level:
                if watch and high_from + IDLE_TICKS <= end:
                    due = min(due, high_from + IDLE_TICKS)
                    watch = False
                low_from = end
            else:
                if end - low_from >= 4:
                    self.next_tick = min(due, low_from + self._layout.due)
                    return
                high_from = max(end, self._idle_base)
            level ^= 1
        self._sure = False
        if not level:
            due = min(due, low_from + self._layout.due)
        elif watch:
            due = min(due, high_from + IDLE_TICKS)
        self.next_tick = due
