"""FIFO of the SPI: FIFO mode, SPIRST, and a word that arrives while 16 are waiting.

Chosen, where the manual is silent:
- A FIFO that a reset holds empty does not set its interrupt flag; the flag stays as it is.
- Words and flags stay when SPIFFENA is cleared.
- Setting an enable while its flag is set requests at once.
- Each overflow requests RXINT, if RXFFOVF requests it at all.

Source: TI SPRUEU3 section 1.5 and the tables of SPIFFTX and SPIFFRX in section 2.1.9.
"""

from __future__ import annotations

from ...core.registers import Register
from ...core.state import State
from ..interrupt_fifo import ENABLE, OVERFLOW, InterruptFifo
from .options import SpiOptions


class SpiFifo(InterruptFifo):
    """FIFO of one direction.

    on: FIFO mode.
    request: the FIFO's interrupt was requested since the owner last set this to False.
    """

    STATE = State("on request _held")

    def __init__(self, register: Register, receives: bool, options: SpiOptions, touched: set[str]) -> None:
        super().__init__(register, receives, options.fifo_int_mode, touched)
        self.options = options

    def reset(self) -> None:
        """Reset by XRS."""
        super().reset()
        self.on = False
        self.request = False
        self._held = False  # by SPIRST

    @property
    def accepts(self) -> bool:
        """True if no reset holds the FIFO empty."""
        return self.is_released() and not self._held

    def add(self, word: int) -> bool:
        """Add a word. Return False if the FIFO is full or held empty."""
        added = self.accepts and self.push(word)
        self.update_flag()
        return added

    def add_received(self, word: int) -> bool:
        """Add a word, replacing the oldest if the FIFO is full. Return True if the head changed."""
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
        """Set the interrupt flag if the level has been reached."""
        self.request = self.watch(self.on and self.accepts) or self.request

    def write_register(self, value: int) -> None:
        """Write SPIFFTX or SPIFFRX; the owner applies SPIRST and SPIFFENA with `hold` and `turn`."""
        if self.write(value) and self.on:
            self.request = True
        self.update_flag()

    def turn(self, on: bool) -> None:
        """Turn FIFO mode on or off."""
        if on and not self.on and self.is_requesting():
            self.request = True
        self.on = on
        self.update_flag()

    def hold(self, held: bool) -> None:
        """Hold the FIFO empty with its flags at 0, as SPIRST = 0 does, or release it."""
        self._held = held
        if held:
            self.clear()
        self.update_flag()
