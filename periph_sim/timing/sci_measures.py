"""Measures of the SCI's receive FIFO: words that wait and characters that are lost."""

from __future__ import annotations

from .measures import Counter, Happenings, Measure


class FifoHighWater(Measure):
    """Most words that ever waited in the SCI receive FIFO."""

    needs = "SCI-A"
    unit = "words"

    def listen(self, scene: Happenings) -> None:
        scene.listen_sci(self._sci)

    def _sci(self, tick: int, words: int, overrun: bool) -> None:
        self.take(words, tick)


class Overruns(Counter):
    """Characters lost in the SCI: FIFO overflow (RXFFOVF) or SCIRXBUF overrun (OE), counted as they happen."""

    needs = "SCI-A"

    def listen(self, scene: Happenings) -> None:
        scene.listen_sci(self._sci)

    def _sci(self, tick: int, words: int, overrun: bool) -> None:
        if overrun:
            self.one_more(tick)
