"""An I2C target for a chip with registers behind a pointer: converts bytes of transfers to register accesses.

    START, address+W --> pointer, data, data ... --> write(pointer), pointer advances
    START, address+R --> read(pointer), pointer advances

The first byte of a write sets the pointer, which keeps its value after STOP and repeated START. The chip decides
whether it acknowledges its address, and to which register the pointer advances. Every written byte is acknowledged.

Source: data sheets of ADXL345, ITG-3200, HMC5883L, sections on the I2C interface.
"""

from __future__ import annotations

from collections.abc import Callable

from ..core.registers import NamedByte
from ..core.state import State
from .chips.register_chip import RegisterChip
from .targets import PlainReply


class RegisterPointer(PlainReply):
    """The target of a chip. `answer` returns this object itself as the reply.

    now: a function that returns the time in ticks.
    touched: a function that is called after each access to a register.
    """

    STATE = State("chip _number _used")
    pointer_bytes = 1

    def __init__(self, chip: RegisterChip, now: Callable[[], int], touched: Callable[[], None] = lambda: None) -> None:
        self.chip = chip
        self._now = now
        self._touched = touched
        self._number = 0  # the pointer as set by a write; after an access, the number of the accessed register
        self._used = False  # True after an access to register `_number`: the pointer is then the register after it

    @property
    def pointer(self) -> int:
        """The register of the next access; 0 after power-on."""
        return self.chip.following(self._number) if self._used else self._number

    def named(self, value: int, before: int | None) -> NamedByte:
        """Return the name and the meaning of the byte that is transferred next.

        value: the byte.
        before: the previous byte of the burst; None if this byte is the first.
        """
        return self.chip.named(self.pointer, value, before)

    def answer(self, address_byte: int) -> RegisterPointer | None:
        """Return this object if the byte addresses the chip and the chip acknowledges; else None."""
        if address_byte >> 1 != self.chip.address or not self.chip.begin(self._now()):
            return None
        return self

    def send_byte(self, byte: int) -> int:
        value = self.chip.read(self._now(), self._use())
        self._touched()
        return value

    def receive_byte(self, byte: int, value: int) -> bool:
        if byte == 0:
            self._number, self._used = value, False
        else:
            self.chip.write(self._now(), self._use(), value)
            self._touched()
        return True

    def _use(self) -> int:
        self._number, self._used = self.pointer, True
        return self._number
