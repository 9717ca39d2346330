"""Replay of recorded edges on a wire, with one event for each edge.

EdgePlayer --> OneWayWire --> the chip's input      the chip's input sees only what the player drives;
                     back <-- the chip's output     the chip's output drives another wire
"""

from __future__ import annotations

from collections.abc import Sequence

from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.state import State
from ..core.wire import Pin, Wire

PLAYER = "capture"  # the name under which each EdgePlayer is a party of its wire


class EdgePlayer:
    """Plays edges on a wire. edges: pairs (tick, level) in order of time. The line is high before the first edge."""

    STATE = State("_next")

    def __init__(self, kernel: Kernel, wire: Wire, edges: Sequence[tuple[int, int]]) -> None:
        self._kernel = kernel
        self._pin = wire.attach(PLAYER)
        self._edges = edges
        self._next = 0
        self._plan()

    def _plan(self) -> None:
        if self._next < len(self._edges):
            self._kernel.call_at(self._edges[self._next][0], self._edge)

    def _edge(self) -> None:
        self._pin.drive(self._edges[self._next][1])
        self._next += 1
        self._plan()


class OneWayWire(Wire):
    """A wire that only its EdgePlayer drives. All other parties read this wire, but drive the wire `back`.

    back: the wire that all other parties drive; its edges are not recorded.
    """

    def __init__(self, kernel: Kernel, name: str, recorder: Recorder) -> None:
        super().__init__(kernel, name, recorder)
        self.back = Wire(kernel, name, Recorder())

    def attach(self, who: str) -> Pin:
        """Attach a party and return its pin: on this wire for the player, on `back` for all others."""
        return super().attach(who) if who == PLAYER else self.back.attach(who)
