"""SCI transmitter, line side: a frame's levels go in; the level of TXD at each SCICLK tick comes out.

The edges between a frame's first and its last may be taken away, for somebody who makes them himself: TXD stays at 0
meanwhile.

    send(tick, levels) --> [ticks of the edges] --step--> level

Source: TI SPRUFZ5A sections 1.2.3 and 1.2.7.
"""

# core: compiled

from __future__ import annotations

from typing import final

from .receiver_bits import FAR


@final
class SciTxBits:
    """A bit is eight ticks. `level` is what TXD has, `next_tick` when it changes.

    fresh: of the frame under way only the first edge has been made.
    """

    def __init__(self) -> None:
        self.level = 1
        self.next_tick = FAR
        self.fresh = False
        self._edges: list[int] = []  # ticks to come, last first
        self._count = 0  # of the frame's edges
        self._taken: list[int] = []  # edges of this frame that somebody else makes, last first

    def send(self, tick: int, levels: int, bits: int) -> None:
        """A frame of `bits` bits from `tick` on; bit 0 of `levels` goes first, the line stands at 1."""
        changes = levels ^ (levels << 1 | 1)
        edges = [tick + 8 * bit for bit in range(bits - 1, -1, -1) if changes >> bit & 1]
        self._edges = edges
        self._count = len(edges)
        self.fresh = False
        self.next_tick = edges[-1] if edges else FAR

    def resend(self, tick: int, levels: int, bits: int, done: int) -> None:
        """The frame begun at `tick` has these levels from its bit `done` on."""
        self.send(tick, levels & -(1 << done) | (-self.level & (1 << done) - 1), bits)
        while self._edges and self._edges[-1] < tick + 8 * done:
            self._edges.pop()
        self.next_tick = self._edges[-1] if self._edges else FAR

    def step(self) -> None:
        """`next_tick` has come."""
        self._edges.pop()
        self.level ^= 1
        self.fresh = len(self._edges) == self._count - 1
        self.next_tick = self._edges[-1] if self._edges else FAR

    def coming(self) -> list[int]:
        """The ticks of the edges to come."""
        return self._edges[::-1]

    def take(self) -> None:
        """All edges to come but the last are somebody else's."""
        self.fresh = False
        self._taken = self._edges[1:]
        del self._edges[1:]
        self.next_tick = self._edges[0]

    def give_back(self, count: int) -> None:
        """The last `count` of those that were taken are still to come, and are made here."""
        self._edges += self._taken[:count]
        self.level = count & 1
        self.next_tick = self._edges[-1]

    def stop(self) -> None:
        """The frame is cut off: TXD goes to 1."""
        self.fresh = False
        self.next_tick = FAR
        self.level = 1
