"""Counter of the bytes on an I2C bus, addresses included.

For scenes without a controller agent, which would count them.
"""

# core: compiled

from __future__ import annotations

from ...core.sampler import watch
from ...core.state import State
from ...core.wire import Wire
from .bit_skip import BitParty
from .bit_times import SKIPPED_BITS, BitTimes
from .line_events import EVENTS, FALL, IDLE, RISE, SDA, START, STOP

PULSES = 9  # eight bits and the acknowledge


class I2cByteCounter(BitParty):
    """bytes: number of whole bytes with acknowledge; those cut off by a START or STOP do not count."""

    STATE = State("_lines _active _pulses")

    def __init__(self, scl: Wire, sda: Wire) -> None:
        self.bytes = 0
        self._lines = IDLE
        self._active = False
        self._pulses = 0
        watch([scl, sda], self)

    def sampled(self, now: int, levels: int) -> None:
        event = EVENTS >> 3 * (self._lines << 2 | levels) & 7
        self._lines = levels
        if event in (START, STOP):
            self._active = event == START
            self._pulses = 0
        elif event == RISE:
            self._pulses += self._active
        elif event == FALL and self._pulses == PULSES:
            self.bytes += 1
            self._pulses = 0

    def on_bits_skipped(self, shown: int, times: BitTimes) -> None:
        self._lines = SDA if shown & 1 else 0
        self._pulses = SKIPPED_BITS if self._active else 0
