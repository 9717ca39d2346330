"""Queue of fixed depth."""

# core: compiled

from __future__ import annotations

from typing import final

from .state import State


@final
class Fifo:
    """depth: maximum number of words. words: oldest first."""

    STATE = State("words depth", made=True)

    def __init__(self, depth: int) -> None:
        self.depth = depth
        self.words: list[int] = []

    def __len__(self) -> int:
        return len(self.words)

    def push(self, word: int) -> bool:
        """Append a word and return True. Return False, with nothing changed, if the queue is full."""
        if len(self.words) == self.depth:
            return False
        self.words.append(word)
        return True

    def pop(self) -> int:
        """Remove and return the oldest word. IndexError if the queue is empty."""
        return self.words.pop(0)

    def clear(self) -> None:
        self.words.clear()
