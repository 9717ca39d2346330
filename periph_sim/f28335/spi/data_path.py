"""The path of a word through the SPI: SPITXBUF, SPIDAT, SPIRXBUF, the FIFOs, and their flags.

    write --> SPITXBUF or transmit FIFO --pop--> SPIDAT --deliver--> SPIRXBUF or receive FIFO --read-->
                  |                                         |
                  +--> BUFFULL_FLAG, TXFFST, TXFFINT        +--> INT_FLAG, OVERRUN_FLAG, RXFFST, RXFFINT, RXFFOVF

    SPIDAT: bit 15 --> data output        CLK_PHASE   leading edge   trailing edge
    data input --> bit 0                  0           output         latch
                                          1           latch          output of the next bit

With CLK_PHASE = 1 the first bit is at the output before the first edge of SPICLK (`present`).

Chosen, where the manual is silent:
- SPIFFENA selects whether words pass through the FIFOs or through SPITXBUF and SPIRXBUF alone. When it changes,
  SPITXBUF and the FIFOs keep their words. A word that waits in SPITXBUF stays there in FIFO mode: writes add words to
  the transmit FIFO only.
- A read of SPITXBUF returns the word last written, even after this word has moved to SPIDAT or to the FIFO. This does
  not include writes that leave a waiting word in SPITXBUF: those in FIFO mode, and those that the option
  `txbuf_write_when_full` ignores.
- A word read from the receive FIFO stays in SPIRXBUF.
- While a reset bit holds a FIFO empty, the interrupt flag of the FIFO is not set.
- Setting an enable bit that the present mode uses requests the interrupt at once if its flag (not RXFFOVF) is 1.
- If RXFFOVF requests RXINT (option `rxffovf_interrupt`), it does so at each overflow.

Source: TI SPRUEU3 sections 1.3.2, 1.4, 1.5, 2.1.3, 2.1.6 to 2.1.8 and 2.1.9 (SPIFFTX and SPIFFRX).
"""

from __future__ import annotations

from ...core.registers import Register
from ...core.state import State
from ..interrupt_fifo import ENABLE, OVERFLOW, InterruptFifo
from .options import SpiOptions
from .register_map import BUFFULL_FLAG, INT_FLAG, OVERRUN_FLAG, SPI_MAP


class SpiFifo(InterruptFifo):
    """FIFO of one direction, which SPIRST can hold empty.

    on: True in FIFO mode.
    request: True if the FIFO's interrupt was requested since the owner last set this to False.
    """

    STATE = State("on request _held")

    def __init__(self, register: Register, receives: bool, options: SpiOptions, touched: set[str]) -> None:
        super().__init__(register, receives, options.fifo_int_mode, touched)
        self.options = options

    def reset(self) -> None:
        """Put the FIFO into its state after a reset by XRS."""
        super().reset()
        self.on = False
        self.request = False
        self._held = False  # True if SPIRST = 0 holds the FIFO empty

    @property
    def accepts(self) -> bool:
        """True if neither the FIFO's own reset bit nor SPIRST holds the FIFO empty."""
        return self.is_released() and not self._held

    def add(self, word: int) -> bool:
        """Add a word. Return False if the FIFO is full or held empty."""
        added = self.accepts and self.push(word)
        self.update_flag()
        return added

    def add_received(self, word: int) -> bool:
        """Add a received word, unless the FIFO is held empty. If it is full, drop its oldest word and set RXFFOVF.

        Return True if another word has become the oldest, which is the word that the CPU reads next.
        """
        if not self.accepts or self.add(word):
            return len(self) == 1
        self.pop()
        self.push(word)
        self.control |= OVERFLOW
        if self.control & ENABLE and self.options.rxffovf_interrupt.assume(self.touched) == "rxffiena":
            self.request = True
        return True

    def take(self) -> int:
        """Remove and return the oldest word."""
        word = self.pop()
        self.update_flag()
        return word

    def update_flag(self) -> None:
        """In FIFO mode, set the flag if the level is reached and no reset bit holds the FIFO. Update `request`."""
        self.request = self.watch(self.on and self.accepts) or self.request

    def write_register(self, value: int) -> None:
        """Write SPIFFTX or SPIFFRX.

        After a write of SPIFFTX, the owner calls `turn` and, if SPIRST has changed, `hold`, for both FIFOs.
        """
        if self.write(value) and self.on:
            self.request = True
        self.update_flag()

    def turn(self, on: bool) -> None:
        """Switch FIFO mode on or off, as SPIFFENA does.

        Switching it on requests the FIFO's interrupt if the FIFO's flag and enable bit are already set.
        """
        if on and not self.on and self.is_requesting():
            self.request = True
        self.on = on
        self.update_flag()

    def hold(self, held: bool) -> None:
        """Empty the FIFO, clear its flags and keep it empty, as SPIRST = 0 does. If `held` is False, release it."""
        self._held = held
        if held:
            self.clear()
        self.update_flag()


class TransmitBuffer:
    """Transmit side of the SPI.

    txbuf: SPITXBUF.
    full: True if SPITXBUF has a waiting character.
    lost: texts of notes about lost words. The owner adds the notes and clears this list.
    """

    STATE = State("txbuf full fifo lost")

    def __init__(self, options: SpiOptions, touched: set[str]) -> None:
        self.options = options
        self.touched = touched
        self.fifo = SpiFifo(SPI_MAP["SPIFFTX"], False, options, touched)
        self.lost: list[str] = []
        self.reset()

    def reset(self) -> None:
        """Put the transmit buffer into its state after a reset by XRS."""
        self.fifo.reset()
        self.txbuf = 0
        self.full = False

    @property
    def waiting(self) -> bool:
        """True if a word waits to be loaded into SPIDAT."""
        return bool(self.fifo.words) if self.fifo.on else self.full

    def write(self, value: int, enabled: bool) -> None:
        """Write SPITXBUF. enabled: True if neither SW RESET nor SPIRST holds the SPI in reset."""
        before, self.txbuf = self.txbuf, value
        if self.fifo.on:
            self._write_fifo(value)
            if self.full:
                self.txbuf = before
        elif not enabled:
            self.lost.append(f"SPITXBUF was written {value:#06x} while a reset holds the SPI: the character is lost")
        elif self.full:
            self.lost.append(f"SPITXBUF was written {value:#06x} while BUFFULL_FLAG = 1: one character is lost")
            if self.options.txbuf_write_when_full.assume(self.touched) == "ignored":
                self.txbuf = before
        else:
            self.full = True

    def _write_fifo(self, value: int) -> None:
        if self.fifo.add(value):
            return
        if not self.fifo.accepts:
            self.lost.append(f"SPITXBUF was written {value:#06x} while a reset holds the transmit FIFO: it is lost")
            return
        self.lost.append(f"SPITXBUF was written {value:#06x} while TXFFST = 16: one word is lost")
        if self.options.txfifo_write_when_full.assume(self.touched) == "overwrites_last":
            self.fifo.words[-1] = value

    def pop(self) -> int:
        """Remove and return the next word for SPIDAT."""
        if self.fifo.on:
            return self.fifo.take()
        self.full = False
        return self.txbuf

    def show_status(self) -> int:
        """Return BUFFULL_FLAG in its position in SPISTS."""
        return BUFFULL_FLAG if self.full and not self.fifo.on else 0


class ReceiveBuffer:
    """Receive side of the SPI.

    status: INT_FLAG and OVERRUN_FLAG in their positions in SPISTS.
    enables: the flags of `status` that request RXINT.
    request: True if these flags requested RXINT since the owner last set this to False.
    loaded: True if SPIRXBUF received a word, even one equal to the old word, since the owner last set this to False.
    """

    STATE = State("rxbuf enables loaded request status fifo")

    def __init__(self, options: SpiOptions, touched: set[str]) -> None:
        self.options = options
        self.touched = touched
        self.fifo = SpiFifo(SPI_MAP["SPIFFRX"], True, options, touched)
        self.reset()

    def reset(self) -> None:
        """Put the receive buffer into its state after a reset by XRS."""
        self.fifo.reset()
        self.rxbuf = self.status = self.enables = 0
        self.request = self.loaded = False

    def deliver(self, word: int) -> None:
        """Store a received character in SPIRXBUF or the FIFO, and set flags."""
        if self.fifo.on:
            self.loaded = self.fifo.add_received(word) or self.loaded
            if self.options.status_in_fifo_mode.assume(self.touched) == "stays_0":
                return
        else:
            self.rxbuf = word
            self.loaded = True
        self._set_flags(INT_FLAG | OVERRUN_FLAG if self.status & INT_FLAG else INT_FLAG)

    def _set_flags(self, flags: int) -> None:
        rising = flags & ~self.status
        self.status |= flags
        if not self.fifo.on and (rising & self.enables or self._repeats()):
            self.request = True

    def _repeats(self) -> bool:
        """Return True if a character requests RXINT although INT_FLAG is already set."""
        return self.enables & INT_FLAG > 0 and self.options.int_request.assume(self.touched) == "every_character"

    def show(self) -> int:
        """Return the value of SPIRXBUF without the side effects of a read."""
        if self.fifo.on and self.fifo.words:
            return self.fifo.words[0]
        if self.fifo.on and self.options.rxfifo_read_when_empty.assume(self.touched) == "zero":
            return 0
        return self.rxbuf

    def read(self) -> int:
        """Read SPIRXBUF as the CPU does: remove the word from the FIFO, and clear INT_FLAG."""
        word = self.show()
        if self.fifo.on and self.fifo.words:
            self.rxbuf = self.fifo.take()
            self.loaded = bool(self.fifo.words)
        self.status &= ~INT_FLAG
        return word

    def set_enables(self, enables: int) -> None:
        """Set SPIINTENA and OVERRUNINTENA. Setting one while its flag is 1 requests RXINT, except in FIFO mode.

        enables: INT_FLAG if SPIINTENA is set, plus OVERRUN_FLAG if OVERRUNINTENA is set.
        """
        if enables & ~self.enables & self.status and not self.fifo.on:
            self.request = True
        self.enables = enables


class SpiShifter:
    """Shift register of both directions.

    dat: SPIDAT.
    level: level of the serial data output.
    bits: number of latched bits of the present character.
    loaded: True if SPIDAT has a character to send.
    length: number of bits of a character.
    delayed: the value of CLK_PHASE.
    """

    STATE = State("dat level length delayed bits loaded")

    def __init__(self) -> None:
        self.dat = self.level = self.bits = 0
        self.length = 1
        self.delayed = self.loaded = False

    @property
    def busy(self) -> bool:
        """True if SPIDAT has a character to send or a character is in progress. The next character must then wait."""
        return self.loaded or self.bits > 0

    @property
    def complete(self) -> bool:
        """True if all bits of the character have been latched."""
        return self.bits >= self.length

    def load(self, word: int) -> None:
        """Load a character to send into SPIDAT."""
        self.dat = word
        self.loaded = True

    def present(self) -> None:
        """If CLK_PHASE = 1, put the first bit on the data output. Call before the first edge of SPICLK."""
        if self.delayed:
            self.level = self.dat >> 15

    def edge(self, leading: bool, data: int) -> None:
        """At an edge of SPICLK, latch the data input or output the next bit, as CLK_PHASE selects.

        data: the level at the data input.
        """
        if leading == self.delayed:
            self.dat = (self.dat << 1 | data) & 0xFFFF
            self.bits += 1
        else:
            self.level = self.dat >> 15

    def finish(self) -> None:
        """End the character, even if it is not complete. The bits that have been latched stay in SPIDAT."""
        self.bits = 0
        self.loaded = False
