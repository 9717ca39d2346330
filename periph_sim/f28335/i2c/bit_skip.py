"""Bit skipping in the I2C master: its state after seven bits of a byte, or none.

    SCL, released at the output  __|~~|__|~~|_ ... _|~~|_      cycles: `release` + n (low + high)
                                   ^ bit position 0      ^ 7: the module wakes to release SCL for the eighth bit

`bus.i2c.bit_skip` describes when bits are skipped, and why that is unobservable.
"""

# core: compiled

from __future__ import annotations

from ...core.chip import NEVER
from .master_data import NO_BYTE, RECEIVE, I2cMasterData
from .master_lines import FALL, NO_STEP, RELEASE
from .register_map import SCL

SKIPPED_BITS = 7  # of a byte; the eighth decides
NO_BIT = -1
ONES = 0xFF


class I2cMasterBitSkip(I2cMasterData):
    """Adds the positions 0 and 7 of a byte to the master's states.

    skip_release: the cycle in which SCL was released for the first bit.
    skip_fell: the cycle in which the output SCL fell before it.
    skip_low: the low time of SCL in skipped bits, in cycles.
    skip_high: the time from a release of SCL to the next fall of the output, in cycles.
    """

    def reset_bit_skip(self) -> None:
        """Forget the last skip."""
        self.skip_low = self.skip_high = self._skip_delay = 0  # cycles
        self._in_before = self._sampled_before = self.skip_fell = self._rose_before = self.skip_release = 0

    def released_bit(self) -> int:
        """Return the number of the bit, 0 to 8, for which SCL has just been released; NO_BIT for a condition."""
        if not self._waits_for_rise or self._after_high != FALL or self._kind == NO_BYTE:
            return NO_BIT
        return self._bit

    def only_clocks(self) -> bool:
        """Return True if only the bits of a byte of eight are in progress."""
        return not (self.frozen or self.halting) and self._n == SKIPPED_BITS + 1 and self.due == NEVER

    def byte(self) -> int:
        """Return the byte that the master puts on SDA; 0xFF where it receives."""
        return ONES if self._kind == RECEIVE else self._byte

    def keeps_bus(self, shown: int) -> bool:
        """Return True if the master does not lose arbitration when the bus shows this byte."""
        return self._kind == RECEIVE or shown == self._byte

    def begin_skip(self, delay: int) -> None:
        """Remember the state in which SCL was just released for the first bit. delay: cycles from output to pin."""
        late = self.state.options.scl_sync_cycles.assume(self.state.touched) * self.state.tm if delay else 0
        self.skip_low, self.skip_high, self._skip_delay = self.low(), delay + late + self.high(), delay
        self._in_before, self._sampled_before = self._in, self._sampled
        self.skip_fell, self._rose_before, self.skip_release = self._low_from, self._rose_at, self._released_at

    def set_bit_position(self, shown: int, bit: int) -> None:
        """Take the state in which `bit` bits, 0 or 7, of the byte `shown` have passed."""
        period = self.skip_low + self.skip_high
        self._bit = bit
        self._drive(self.byte() >> (SKIPPED_BITS - bit) & 1)
        if bit:
            self.pulls |= SCL
            self._waits_for_rise = False
            self._in, self._sampled = (self._in_before & 1) << SKIPPED_BITS | shown >> 1, shown >> 1 & 1
            self._released_at = self.skip_release + (SKIPPED_BITS - 1) * period
            self._rose_at = self._released_at + self._skip_delay
            self._at(self.skip_release + SKIPPED_BITS * period, RELEASE)
            self._low_from = self.due - self.skip_low
        else:
            self.pulls &= ~SCL
            self._waits_for_rise = True
            self._in, self._sampled = self._in_before, self._sampled_before
            self._released_at, self._rose_at = self.skip_release, self._rose_before
            self._low_from = self.skip_fell
            self._at(NEVER, NO_STEP)
