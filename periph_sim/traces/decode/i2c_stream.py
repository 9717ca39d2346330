"""I2C decoder of streams: takes the levels of the lines sample by sample, as they come.

    levels --> START, STOP, rises and falls of SCL; which of them ends a whole byte

Its table of states is also that of the decoder of arrays (`i2c_table`):

    EVENTS >> 3 * (before << 2 | now) & 7     event between two samples; levels: bit 0 is SCL, bit 1 is SDA
    COUNTED[rises]                            bits that count if START or STOP comes after this number of SCL rises

START and STOP are changes of SDA with SCL high in both samples. If both lines change at once, SCL counts. The SCL
pulse in which START or STOP comes holds no bit, unless it is the ninth: the sender sampled the ACK when SCL rose.
Agents on the simulated bus have a table of their own, since the decoders are an oracle for them.

Source: UM10204 sections 3.1.3 to 3.1.6.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.state import State

SCL, SDA = 1, 2
BITS = 9  # of a byte, its ACK included

NOTHING, FALL, RISE, START, STOP = range(5)
KINDS = 7  # mask of these
BYTE = KINDS + 1  # added to the event that ends a byte: SCL's fall, or START or STOP in the ninth pulse
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
