"""One FIFO of the SPI with its register, flags and interrupt request.

    push --> 16 words --> pop        SPIFFTX: TXFFINT when TXFFST <= TXFFIL
               |                     SPIFFRX: RXFFINT when RXFFST >= RXFFIL, RXFFOVF when a 17th word arrives
               +--> level, flag --> request

Chosen, where the manual is silent:
- A FIFO that a reset holds empty does not set its interrupt flag; the flag stays as it is.
- Words and flags stay when SPIFFENA is cleared.
- Setting an enable while its flag is set requests at once.
- Each overflow requests RXINT, if RXFFOVF requests it at all.

Source: TI SPRUEU3 section 1.5 and the tables of SPIFFTX and SPIFFRX in section 2.1.9.
"""

from __future__ import annotations

from collections.abc import Callable

from ...core.fifo import Fifo
from ...core.registers import Register
from ...core.state import State
from .options import SpiOptions
from .register_map import SPI_MAP

DEPTH = 16

# SPIFFTX and SPIFFRX have these at the same bits.
RESET = SPI_MAP["SPIFFTX"]["TXFIFO"].mask  # 0 holds the FIFO empty
STATUS = SPI_MAP["SPIFFTX"]["TXFFST"].lsb
FLAG = SPI_MAP["SPIFFTX"]["TXFFINT"].mask
FLAG_CLEAR = SPI_MAP["SPIFFTX"]["TXFFINTCLR"].mask
ENABLE = SPI_MAP["SPIFFTX"]["TXFFIENA"].mask
LEVEL = SPI_MAP["SPIFFTX"]["TXFFIL"].mask

RXFFOVF = SPI_MAP["SPIFFRX"]["RXFFOVF"].mask
RXFFOVFCLR = SPI_MAP["SPIFFRX"]["RXFFOVFCLR"].mask


class InterruptFifo:
    """FIFO with its register.

    register: SPIFFTX or SPIFFRX.
    is_reached: (words, level) -> True if the interrupt is due.
    request: the FIFO's interrupt was requested since the owner last set this to False.
    """

    STATE = State("control fifo on request _held _was_reached")

    def __init__(
        self, register: Register, is_reached: Callable[[int, int], bool], options: SpiOptions, touched: set[str]
    ) -> None:
        self.register = register
        self.options = options
        self.touched = touched
        self.fifo = Fifo(DEPTH)
        self.control = register.reset  # without the number of words, which is counted
        self.on = False  # FIFO mode
        self.request = False
        self._held = False  # by SPIRST
        self._is_reached = is_reached
        self._was_reached = False

    @property
    def words(self) -> list[int]:
        """The words waiting, oldest first."""
        return self.fifo.words

    @property
    def accepts(self) -> bool:
        """True if no reset holds the FIFO empty."""
        return self.control & RESET > 0 and not self._held

    def push(self, word: int) -> bool:
        """Add a word. Return False if the FIFO is full or held empty."""
        pushed = self.accepts and self.fifo.push(word)
        self.update_flag()
        return pushed

    def push_over(self, word: int) -> bool:
        """Add a received word, replacing the oldest if the FIFO is full. Return True if the head changed."""
        if not self.accepts or self.push(word):
            return len(self.words) == 1
        self.fifo.pop()
        self.fifo.push(word)
        self.control |= RXFFOVF
        if self.control & ENABLE and self.options.rxffovf_interrupt.assume(self.touched) == "rxffiena":
            self.request = True
        return True

    def pop(self) -> int:
        """Remove and return the oldest word."""
        word = self.fifo.pop()
        self.update_flag()
        return word

    def update_flag(self) -> None:
        """Set the interrupt flag if the level has been reached."""
        reached = self.on and self.accepts and self._is_reached(len(self.fifo), self.control & LEVEL)
        if (
            reached
            and not self.control & FLAG
            and (not self._was_reached or self.options.fifo_int_mode.assume(self.touched) == "level")
        ):
            self.control |= FLAG
            self.request = self.request or self.control & ENABLE > 0
        self._was_reached = reached

    def write(self, value: int) -> None:
        """Write the register; the owner applies SPIRST and SPIFFENA with `hold` and `turn`."""
        before = self.control
        self.control, strobes = self.register.write(before, value)
        if strobes & FLAG_CLEAR:
            self.control &= ~FLAG
        if strobes & RXFFOVFCLR:
            self.control &= ~RXFFOVF
        if not self.control & RESET:
            self.fifo.clear()
        if self.on and self.control & FLAG and self.control & ~before & ENABLE:
            self.request = True
        self.update_flag()

    def show(self) -> int:
        """Return the register as the CPU reads it."""
        return self.control | len(self.fifo) << STATUS

    def turn(self, on: bool) -> None:
        """Turn FIFO mode on or off."""
        if on and not self.on and self.control & FLAG and self.control & ENABLE:
            self.request = True
        self.on = on
        self.update_flag()

    def hold(self, held: bool) -> None:
        """Hold the FIFO empty with its flags at 0, as SPIRST = 0 does, or release it."""
        self._held = held
        if held:
            self.clear()
        self.update_flag()

    def clear(self) -> None:
        """Empty the FIFO and clear its flags."""
        self.fifo.clear()
        self.control &= ~FLAG
        if "RXFFOVF" in self.register:
            self.control &= ~RXFFOVF

    def reset(self) -> None:
        """Reset by XRS."""
        self.fifo.clear()
        self.control = self.register.reset
        self.on = self.request = self._held = self._was_reached = False
