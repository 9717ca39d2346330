"""A chip with registers behind a pointer, as an I2C target: bytes of transfers go in, register accesses come out.

    START, address+W --> pointer, data, data ... --> write(pointer), pointer moves on
    START, address+R --> read(pointer), pointer moves on

The first byte of a write sets the pointer, which outlives STOP and repeated START. Whether it acknowledges its
address, and where the pointer goes next, the chip says. Every written byte is acknowledged.

Source: data sheets of ADXL345, ITG-3200, HMC5883L, sections on the I2C interface.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from ..bus.i2c.target_side import Stretches


class Registers(Protocol):
    """What a chip answers; `now` in ticks, never falling from call to call."""

    address: int

    def begin(self, now: int) -> bool:
        """It is addressed: a burst begins. False: it does not acknowledge."""

    def read(self, now: int, number: int) -> int: ...

    def write(self, now: int, number: int, value: int) -> None: ...

    def following(self, number: int) -> int:
        """Where the pointer goes after an access to this register; asked when it matters."""


class RegisterPointer:
    """It is both who is asked for a reply and the reply. now: the time in ticks. touched: called after each access."""

    ack = True
    stretches: Stretches = ()

    def __init__(self, chip: Registers, now: Callable[[], int], touched: Callable[[], None] = lambda: None) -> None:
        self.chip = chip
        self._now = now
        self._touched = touched
        self._number = 0  # where the pointer was set, or what it named at the last access
        self._used = False  # the access has been, so the pointer has moved on

    @property
    def pointer(self) -> int:
        """The register that an access would be to; 0 after power-on."""
        return self.chip.following(self._number) if self._used else self._number

    def answer(self, address_byte: int) -> RegisterPointer | None:
        """This, if the chip is meant and acknowledges; else None."""
        if address_byte >> 1 != self.chip.address or not self.chip.begin(self._now()):
            return None
        return self

    def sends(self, byte: int) -> int:
        value = self.chip.read(self._now(), self._use())
        self._touched()
        return value

    def hears(self, byte: int, value: int) -> bool:
        if byte == 0:
            self._number, self._used = value, False
        else:
            self.chip.write(self._now(), self._use(), value)
            self._touched()
        return True

    def _use(self) -> int:
        self._number, self._used = self.pointer, True
        return self._number
