"""Replay of a line's edges from levels with their ticks, one event for each edge."""

from __future__ import annotations

from collections.abc import Sequence

from ..core.kernel import Kernel
from ..core.state import State
from ..core.wire import Wire


class EdgePlayer:
    """Plays edges on a wire. edges: pairs (tick, level) in order of time. The line is high before the first edge."""

    STATE = State("_next")

    def __init__(self, kernel: Kernel, wire: Wire, edges: Sequence[tuple[int, int]], who: str = "capture") -> None:
        self.who = who
        self._kernel = kernel
        self._pin = wire.attach(who)
        self._edges = edges
        self._next = 0
        self._plan()

    @property
    def busy(self) -> bool:
        return self._next < len(self._edges)

    def _plan(self) -> None:
        if self.busy:
            self._kernel.call_at(self._edges[self._next][0], self._edge)

    def _edge(self) -> None:
        self._pin.drive(self._edges[self._next][1])
        self._next += 1
        self._plan()
