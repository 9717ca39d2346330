"""A line driven by one party only: the others see its levels, and drive another wire.

    player --> OneWayWire --> the chip's input
                   back <---- the chip's output

It shows the outputs of a chip for a line that does not react to them.
"""

from __future__ import annotations

from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.wire import Pin, Wire


class OneWayWire(Wire):
    """A wire for two directions. player: the name of the driving party.

    back: the wire that all other parties drive; its edges are not recorded.
    """

    def __init__(self, kernel: Kernel, name: str, recorder: Recorder, player: str = "capture") -> None:
        super().__init__(kernel, name, recorder)
        self.player = player
        self.back = Wire(kernel, name, Recorder())

    def attach(self, who: str) -> Pin:
        """Attach a party and return its pin: on this wire for the player, on `back` for all others."""
        return super().attach(who) if who == self.player else self.back.attach(who)
