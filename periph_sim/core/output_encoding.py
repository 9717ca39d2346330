"""Output in encodings that lack some of the characters that commands print, such as Windows' cp1252 in a pipe.

A line under the titles of a table, in cp1252:  ─────  -->  -----
"""

from __future__ import annotations

import codecs
import sys
from io import TextIOWrapper

HANDLER = "periph_sim.substitute"
SUBSTITUTES = {"─": "-", "┌": "+", "┐": "+", "└": "+", "┘": "+", "░": ":", "█": "#", "·": ".", "µ": "u", "\u00a0": " "}


def _substitute(error: UnicodeError) -> tuple[str, int]:
    """Replace each character that the encoding lacks by one character of ASCII, so that columns stay aligned."""
    assert isinstance(error, UnicodeEncodeError)
    lacking = error.object[error.start : error.end]
    return "".join(SUBSTITUTES.get(character, "?") for character in lacking), error.end


def writes_utf8() -> bool:
    """Return True if standard output is encoded as UTF-8, or if it is not a text file and so has no encoding."""
    return not isinstance(sys.stdout, TextIOWrapper) or sys.stdout.encoding.lower() in ("utf-8", "utf8")


def substitute_unencodable() -> None:
    """Let standard output print substitutes for the characters that its encoding lacks. Call before any output."""
    if not writes_utf8() and isinstance(sys.stdout, TextIOWrapper) and not sys.stdout.closed:
        codecs.register_error(HANDLER, _substitute)
        sys.stdout.reconfigure(errors=HANDLER)
