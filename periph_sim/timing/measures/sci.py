"""Measures of an SCI's receiver: words that wait and characters that are lost.

Their occasions are the characters on RX, whoever sent them; one that is not received is not measured.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...bus.receiver_listener import ReceiverListener
from .measure import Counter, Measure, SceneEvents


class OfCharacters(Measure):
    """A measure of an SCI that receives."""

    needs = "SCI"
    asked = "characters on RX"
    only_losses = False  # no other change concerns it

    def __init__(self) -> None:
        super().__init__()
        self._received = 0

    @property
    def measured(self) -> int:
        return self._received

    def listen(self, scene: SceneEvents) -> None:
        scene.on_sci(_ReceiverForwarder(self, self.only_losses))
        scene.on_character(self._on_wire)

    def _on_wire(self, begun: int) -> None:
        self.occasion(begun)

    def received(self, tick: int) -> None:
        """A character was received."""
        if tick >= self.not_before:
            self._received += 1

    def changed(self, tick: int, words: int, overrun: bool) -> None:
        """So many words wait now. overrun: something has just been lost."""


@final
class _ReceiverForwarder(ReceiverListener):
    """Forwards a receiver's events to a measure."""

    def __init__(self, measure: OfCharacters, only_losses: bool) -> None:
        self._measure = measure
        self._only_losses = only_losses

    def changed(self, tick: int, words: int, overrun: bool) -> None:
        if overrun or not self._only_losses:
            self._measure.changed(tick, words, overrun)

    def received(self, tick: int) -> None:
        self._measure.received(tick)


class FifoHighWater(OfCharacters):
    """Most words that ever waited in the SCI receive FIFO."""

    unit = "words"

    def changed(self, tick: int, words: int, overrun: bool) -> None:
        self.take(words, tick)


class Overruns(OfCharacters, Counter):
    """Characters lost in the SCI: FIFO overflow (RXFFOVF) or SCIRXBUF overrun (OE), counted as they happen."""

    only_losses = True

    def changed(self, tick: int, words: int, overrun: bool) -> None:
        if overrun:
            self.one_more(tick)
