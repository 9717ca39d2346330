"""Numbers in text as exact fractions. Numbers that would take long to compute are rejected."""

from __future__ import annotations

import re
from fractions import Fraction

from .phrases import shorten

MAX_DIGITS = 40  # maximum number of digits, enough for a femtosecond in a million years
MAX_EXPONENT = 40
_EXPONENT = re.compile(r"[eE]([-+]?[0-9_]+)$")
SHOWN = 60  # maximum number of characters that a message quotes


def exact_number(text: str) -> Fraction:
    """Return the value of "1.5", "1/3" or "2e-6", exactly.

    Raise ValueError, with a phrase that quotes the text, if it is not a number, or if it has more than 40 digits or an
    exponent beyond 40: the fraction of "1e999999999" alone would take minutes to compute.
    """
    quoted = shorten(repr(text), SHOWN)
    written = text.strip()
    exponent = _EXPONENT.search(written)
    digits = "" if exponent is None else exponent[1].lstrip("+-").replace("_", "").lstrip("0")
    if len(digits) > 2 or int(digits or "0") > MAX_EXPONENT:
        raise ValueError(f"{quoted} has an exponent beyond {MAX_EXPONENT}")
    if sum(map(str.isdigit, written)) > MAX_DIGITS:
        raise ValueError(f"{quoted} has more than {MAX_DIGITS} digits")
    try:
        return Fraction(written)
    except (ValueError, ZeroDivisionError):
        raise ValueError(f"{quoted} is not a number") from None
