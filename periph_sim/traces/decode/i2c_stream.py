"""I2C decoder of streams: takes the levels of the lines sample by sample, as they come.

    levels --> START, STOP, rises and falls of SCL; which of them ends a whole byte

It follows `i2c_states`, as the decoder of arrays does (`i2c_table`).
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.state import State
from .i2c_states import BITS, EVENTS, FALL, KINDS, RISE, SDA, START

BYTE = KINDS + 1  # added to the event that ends a byte: SCL's fall, or START or STOP in the ninth pulse
BYTE_OVER = FALL + BYTE


@final
class I2cStream:
    """levels: SCL is bit 0, SDA bit 1.

    busy: True between a START and its STOP.
    index: whole bytes since the START, less one: -1 before the address is over.
    byte, acked: the last whole byte and its ACK.
    address, read: of the phase's address byte, when it is over.
    bits: bits of the byte under way, the ninth included.
    """

    STATE = State("levels busy index byte acked address read bits _shifted", made=True)

    __slots__ = ("_shifted", "acked", "address", "bits", "busy", "byte", "index", "levels", "read")

    def __init__(self, levels: int = 3) -> None:
        self.levels = levels
        self.busy = False
        self.index = -1
        self.byte = 0
        self.acked = False
        self.address = 0
        self.read = False
        self.bits = self._shifted = 0

    def sample(self, levels: int) -> int:
        """Take the levels of the next sample; return the event, with BYTE where it ends a byte."""
        event: int = EVENTS >> 3 * (self.levels << 2 | levels) & KINDS
        self.levels = levels
        if event == RISE:
            if self.busy:
                self.bit(levels >> 1)
        elif event:
            ended = self.bits == BITS
            if ended:
                self.byte_over()
            if event >= START:
                self.condition(event == START)
            if ended:
                event |= BYTE
        return event

    def condition(self, start: bool) -> None:
        """Begin a phase, or end the transfer."""
        self.busy = start
        self.bits = self._shifted = 0
        if start:
            self.index = -1

    def bit(self, level: int) -> None:
        """Take a bit of the byte under way."""
        self.bits += 1
        self._shifted = self._shifted << 1 | level

    def byte_over(self) -> None:
        """End the byte under way, all of whose bits have come."""
        self.byte, self.acked = self._shifted >> 1, not self._shifted & 1
        if self.index < 0:
            self.address, self.read = self.byte >> 1, bool(self.byte & 1)
        self.index += 1
        self.bits = self._shifted = 0

    def skip(self, shown: int) -> None:
        """Take seven bits of the byte `shown` at once; SCL is low before the eighth."""
        self.levels = SDA if shown & 1 else 0
        if self.busy:
            self.bits, self._shifted = BITS - 2, shown >> 1
