"""Phrases for messages: suggestions for misspelled names, counts such as "2 resets", and shortened text.

Files and options may contain text of any length. Of a long text, messages quote only the beginning and the end.
"""

from __future__ import annotations

from collections.abc import Iterable

LONGEST = 60  # maximum number of characters of a name that are compared and shown


def nearest(name: str, known: Iterable[str], least: float = 0.6) -> list[str]:
    """Return up to three of the known names that resemble `name`, best first.

    least: the minimum similarity, from 0 to 1, as in `difflib.get_close_matches`.
    """
    from difflib import get_close_matches  # imported here, because only errors need it

    folded = {k.casefold(): k for k in reversed(list(known))}
    return [folded[k] for k in get_close_matches(name[:LONGEST].casefold(), list(folded), 3, least)]


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a phrase with the nearest known names, with the first twelve if none is near, or "it has none"."""
    names = [shorten(str(k), LONGEST) for k in known]
    close = nearest(name, names)
    if close:
        return f"did you mean {' or '.join(close)}?"
    shown = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
    return f"it has {shown}" if names else "it has none"


def counted(number: int, thing: str) -> str:
    """Return a count as text. thing: the noun in the singular; the plural is formed from its last word."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def addressed(address: int, read: bool) -> str:
    """Return an address on an I2C bus and the direction as text: "0x68 R", "0x68 W"."""
    return f"0x{address:02X} {'R' if read else 'W'}"


MAX_LENGTH = 300  # maximum number of characters that a message quotes


def shorten(text: str, most: int = MAX_LENGTH) -> str:
    """Return the text if it has up to `most` characters; otherwise its two ends and its length."""
    if len(text) <= most:
        return text
    kept = max(0, most - 28)  # 28 characters are reserved for " ... " and the length
    head = kept - kept // 4
    return f"{text[:head]} ... {text[len(text) - kept // 4 :]} ({len(text)} characters)"


def one_line(text: str) -> str:
    """Return the text with unprintable characters, such as newlines, replaced by escape sequences."""
    return text if text.isprintable() else "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)
