"""Counter of the bytes on an I2C bus, addresses included.

It is for scenes without a controller agent, which would count the bytes itself.
"""

# core: compiled

from __future__ import annotations

from ...core.sampler import watch
from ...core.state import State
from ...core.wire import Wire
from ...traces.decode.i2c_stream import BYTE_OVER, I2cStream
from .bit_skip import BitParty
from .bit_times import BitTimes


class I2cByteCounter(BitParty):
    """Counts the bytes on one bus.

    bytes: number of whole bytes with their acknowledge bit. Bytes that a START or STOP cuts off do not count.
    """

    STATE = State("stream")

    def __init__(self, scl: Wire, sda: Wire) -> None:
        self.bytes = 0
        self.stream = I2cStream(scl.level | sda.level << 1)
        watch([scl, sda], self)

    def sampled(self, now: int, levels: int) -> None:
        if self.stream.sample(levels) == BYTE_OVER:
            self.bytes += 1

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        """Return True at the begin of a byte; a master that is reset in a byte may leave the next one shifted."""
        return not self.stream.bits

    def on_bits_skipped(self, shown: int, times: BitTimes) -> None:
        self.stream.skip(shown)
