"""Triggers of sends and replies: an event, or characters from a line.

records --EventTrigger--.
characters --TextTrigger-+--> happened(tick)
"""

from __future__ import annotations

from collections.abc import Callable

from ...bus.uart.reader import Heard
from ...core.state import State
from ...timing.language.events import Matcher
from ...timing.measures.event_pairing import EventMeasure


class EventTrigger(EventMeasure):
    """Calls `happened(tick)` each time an event happens."""

    def __init__(self, event: Matcher, happened: Callable[[int], None]) -> None:
        super().__init__(event)
        self._happened = happened

    def happened(self, place: int, tick: int, value: int) -> None:
        self._happened(tick)

    def never(self) -> str:
        """Return why it did not happen, as a phrase."""
        return self.missing()


class TextTrigger:
    """Calls `happened(tick)` at the end of the last of these characters, each time they come; overlaps count once."""

    STATE = State("_came")

    def __init__(self, characters: bytes, happened: Callable[[int], None]) -> None:
        self._wanted = characters
        self._happened = happened
        self._came = b""

    def character(self, heard: Heard) -> None:
        if not heard.good:
            self._came = b""
            return
        self._came = (self._came + bytes([heard.value]))[-len(self._wanted) :]
        if self._came == self._wanted:
            self._came = b""
            self._happened(heard.end)
