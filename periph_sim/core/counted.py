"""A number of things as text: the number and the thing go in; "1 reset", "2 resets" comes out."""

from __future__ import annotations


def counted(number: int, thing: str) -> str:
    """thing: in the singular; of several words its plural goes on the last one."""
    return f"{number} {thing}{'' if number == 1 else 's'}"
