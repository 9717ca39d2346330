"""Shortening of text for messages.

Files and options may contain text of any length, so messages quote only its two ends.
"""

from __future__ import annotations

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
