"""A line on which only one party is heard: its levels are what all others see, and what those drive goes elsewhere.

    player --> OneWayWire --> the chip's input
                   back <---- the chip's output

For looking at what a chip would have done on a line that no longer listens.
"""

from __future__ import annotations

from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.wire import Pin, Wire


class OneWayWire(Wire):
    """player: who is heard. back: the wire that everybody else drives; it is not recorded."""

    def __init__(self, kernel: Kernel, name: str, recorder: Recorder, player: str = "capture") -> None:
        super().__init__(kernel, name, recorder)
        self.player = player
        self.back = Wire(kernel, name, Recorder())

    def attach(self, who: str) -> Pin:
        """A hold on the line for the player, on `back` for everybody else."""
        return super().attach(who) if who == self.player else self.back.attach(who)
