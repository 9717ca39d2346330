"""SCI transmitter, line side: a frame's levels go in; the level of TXD at each SCICLK tick comes out.

    send(tick, levels) --> [ticks of the edges] --step--> level

Source: TI SPRUFZ5A sections 1.2.3 and 1.2.7.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.state import State
from .receiver_bits import FAR


@final
class SciTxBits:
    """A bit is eight ticks. `level` is that of TXD, and `next_tick` the tick at which it changes."""

    STATE = State("level next_tick _edges")

    def __init__(self) -> None:
        self.level = 1
        self.next_tick = FAR
        self._edges: list[int] = []  # ticks to come, last first

    def send(self, tick: int, levels: int, bits: int) -> None:
        """A frame of `bits` bits from `tick` on; bit 0 of `levels` goes first, the line stands at 1."""
        changes = levels ^ (levels << 1 | 1)
        edges = [tick + 8 * bit for bit in range(bits - 1, -1, -1) if changes >> bit & 1]
        self._edges = edges
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
        self.next_tick = self._edges[-1] if self._edges else FAR

    def stop(self) -> None:
        """The frame is cut off: TXD goes to 1."""
        self.next_tick = FAR
        self.level = 1
