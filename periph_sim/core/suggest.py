"""Suggestions for misspelled names in messages."""

from __future__ import annotations

from collections.abc import Iterable

from .shorten import shorten

LONGEST = 60  # maximum number of characters of a name that are compared and shown


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a phrase with the nearest known names, or with the first twelve if none is near."""
    from difflib import get_close_matches  # imported here, because only errors need it

    names = [shorten(str(k), LONGEST) for k in known]
    folded = {k.casefold(): k for k in reversed(names)}
    close = [folded[k] for k in get_close_matches(name[:LONGEST].casefold(), list(folded), 3, 0.6)]
    if close:
        return f"did you mean {' or '.join(close)}?"
    shown = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
    return f"it has {shown}" if names else "it has none"
