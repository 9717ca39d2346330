"""A queue of fixed depth that says when it had no room."""

# core: compiled

from __future__ import annotations

from typing import final

from .state import State


@final
class Fifo:
    """depth: how many words fit. `words` holds them, oldest first."""

    STATE = State("words depth", made=True)

    def __init__(self, depth: int) -> None:
        self.depth = depth
        self.words: list[int] = []

    def __len__(self) -> int:
        return len(self.words)

    def push(self, word: int) -> bool:
        """True if the word was taken; False if the queue was full and nothing changed."""
        if len(self.words) == self.depth:
            return False
        self.words.append(word)
        return True

    def pop(self) -> int:
        """The oldest word, taken out. IndexError when empty: ask `len` first."""
        return self.words.pop(0)

    def clear(self) -> None:
        self.words.clear()
