"""Remove the line breaks of text wrapped at 80 columns, for tests of its words and not of the places of its breaks."""

from __future__ import annotations


def unwrapped(text: str) -> str:
    """Return the words separated by single blanks."""
    return " ".join(text.split())
