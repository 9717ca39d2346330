"""Base of the senders on a UART line: makes edges at given ticks, one kernel event each."""

# core: compiled

from __future__ import annotations

from ...core.agent import Agent
from ...core.event_queue import Event
from ...core.kernel import Kernel
from ...core.state import State

EDGE = 0x100  # tag of the events of edges; a subclass may have others


class EdgeSender(Agent):
    """Makes edges on a line, each with an event of the kernel. mask: the bit of this party among those that pull."""

    STATE = State("_level _next", ticks="_edges")

    __slots__ = ("_edges", "_kernel", "_level", "_mask", "_next")

    def __init__(self, kernel: Kernel, mask: int) -> None:
        self._kernel = kernel
        self._mask = mask
        self._edges: list[int] = []  # ticks of the edges that are left, the last edge first
        self._level = 1
        self._next: Event | None = None

    def drive(self, level: int) -> None:
        """Put the line at this level."""
        raise NotImplementedError

    def last_edge(self) -> None:
        """Called when the last edge has been made."""

    def make(self, edges: list[int]) -> None:
        """Make edges at these ticks, which are listed with the last one first. The first edge is a fall."""
        self._edges = edges
        self._then(edges[-1])

    def act(self, tag: int) -> None:
        self.edge()

    def edge(self) -> None:
        """Make the edge that is due."""
        edges = self._edges
        edges.pop()
        self._level ^= 1
        self.drive(self._level)
        if edges:
            self._then(edges[-1])
        else:
            self.last_edge()

    def _then(self, tick: int) -> None:
        if self._next is None:
            self._next = self._kernel.schedule(tick, self, EDGE)
        else:
            self._kernel.reschedule(self._next, tick, EDGE)
