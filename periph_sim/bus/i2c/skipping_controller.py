"""An I2C controller that skips the first seven bits of each byte in which they are unobservable (`bit_skip`).

release of SCL for the first bit --edge by edge--> end of this bit, second bit ...
            `--seven bits are skipped--> release of SCL for the eighth bit
"""

# core: compiled

from __future__ import annotations

from .bit_skip import ONES, SKIPPED_BITS, BitSkip
from .controller import NO_BYTE, RELEASE, I2cController
from .line_events import SCL


class SkippingController(I2cController):
    """A controller that skips bits. bit_skip: the shortcut, which must be set before the first transfer."""

    __slots__ = ("bit_skip",)

    bit_skip: BitSkip

    def _release(self) -> None:
        if self._index != NO_BYTE:
            if self._bit == 0:
                if self.bit_skip.skips(self._low_time, self._high, self._hold, RELEASE):
                    return
            elif self._bit == SKIPPED_BITS:
                self.bit_skip.over()
        I2cController._release(self)

    def pulls(self, line: int) -> int:
        return self._scl_mask if line == SCL else self._sda_mask

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        """Return True if no check for a stuck line is scheduled, and no level is too short for the spike filter."""
        return self._guard is None and self._bus.passes(min(high, hold, low - hold))

    def byte(self) -> int:
        return ONES if self._receiving else self._byte

    def keeps_bus(self, shown: int) -> bool:
        """Return False if the controller loses arbitration, because another party pulls SDA during a 1."""
        return self._receiving or shown == self._byte

    def set_bit_position(self, shown: int, bit: int, fell: int) -> None:
        level = shown >> (SKIPPED_BITS - bit) & 1
        self._bit, self._in = bit, shown >> (SKIPPED_BITS + 1 - bit)
        self._sda_level = self.byte() >> (SKIPPED_BITS - bit) & 1
        self._bus.jump(level, fell, fell + self._hold)
        if bit and self._index == 0:
            self._phase.answer_at = self._kernel.now
