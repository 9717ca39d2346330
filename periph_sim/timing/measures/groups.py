"""Groups of events, as in "the last byte of a transfer".

transfer   from its START to the START of the next transfer
round      from its first START to the first START of the next round (see `timing/rounds.py`)
burst      UART frames of one wire, with no pause between them that is longer than two characters
interrupt  from the start of a service routine to its end
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable

from ...core.state import State
from ...core.time import NO_TIME
from ..language.matcher import Group, Matcher
from .measure import MeasuredScene

PAUSE = 2  # a burst ends after a pause of more than this number of character times


class Groups:
    """Counts an event within each group, such as a transfer, to find the n-th event of the group.

    nth: the number of the event in each group that counts, from 1; -1 for the last event; 0 if only the groups matter.
    inside: True while a group is in progress.
    matchers: the events that begin and end a group.
    """

    STATE = State("inside _seen", ticks="_frame_began _frame_ended")

    def __init__(self, group: Group, nth: int) -> None:
        self.nth = nth
        self.inside = False
        self._group = group
        self.matchers: tuple[Matcher, ...] = (group.begin, group.end)
        self._ends: bool = group.name == "interrupt"  # True if the end event ends a group; else the next group ends it
        self._seen = 0
        self._begins_round: Callable[[], bool] | None = None
        self._frame_began = self._frame_ended = NO_TIME

    def listen(self, scene: MeasuredScene) -> None:
        if self._group.name == "round":
            self._begins_round = scene.rounds_at_start()

    def begins(self, tick: int, begin: bool, end: bool) -> bool:
        """Handle a record and return True if it begins a group.

        begin: True if the record is an event that can begin a group.
        end: True if the record is an event that can end a group.
        """
        first = begin and self._is_first(tick)
        if end:
            self._frame_ended = tick
            self.inside = self.inside and not self._ends
        if first:
            self._seen, self.inside = 0, True
        return first

    def _is_first(self, now: int) -> bool:
        if self._group.name == "burst":
            character = self._frame_ended - self._frame_began
            first = self._frame_ended == NO_TIME or now - self._frame_ended > PAUSE * character
            self._frame_began = now
            return first
        return self._begins_round is None or self._begins_round()

    def lasts(self, now: int) -> bool:
        """Return True if the present group may continue after tick `now`, at which the scene is at rest.

        At rest, no transfer is in progress. The next START begins a new transfer, and perhaps a new round, so the
        result for these groups is always False.
        """
        if self._ends:
            return self.inside
        if self._group.name != "burst" or self._frame_began == NO_TIME:
            return False
        return now - self._frame_ended <= PAUSE * (self._frame_ended - self._frame_began)

    def is_nth(self) -> bool:
        """Count an event, and return True if it is the n-th of its group."""
        self._seen += self.inside
        return self.inside and self._seen == self.nth
