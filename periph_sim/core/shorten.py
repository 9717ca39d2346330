"""Text that may be of any length, for a message: text goes in, the same or its two ends come out.

What a file or an option holds can be hostile: a message quotes it and never repeats it at length.
"""

from __future__ import annotations

MOST = 300  # characters


def shorten(text: str, most: int = MOST) -> str:
    """The text itself up to `most` characters; of a longer one both ends and its length."""
    if len(text) <= most:
        return text
    kept = max(0, most - 28)  # the rest says how long it was
    head = kept - kept // 4
    return f"{text[:head]} ... {text[len(text) - kept // 4 :]} ({len(text)} characters)"


def one_line(text: str) -> str:
    """Return the text with each character that is not printable, such as a newline, as its escape."""
    return text if text.isprintable() else "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)
