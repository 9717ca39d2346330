"""SCI receiver, CPU side: SCIRXBUF, the FIFO, flags and the receive request.

    deliver(word) --> RXSHF move --> SCIRXBUF or FIFO --read--> CPU
                        |
                        +--> RXRDY, FE, PE, OE, RXWAKE, RXFFST, RXFFINT, RXFFOVF --> request

The owner calls `deliver` at the point of the stop bit that the option `rxrdy_point` selects, or at the end of autobaud.

Chosen, where the manual is silent:
- In standard mode with RXBKINTENA = 1, every character that moves to SCIRXBUF requests RXINT, even if it overwrites an
  unread one. Characters that move there while SLEEP hides them (option `sleep_loads_buffer`) request nothing.
- Setting an enable bit that the present mode uses, while its flag is 1, requests RXINT or TXINT at once, except for
  RXFFOVF.
- In FIFO mode an address frame sets RXWAKE. Only a read of SCIRXBUF or a reset clears it. This applies to both
  multiprocessor modes.
- A word read from the FIFO stays in SCIRXBUF. Reads of the empty FIFO return this word if the option
  `rxfifo_read_when_empty` is "last_word".
- While RXFIFORESET = 0, a received word does not enter the FIFO, but its errors still set FE and PE.
- RXFIFORESET does not change RXFFOVF. Clearing SCIFFENA does not change RXFFINT.
- RXFIFORESET = 0 does not prevent RXFFINT: with RXFFIL = 0, even the empty FIFO sets it.
- RXFFOVF requests RXINT only when it changes from 0 to 1.
- BRKDT, like all flags in SCIRXST, is set only while RXENA = 1.

Source: TI SPRUFZ5A sections 1.2.4 to 1.2.10, tables 2-7, 2-8, 2-10.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.state import State
from ..interrupt_fifo import ENABLE, OVERFLOW, InterruptFifo
from .options import SciOptions
from .receiver_bits import FE, PE
from .register_map import SCI_MAP, ST_BRKDT, ST_FE, ST_OE, ST_PE, ST_RXERROR, ST_RXRDY, ST_RXWAKE

CHARACTER_ERRORS = ST_FE | ST_OE | ST_PE


@final
class SciRx:
    """CPU side of the receiver. request: True if RXINT was requested since the owner last set this to False."""

    STATE = State("bk_enabled enabled error_enabled fifo fifo_mode loaded parity request rxbuf sleep status")

    def __init__(self, options: SciOptions, touched: set[str]) -> None:
        self.options = options
        self.touched = touched
        # Numbers of characters that ended with RXENA = 1 and these errors, and of characters that an overrun lost.
        self.framing_errors = self.parity_errors = self.lost = 0
        # True if SCIRXBUF got a word, even one equal to the old word, since the owner last set this to False.
        self.loaded = False
        self.fifo = InterruptFifo(SCI_MAP["SCIFFRX"], True, options.fifo_int_mode, touched)
        self.reset()

    # Resets -----------------------------------------------------------------

    def reset(self) -> None:
        """Reset by XRS."""
        self.request = False
        # Enables and modes, copied here from the registers of the whole module.
        self.enabled = self.sleep = self.bk_enabled = self.error_enabled = self.fifo_mode = self.parity = False
        # The receiver's own state.
        self.status = 0  # BRKDT, FE, OE, PE, RXWAKE, RXRDY in their positions in SCIRXST
        self.rxbuf = 0
        self.fifo.reset()

    def clear_fifo(self) -> None:
        """Empty the FIFO and clear its flags. No interrupt is requested.

        In FIFO mode with RXFFIL = 0, even the empty FIFO may then set RXFFINT at once.
        """
        self.fifo.clear()
        self.fifo.watch(self.fifo_mode)

    # From the line ----------------------------------------------------------

    def deliver(self, word: int, address: int, break_like: bool) -> None:
        """Receive a character: move it to SCIRXBUF or the FIFO and set flags, as RXENA, SLEEP and options say.

        word: the character with the flags FE and PE. address: 1 for an address frame.
        break_like: True if all bits, even the stop bit, were 0.
        """
        if not self.enabled:
            return
        self.framing_errors += word & FE > 0
        self.parity_errors += word & PE > 0
        if self.sleep and not address:
            self._pass_in_sleep(word)
            return
        errors = (ST_FE if word & FE else 0) | (ST_PE if word & PE else 0)
        if break_like and not self.options.break_char_delivered.assume(self.touched):
            self._set_errors(errors)
            return
        if self.fifo_mode:
            errors |= self._to_fifo(word)
        else:
            if self.status & ST_RXRDY:
                errors |= ST_OE
                self.lost += 1
            self.rxbuf = word & 0xFF
            self.loaded = True
            self.status |= ST_RXRDY
            self.request = self.request or self.bk_enabled
        if address:
            self.status |= ST_RXWAKE
        elif not self.fifo_mode:
            self.status &= ~ST_RXWAKE
        self._set_errors(errors)
        if self.fifo_mode:
            self._watch_level()

    def line_break(self) -> bool:
        """Receive a break: set BRKDT and return True.

        If RXENA = 0, or if SLEEP = 1 and the option `brkdt_in_sleep` is "suppressed", do nothing and return False.
        """
        if not self.enabled:
            return False
        if self.sleep and self.options.brkdt_in_sleep.assume(self.touched) == "suppressed":
            return False
        if self.bk_enabled and not self.fifo_mode:
            self.request = True
        self._set_errors(ST_BRKDT, keep=True)
        return True

    def _pass_in_sleep(self, word: int) -> None:
        if not self.options.sleep_loads_buffer.assume(self.touched):
            return
        if not self.fifo_mode:
            self.rxbuf = word & 0xFF
            self.loaded = True
            return
        requested = self.request
        self._to_fifo(word)
        self._watch_level()
        self.request = requested

    def _to_fifo(self, word: int) -> int:
        """Add a word to the FIFO, unless RXFIFORESET = 0 or a full FIFO drops it. Return ST_OE if OE must be set."""
        waiting = len(self.fifo)
        overrun = 0
        if waiting and self.options.oe_in_fifo_mode.assume(self.touched) == "per_unread_word":
            overrun = ST_OE
        if not self.fifo.is_released():
            return overrun
        if self.fifo.push(word):
            self.loaded = self.loaded or not waiting
            return overrun
        self.lost += 1
        if self.options.fifo_overflow_drops.assume(self.touched) == "oldest":
            self.fifo.pop()
            self.fifo.push(word)
            self.loaded = True
        if not self.fifo.control & OVERFLOW:
            self.fifo.control |= OVERFLOW
            if self.fifo.control & ENABLE and self.options.rxffovf_interrupt.assume(self.touched) == "rxffiena":
                self.request = True
        return ST_OE

    def _set_errors(self, errors: int, keep: bool = False) -> None:
        """Set the error flags of one character or break. With RXERRINTENA = 1, request RXINT as `rxerr_int_mode` says.

        keep: True to keep the flags of earlier characters, even if the option `error_flags_sticky` is False.
        """
        was_error = self.status & (CHARACTER_ERRORS | ST_BRKDT)
        if was_error & CHARACTER_ERRORS and not keep and not self.options.error_flags_sticky.assume(self.touched):
            self.status &= ~CHARACTER_ERRORS
        if not errors:
            return
        self.status |= errors
        if self.error_enabled and (not was_error or self.options.rxerr_int_mode.assume(self.touched) == "every_error"):
            self.request = True

    # FIFO interrupt ---------------------------------------------------------

    def _watch_level(self) -> None:
        """In FIFO mode, set RXFFINT if RXFFST has reached RXFFIL, and then request RXINT if RXFFIENA = 1."""
        if self.fifo.watch(self.fifo_mode):
            self.request = True

    # From the CPU -----------------------------------------------------------

    def show_status(self) -> int:
        status = self.status
        if not self.parity:
            status &= ~ST_PE
        if (
            self.fifo_mode
            and (len(self.fifo) > 0) != ((status & ST_RXRDY) > 0)
            and self.options.rxrdy_in_fifo_mode.assume(self.touched) == "follows"
        ):
            status ^= ST_RXRDY
        if status & (CHARACTER_ERRORS | ST_BRKDT):
            status |= ST_RXERROR
        return status

    def show_buffer(self) -> int:
        """Return the value of SCIRXBUF without the side effects of a read."""
        if not self.fifo_mode:
            return self.rxbuf & 0xFF
        if self.fifo.words:
            return self.fifo.words[0]
        return self.rxbuf if self.options.rxfifo_read_when_empty.assume(self.touched) == "last_word" else 0

    def read_buffer(self) -> int:
        """Read SCIRXBUF as the CPU does: remove the word from the FIFO, and clear RXRDY and RXWAKE."""
        word = self.show_buffer()
        if self.fifo_mode and self.fifo.words:
            self.rxbuf = self.fifo.pop()
            self.loaded = bool(self.fifo.words)
            self._watch_level()
        self.status &= ~(ST_RXRDY | ST_RXWAKE)
        return word

    def write_fifo(self, value: int) -> None:
        """Process a CPU write of SCIFFRX."""
        if self.fifo.write(value) and self.fifo_mode:
            self.request = True
        self._watch_level()

    def set_enables(self, bk_enabled: bool, error_enabled: bool) -> None:
        """Set the enables. Setting one while its flag is 1 requests RXINT; RXBKINTENA does so only in standard mode."""
        if bk_enabled and not self.bk_enabled and not self.fifo_mode and self.status & (ST_RXRDY | ST_BRKDT):
            self.request = True
        if error_enabled and not self.error_enabled and self.show_status() & ST_RXERROR:
            self.request = True
        self.bk_enabled = bk_enabled
        self.error_enabled = error_enabled

    def set_fifo_mode(self, on: bool) -> None:
        if on and not self.fifo_mode and self.fifo.is_requesting():
            self.request = True
        self.fifo_mode = on
        self._watch_level()
