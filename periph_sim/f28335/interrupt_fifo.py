"""FIFO of a serial module (SCI, SPI, I2C) with its control register, interrupt flag and interrupt request.

    push --> 16 words --> pop        SCIFFTX, SPIFFTX, I2CFFTX: TXFFINT when TXFFST <= TXFFIL
               |                     SCIFFRX, SPIFFRX, I2CFFRX: RXFFINT when RXFFST >= RXFFIL
               +--> level, flag --enable--> request

The FIFOs of all serial modules have these fields at the same bits. The module that owns a FIFO decides when the number
of words is compared with the level (`watch`), and whether setting the enable bit while the flag is 1 requests the
interrupt. The module also handles resets, FIFO mode, and a word that arrives while the FIFO is full.

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
    """FIFO with its control register.

    register: the description of SCIFFTX, SCIFFRX or the corresponding register of another module.
    receives: True for a receive FIFO, whose flag is set if the number of words is the level or more. False for a
        transmit FIFO, whose flag is set if the number of words is the level or less.
    mode: the module's option `fifo_int_mode`, which decides when the flag is set again after firmware cleared it.
    touched: the set to which the name of this option is added when it is used.
    words: the words in the FIFO, the oldest first.
    control: the value of the register, with 0 in place of the number of words (TXFFST, RXFFST).
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
        """Set the flag if the number of words has reached the level. Return True if this requests the interrupt.

        If `mode` is "level", each call sets the flag while the level is reached. If `mode` is "edge", the flag is set
        only if the level was not reached at the previous call. If `on` is False, the level counts as not reached.
        """
        waiting, level = len(self.words), self.control & LEVEL
        reached = on and (waiting >= level if self.receives else waiting <= level)
        requests = False
        if reached and not self.control & FLAG and (not self._was_reached or self.mode.assume(self.touched) == "level"):
            self.control |= FLAG
            requests = self.control & ENABLE > 0
        self._was_reached = reached
        return requests

    def write(self, value: int) -> bool:
        """Write the register. Return True if this sets the enable bit while the flag is 1."""
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
        """Return the value that the CPU reads from the FIFO's register, including the number of words in the FIFO."""
        return self.control | min(len(self.words), DEPTH) << STATUS

    def clear(self) -> None:
        """Empty the FIFO, and clear its interrupt flag and, in a receive FIFO, its overflow flag."""
        self.words.clear()
        self.control &= ~(FLAG | OVERFLOW if self.receives else FLAG)
