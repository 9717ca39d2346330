"""FIFO of a serial module with its register: number of words, level, interrupt flag and request.

    push --> 16 words --> pop        SCIFFTX, SPIFFTX, I2CFFTX: TXFFINT when TXFFST <= TXFFIL
               |                     SCIFFRX, SPIFFRX, I2CFFRX: RXFFINT when RXFFST >= RXFFIL
               +--> level, flag --enable--> request

The FIFOs of all serial modules have these fields at the same bits. Each module decides when the level is watched, and
whether setting the enable later requests. It also handles resets, FIFO mode, and a word that finds the FIFO full.

Source: SPRUFZ5A tables 2-9, 2-10; SPRUEU3 section 2.1.9; SPRUG03B sections 5.11 and 5.12.
"""

# core: compiled

from __future__ import annotations

from ..core.options import TextOption
from ..core.registers import Register
from ..core.state import State

DEPTH = 16

# Bits of the FIFO registers of SCI, SPI and I2C.
OVERFLOW = 1 << 15  # RXFFOVF, which I2CFFRX does not have
OVERFLOW_CLEAR = 1 << 14  # RXFFOVRCLR
RELEASE = 1 << 13  # TXFIFOXRESET, RXFIFORESET, TXFFRST and so on: 0 holds the FIFO empty
STATUS = 8  # lowest bit of TXFFST, RXFFST
FLAG = 1 << 7  # TXFFINT, RXFFINT
FLAG_CLEAR = 1 << 6  # TXFFINTCLR, RXFFINTCLR
ENABLE = 1 << 5  # TXFFIENA, RXFFIENA
LEVEL = 0x1F  # TXFFIL, RXFFIL


class InterruptFifo:
    """FIFO with its register.

    register: SCIFFTX, SCIFFRX or the corresponding register of another module.
    receives: True if the flag is set from the level upwards, False if from the level downwards.
    mode: the module's option `fifo_int_mode`.
    words: oldest first.
    control: the register without the number of words, which is counted.
    """

    STATE = State("words control _was_reached")

    def __init__(self, register: Register, receives: bool, mode: TextOption, touched: set[str]) -> None:
        self.register = register
        self.receives = receives
        self.mode = mode
        self.touched = touched
        self.words: list[int] = []
        self.reset()

    def reset(self) -> None:
        """Reset by XRS."""
        self.words.clear()
        self.control: int = self.register.reset
        self._was_reached = False

    def __len__(self) -> int:
        return len(self.words)

    def push(self, word: int) -> bool:
        """Append a word and return True. If the FIFO is full, return False and change nothing."""
        if len(self.words) == DEPTH:
            return False
        self.words.append(word)
        return True

    def pop(self) -> int:
        """Remove and return the oldest word. Raise IndexError if the FIFO is empty."""
        return self.words.pop(0)

    def is_released(self) -> bool:
        """Return False while the register's reset bit holds the FIFO empty, else True."""
        return self.control & RELEASE > 0

    def is_requesting(self) -> bool:
        """Return True if the flag and its enable are set."""
        return self.control & FLAG > 0 and self.control & ENABLE > 0

    def watch(self, on: bool) -> bool:
        """Set the flag if the level has been reached. Return True if that is a request. on: the level is watched."""
        waiting, level = len(self.words), self.control & LEVEL
        reached = on and (waiting >= level if self.receives else waiting <= level)
        requests = False
        if reached and not self.control & FLAG and (not self._was_reached or self.mode.assume(self.touched) == "level"):
            self.control |= FLAG
            requests = self.control & ENABLE > 0
        self._was_reached = reached
        return requests

    def write(self, value: int) -> bool:
        """Write the register. Return True if its enable was set while the flag is set."""
        before = self.control
        self.control, strobes = self.register.write(before, value)
        if strobes & FLAG_CLEAR:
            self.control &= ~FLAG
        if strobes & OVERFLOW_CLEAR:
            self.control &= ~OVERFLOW
        if not self.control & RELEASE:
            self.words.clear()
        return not before & ENABLE and self.is_requesting()

    def show(self) -> int:
        """Return the register as the CPU reads it."""
        return self.control | min(len(self.words), DEPTH) << STATUS

    def clear(self) -> None:
        """Empty the FIFO and clear its flags."""
        self.words.clear()
        self.control &= ~(FLAG | OVERFLOW if self.receives else FLAG)
