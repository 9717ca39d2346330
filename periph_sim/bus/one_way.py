"""A line driven by one party only: the others see its levels, and drive another wire.

    player --> OneWayWire --> the chip's input
                   back <---- the chip's output

It shows what a chip would have done on a line that no longer reacts to it.
"""

from __future__ import annotations

from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.wire import Pin, Wire


class OneWayWire(Wire):
    """player: the driving party. back: the wire that all others drive; it is not recorded."""

    def __init__(self, kernel: Kernel, name: str, recorder: Recorder, player: str = "capture") -> None:
        super().__init__(kernel, name, recorder)
        self.player = player
        self.back = Wire(kernel, name, Recorder())

    def attach(self, who: str) -> Pin:
        """Attach a party: to the line for the player, to `back` for all others."""
        return super().attach(who) if who == self.player else self.back.attach(who)
