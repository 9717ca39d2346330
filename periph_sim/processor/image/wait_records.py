"""Waits of an image as records: when it sleeps or polls goes in; WAIT records come out, as of Python firmware."""

from __future__ import annotations

from ...core.records import Kind, Recorder
from ...core.state import State
from ...core.time import Clock

IDLE = "IDLE"
ENDLESS = "endless loop"  # which reads no register


class WaitRecords:
    STATE = State("_what")

    def __init__(self, recorder: Recorder, clock: Clock, unit: str) -> None:
        self._recorder, self._clock, self._unit = recorder, clock, unit
        self._what = ""

    def begins(self, what: str, cycle: int, place: str) -> None:
        """From this cycle on it waits for `what`, or in IDLE; "": in a loop of its own."""
        self._what = what or ENDLESS
        self._recorder.emit(self._clock.tick(cycle), Kind.WAIT, self._unit, self._what, 1, place)

    def ends(self, cycle: int) -> None:
        """The wait that began last is over."""
        self._recorder.emit(self._clock.tick(cycle), Kind.WAIT, self._unit, self._what, 0)
