"""Who listens to an SCI's receiver: words that wait in it, characters lost and received, as they change."""

# core: compiled

from __future__ import annotations


class ReceiverListener:
    """Who has no use for one of these leaves it out."""

    __slots__ = ()

    def changed(self, tick: int, words: int, overrun: bool) -> None:
        """So many words wait in the receive FIFO now. overrun: something has just been lost."""

    def received(self, tick: int) -> None:
        """A character was received, lost or not."""
