"""Makes the edges of UART frames on a line: their ticks go in; one event each comes out, or two of a frame that passes.

A frame begins with a fall and ends with a rise. Before the fall it is asked whether the edges between may pass (see
`whole_frames`).
"""

# core: compiled

from __future__ import annotations

from ...core.kernel import Event, Kernel
from .whole_frames import FrameSender, WholeFrames

EDGE = 0x100  # what an event is for: an edge; a subclass may have others


class EdgeSender(FrameSender):
    """mask: its hold on the line. whole_frames: through which frames pass, where they may."""

    __slots__ = ("_counts", "_edges", "_kernel", "_left", "_level", "_mask", "_next", "whole_frames")

    def __init__(self, kernel: Kernel, mask: int) -> None:
        self.whole_frames: WholeFrames | None = None
        self._kernel = kernel
        self._mask = mask
        self._edges: list[int] = []  # ticks, last first
        self._counts: list[int] = []  # how many edges each frame has that is still to begin, last first
        self._left = 0  # edges to come of the frame under way
        self._level = 1
        self._next: Event | None = None

    def drive(self, level: int) -> None:
        """Put the line at this level."""
        raise NotImplementedError

    def last_edge(self) -> None:
        """The last edge of all has been made."""

    def make(self, edges: list[int], counts: list[int]) -> None:
        """Make these edges; `counts` says how many of them each frame has. Both are lists with the last first."""
        self._edges, self._counts = edges, counts
        self._then(edges[-1])

    def act(self, tag: int) -> None:
        self.edge()

    def edge(self) -> None:
        """The next edge is due."""
        edges = self._edges
        edges.pop()
        self._level ^= 1
        if not self._left:
            self._begin_frame()
        else:
            self._left -= 1
            if not self._left and self.whole_frames is not None:
                self.whole_frames.over()
        self.drive(self._level)
        if edges:
            self._then(edges[-1])
        else:
            self.last_edge()

    def _begin_frame(self) -> None:
        edges = self._edges
        left: int
        left = self._left = self._counts.pop() - 1
        if self.whole_frames is None:
            return
        behind: int = len(edges) - left + 1  # the edges up to the last of this frame begin there
        between = edges[behind:]
        between.reverse()
        if self.whole_frames.passes(self, self._mask, between, edges[behind - 1]):
            del edges[behind:]
            self._left = 1

    def take_back(self, edges: list[int]) -> None:
        if edges:
            self._left += len(edges)
            self._level = len(edges) & 1
            edges.reverse()
            self._edges += edges
            assert self._next is not None
            self._kernel.cancel(self._next)
            self._then(self._edges[-1])
        else:
            self._level = 0

    def _then(self, tick: int) -> None:
        if self._next is None:
            self._next = self._kernel.ask(tick, self, EDGE)
        else:
            self._kernel.renew(self._next, tick, EDGE)
