"""The state of an I2C bus as a controller sees it behind its spike filter: SDA, and whether the bus is busy.

Source: UM10204 section 3.1.4 (the bus is busy from a START to its STOP), Table 10 (tSP, tBUF).
"""

# core: compiled without checks for None

from __future__ import annotations

from typing import final

from ...core.state import State
from .line_events import EVENTS, IDLE, NOTHING, SCL, SDA, START, STOP


@final
class FilteredBus:
    """The state of one bus after a spike filter.

    filter: the minimum length, in ticks, of a level of SDA; shorter levels are ignored as spikes.
    free: the minimum time, in ticks, between a STOP and the next START.
    busy: True from a START to the next STOP, whichever controller makes them.
    last_stop: the tick of the last STOP.
    scl_moved: the tick of the last change of SCL, spikes included.
    """

    STATE = State(
        "busy _lines _scl_seen _sda_event _sda_seen",
        ticks="last_stop scl_moved _sda_moved",
        expires="last_stop scl_moved _sda_moved",
    )

    __slots__ = (
        "_filter",
        "_lines",
        "_scl_seen",
        "_sda_event",
        "_sda_moved",
        "_sda_seen",
        "busy",
        "last_stop",
        "scl_moved",
    )

    def __init__(self, now: int, filter: int, free: int) -> None:
        self.busy = False
        self.last_stop = -free
        self.scl_moved = now
        self._filter = filter
        self._lines = IDLE
        # When SCL changes, the level that ends is stored here if it lasted for the filter time. After a spike, this
        # therefore equals the present level.
        self._scl_seen = SCL
        self._sda_moved = -filter
        self._sda_event = NOTHING  # the last change of SDA, classified as START, STOP or NOTHING
        self._sda_seen = 1  # the level of SDA after the filter

    def sampled(self, now: int, levels: int) -> None:
        """Process new levels of both lines."""
        before = self._lines
        event = EVENTS >> 3 * (before << 2 | levels) & 7
        if (before ^ levels) & SDA:
            if before >> 1 != self._sda_seen:
                self.settle(now)
            # SCL has been low for less than the filter time. This may be a spike, so SCL still counts as high.
            if event == NOTHING and now - self.scl_moved < self._filter and self._scl_seen:
                event = START if before & SDA else STOP
            self._sda_moved, self._sda_event = now, event
        if (before ^ levels) & SCL:
            if now - self.scl_moved >= self._filter:
                self._scl_seen = before & SCL
            self.scl_moved = now
        self._lines = levels
        if levels >> 1 != self._sda_seen:
            self.settle(now)

    def settle(self, now: int) -> None:
        """Apply the last change of SDA, with its original tick, if the new level has lasted for the filter time."""
        level = self._lines >> 1
        if level == self._sda_seen or now - self._sda_moved < self._filter:
            return
        self._sda_seen = level
        if self._sda_event == START:
            self.busy = True
        elif self._sda_event == STOP:
            self.busy = False
            self.last_stop = self._sda_moved

    def sda(self, now: int) -> int:
        """Return the level of SDA after the filter."""
        self.settle(now)
        return self._sda_seen

    def passes(self, shortest: int) -> bool:
        """Return True if levels that last `shortest` ticks pass the filter."""
        return self._filter <= shortest

    def jump(self, level: int, scl_fell: int, sda_moved: int) -> None:
        """Enter the state after bits that were skipped (`bit_skip`).

        SCL has been low since tick `scl_fell`, and SDA has been at `level` since tick `sda_moved`.
        """
        self._lines = SDA if level else 0
        self._sda_seen, self._sda_event, self._sda_moved = level, NOTHING, sda_moved
        self._scl_seen, self.scl_moved = SCL, scl_fell
