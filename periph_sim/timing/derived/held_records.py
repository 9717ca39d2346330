"""Records of the time for which one unit, and no other party, holds SCL low during each transfer.

thing       tick                        value
held alone  START of each transfer      the sum of the durations within the transfer, in ticks
unfinished  START of the last transfer  the same sum, for a transfer that the end of the run cuts off
"""

# core: compiled

from __future__ import annotations

from typing import TYPE_CHECKING

from ...core.records import Kind, Recorder
from ...core.state import State
from ...core.time import NO_TIME
from ..measures.bus_from_wires import BusFromWires

if TYPE_CHECKING:
    from ...core.records import Topic

HELD_ALONE, UNFINISHED = "held alone", "unfinished"


class HeldRecords(BusFromWires):
    """Makes the records of the durations for which only one unit, and no other party, holds SCL low."""

    STATE = State("_sum", ticks="_began")

    def __init__(self, recorder: Recorder, unit: str) -> None:
        super().__init__(unit)
        self._held_alone: Topic = recorder.topic(Kind.TRANSFER, unit, HELD_ALONE)
        self._unfinished: Topic = recorder.topic(Kind.TRANSFER, unit, UNFINISHED)
        self._began = NO_TIME
        self._sum = 0

    def started(self, now: int) -> None:
        self._began, self._sum = now, 0

    def stopped(self, now: int) -> None:
        if self._began != NO_TIME:
            self._held_alone.emit(self._began, self._sum)
        self._began = NO_TIME

    def held(self, let_go: int, rose: int) -> None:
        self._sum += rose - let_go

    def finish(self, now: int) -> None:
        """Record a transfer that the end of the run cuts off."""
        self.settle()
        if self._began != NO_TIME:
            held = now - self.others_held_until if self.held_by_us_alone() else 0
            self._unfinished.emit(self._began, self._sum + held)
