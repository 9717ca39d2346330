"""Counts the bytes on an I2C bus, addresses included: samples of the lines go in, a number comes out.

For scenes in which no agent is the controller and so nobody else counts.
"""

# core: compiled

from __future__ import annotations

from ...core.wire import Wire, watch
from .bit_times import BitTimes
from .edge_play import BITS
from .line_events import EVENTS, FALL, IDLE, RISE, SDA, START, STOP
from .whole_bytes import ByteParty

PULSES = 9  # eight bits and the acknowledge


class I2cByteCounter(ByteParty):
    """bytes: whole ones, each with its acknowledge; what is cut off by a START or STOP does not count."""

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

    def edge(self, tick: int, levels: int) -> None:
        self.sampled(tick, levels)

    def heard(self, shown: int, times: BitTimes) -> None:
        self._lines = SDA if shown & 1 else 0
        self._pulses = BITS if self._active else 0
