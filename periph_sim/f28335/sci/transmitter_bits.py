"""SCI transmitter, line side: the level of TXD at each SCICLK tick, from the levels of a frame.

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
    """Line side of the transmitter. A bit is eight ticks.

    level: level of TXD.
    next_tick: the tick at which it changes.
    """

    STATE = State("level next_tick _edges")

    def __init__(self) -> None:
        self.level = 1
        self.next_tick = FAR
        self._edges: list[int] = []  # ticks of the coming edges, the last one first

    def send(self, tick: int, levels: int, bits: int) -> None:
        """Send a frame of `bits` bits from `tick` on, bit 0 of `levels` first. The line must be at 1."""
        changes = levels ^ (levels << 1 | 1)
        edges = [tick + 8 * bit for bit in range(bits - 1, -1, -1) if changes >> bit & 1]
        self._edges = edges
        self.next_tick = edges[-1] if edges else FAR

    def resend(self, tick: int, levels: int, bits: int, done: int) -> None:
        """Replace the levels of the frame that began at `tick`, from its bit `done` on."""
        self.send(tick, levels & -(1 << done) | (-self.level & (1 << done) - 1), bits)
        while self._edges and self._edges[-1] < tick + 8 * done:
            self._edges.pop()
        self.next_tick = self._edges[-1] if self._edges else FAR

    def step(self) -> None:
        """Toggle TXD at `next_tick`."""
        self._edges.pop()
        self.level ^= 1
        self.next_tick = self._edges[-1] if self._edges else FAR

    def stop(self) -> None:
        """Cut off the frame: TXD goes to 1."""

        self.next_tick = FAR
        self.level = 1
