"""Numbers in text as exact fractions, and their units. Numbers that would take long to compute are rejected.

Times are also formatted as text, in a suitable unit.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from fractions import Fraction

from .phrases import shorten

MAX_DIGITS = 40  # maximum number of digits, enough for a femtosecond in a million years
MAX_EXPONENT = 40
_NUMBER = re.compile(r"[-+]?[\d._,/]+([eE][-+]?\d+)?")
_EXPONENT = re.compile(r"[eE]([-+]?[0-9_]+)$")
_SPLIT_UNIT = re.compile(r"([-+]?\d*\.?\d+)([A-Za-z])")  # a number and the first letter of its unit, as in "20m s"
_LETTERS = str.maketrans("OoIl", "0011")  # letters that are typed in place of digits
SHOWN = 60  # maximum number of characters of a number or unit that a message quotes


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
        meant = written.replace(",", ".").translate(_LETTERS)
        hint = f"write {meant}" if re.fullmatch(r"[-+]?\d+(\.\d+)?", meant) else "write for instance 20"
        raise ValueError(f"{quoted} is not a number; {hint}") from None


def number_and_unit(text: str) -> tuple[str, str]:
    """Return the number and the unit of "20 ms" or "20ms" as unchecked texts. A missing number or unit is ""."""
    number, _, unit = text.strip().partition(" ")
    if not unit:
        found = _NUMBER.match(number)
        cut = 0 if found is None else found.end()
        return number[:cut], number[cut:]
    split = _SPLIT_UNIT.fullmatch(number)
    if split and split[2] not in "OoIl":
        return split[1], f"{split[2]} {unit.strip()}"
    return number, unit.strip()


def unknown_unit(number: str, unit: str, known: Iterable[str]) -> str:
    """Return a phrase about an unknown unit of a number, with the known units and, if one is similar, this unit."""
    from difflib import get_close_matches  # imported here, because only errors need it

    shown = shorten(repr(unit), SHOWN)
    if unit[0].isdecimal():
        number, unit = number_and_unit(f"{number}{unit}")  # the number contains a space: "1 000 ms"
    folded = {one.casefold(): one for one in known}
    written = unit.replace(" ", "").casefold()
    alike = [one for one in folded if sorted(one) == sorted(written)] or get_close_matches(written, folded, 1, 0.5)
    hint = f"; did you mean {number} {folded[alike[0]]}?" if alike and {*alike[0]} & {*written[:1]} else ""
    return f"unit {shown} is none of {', '.join(folded.values())}{hint}"


def short_time(ns: Fraction) -> str:
    """Format a time, given in nanoseconds, in a suitable unit with at most three decimals."""
    for unit, size in (("ns", 1), ("us", 10**3), ("ms", 10**6)):
        if abs(ns) < 1000 * size:
            return f"{trimmed(ns / size)} {unit}"
    return f"{trimmed(ns / 10**9)} s"


def trimmed(value: Fraction) -> str:
    """Format a number with at most three decimals, without trailing zeros after the decimal point."""
    return f"{float(value):.3f}".rstrip("0").rstrip(".")
