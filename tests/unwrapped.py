"""Text that was broken to fit 80 columns, as one line again: for tests of what it says, not of where it is broken."""

from __future__ import annotations


def unwrapped(text: str) -> str:
    """The words with single blanks between them."""
    return " ".join(text.split())
