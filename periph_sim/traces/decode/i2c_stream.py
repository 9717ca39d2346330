"""I2C decoder of streams: it receives the levels of the lines sample by sample.

    levels --> START, STOP, rises and falls of SCL; the flag BYTE marks an event that ends a complete byte

The decoder of arrays, `i2c_table`, uses the same two tables:

    EVENTS >> 3 * (before << 2 | now) & 7     the event between two samples; bit 0 of a sample is SCL, bit 1 is SDA
    COUNTED[rises]                            number of bits of a byte if a START or STOP follows after this number of
                                              rises of SCL in the byte

START and STOP are changes of SDA with SCL high in both samples. If both lines change at once, the event is an edge of
SCL. A pulse of SCL that contains a START or STOP is counted as a bit only if it is the ninth pulse of a byte, because
its ACK was already transferred when SCL rose. The agents on the simulated bus have their own table, because the
decoders are the test oracle for them.

Source: UM10204 sections 3.1.3 to 3.1.6.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.state import State

SCL, SDA = 1, 2
BITS = 9  # number of bits of a byte with its ACK

NOTHING, FALL, RISE, START, STOP = range(5)
KINDS = 7  # mask that keeps the event (one of these five) and removes the flag BYTE
# BYTE is added to an event that ends a byte: to the fall of SCL after the ninth bit, or to a START or STOP in the ninth
# pulse of SCL. BYTE_OVER is the fall with this flag.
BYTE = KINDS + 1
BYTE_OVER = FALL + BYTE


def _event(before: int, now: int) -> int:
    if (before ^ now) & SCL:
        return RISE if now & SCL else FALL
    if before == now or not now & SCL:
        return NOTHING
    return STOP if now & SDA else START


EVENTS = sum(_event(pair >> 2, pair & 3) << 3 * pair for pair in range(16))
COUNTED = (0, *range(BITS - 1), BITS)


@final
class I2cStream:
    """Decoder of one I2C bus.

    levels: the levels of the last sample; SCL is bit 0 and SDA bit 1.
    busy: True between a START and its STOP.
    index: the number of the last complete byte of the phase: 0 for the address byte, 1 for the first data byte; -1 if
        no byte is complete yet. A phase begins at each START and repeated START.
    byte: the first eight bits of the last complete byte.
    acked: True if the last complete byte was acknowledged.
    address, read: the address and the direction of the phase, valid if `index` is 0 or more.
    bits: the number of received bits of the present byte, including the ninth.
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
        """Decode the levels of the next sample. Return the event, with BYTE set if the event ends a byte."""
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
        """Begin a phase at a START, or end the transfer at a STOP."""
        self.busy = start
        self.bits = self._shifted = 0
        if start:
            self.index = -1

    def bit(self, level: int) -> None:
        """Add a bit to the present byte."""
        self.bits += 1
        self._shifted = self._shifted << 1 | level

    def byte_over(self) -> None:
        """End the present byte, all bits of which have been received."""
        self.byte, self.acked = self._shifted >> 1, not self._shifted & 1
        if self.index < 0:
            self.address, self.read = self.byte >> 1, bool(self.byte & 1)
        self.index += 1
        self.bits = self._shifted = 0

    def skip(self, shown: int) -> None:
        """Add the first seven bits of the byte `shown` at once.

        Afterwards SCL is low, and SDA has the level of the eighth bit.
        """
        self.levels = SDA if shown & 1 else 0
        if self.busy:
            self.bits, self._shifted = BITS - 2, shown >> 1
