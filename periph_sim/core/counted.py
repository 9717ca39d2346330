"""Counts as text, such as "1 reset" and "2 resets"."""

from __future__ import annotations


def counted(number: int, thing: str) -> str:
    """Return a count as text. thing: the noun in the singular; the plural is formed from its last word."""
    return f"{number} {thing}{'' if number == 1 else 's'}"
