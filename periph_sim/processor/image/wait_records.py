"""WAIT records of an image, in the same form as those of Python firmware."""

from __future__ import annotations

from ...core.records import Kind, Recorder
from ...core.state import State
from ...core.time import Clock

IDLE = "IDLE"
ENDLESS = "endless loop"  # one that reads no register


class WaitRecords:
    STATE = State("_what")

    def __init__(self, recorder: Recorder, clock: Clock, unit: str) -> None:
        self._recorder, self._clock, self._unit = recorder, clock, unit
        self._what = ""

    def begins(self, what: str, cycle: int, place: str) -> None:
        """Record the begin of a wait for `what`, or in IDLE; "": an endless loop that reads no register."""
        self._what = what or ENDLESS
        self._recorder.emit(self._clock.tick(cycle), Kind.WAIT, self._unit, self._what, 1, place)

    def ends(self, cycle: int) -> None:
        """Record the end of the last wait."""
        self._recorder.emit(self._clock.tick(cycle), Kind.WAIT, self._unit, self._what, 0)
