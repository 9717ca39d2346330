"""Functions of an image as spans: SPAN records of their begins and ends.

A function that calls itself is one span, from its first call to its last return.
"""

from __future__ import annotations

from collections.abc import Callable

from ...core.records import Kind, Recorder
from ...core.state import State
from .call_stack import CallListener


class FunctionSpans(CallListener):
    """place: returns the place of the first instruction of a named function."""

    STATE = State("_depth")

    __slots__ = ("_depth", "_place", "_places", "_recorder", "_unit")

    def __init__(self, recorder: Recorder, unit: str, place: Callable[[str], str]) -> None:
        self._recorder = recorder
        self._unit = unit
        self._place = place
        self._places: dict[str, str] = {}
        self._depth: dict[str, int] = {}

    def called(self, name: str, tick: int) -> None:
        depth = self._depth[name] = self._depth.get(name, 0) + 1
        if depth == 1:
            place = self._places.get(name)
            if place is None:
                place = self._places[name] = self._place(name)
            self._recorder.emit(tick, Kind.SPAN, self._unit, name, 1, place)

    def returned(self, name: str, tick: int) -> None:
        depth = self._depth[name] = self._depth[name] - 1
        if not depth:
            self._recorder.emit(tick, Kind.SPAN, self._unit, name, 0)
