"""Instructions that copy, add, subtract or compare, as the column `op` of `encodings.toml` states it.

"ACC += uimm8"       ->  ACC = ACC + uimm8
"ARn -= 1; if ..."   ->  ARn = ARn - 1
"XARn = u(loc)"      ->  XARn = loc
"flags of AX - loc"  ->  AX - loc, for its flags alone
"""

from __future__ import annotations

import re
from functools import cache
from typing import NamedTuple

from .encodings import Encoding

PLACE = "ACC|AX|ARn|ARm|XARn|XAR[0-7]|loc"
NUMBER = r"simm\d+|uimm\d+|0|1"
COPY = re.compile(rf"({PLACE}) = (?:u\()?({PLACE})\)?")
ADDITION = re.compile(rf"({PLACE}) ([+-])= (?:u\()?({PLACE}|{NUMBER})\)?(?:; if it was not 0: PC = PC \+ simm16)?")
COMPARISON = re.compile(
    rf"flags of ({PLACE})(?: - ({PLACE}|{NUMBER}))?|if ({PLACE}) [=!]= ({PLACE}): PC = PC \+ simm16"
)


class Sum(NamedTuple):
    """result = left + sign * right.

    result: a place, or "" if only the flags are written. right: a place or a number. sign: 1, -1, or 0 for a copy.
    """

    result: str
    left: str
    sign: int
    right: str

    def number(self, c: int) -> int | None:
        """Return the right side if it is a number, in 16 bits if it is signed; None for a place. c: field c."""
        if self.right.isdigit():
            return int(self.right)
        kind, immediate, bits = self.right.partition("imm")
        if not immediate:
            return None
        half = 1 << int(bits) - 1
        return (c ^ half) - half & 0xFFFF if kind == "s" else c


@cache
def sum_of(encoding: Encoding) -> Sum | None:
    """Return what a form computes; None if it is more than one sum, copy or comparison."""
    op = encoding.op
    if found := COPY.fullmatch(op):
        return Sum(found[1], found[2], 0, "")
    if found := ADDITION.fullmatch(op):
        return Sum(found[1], found[1], -1 if found[2] == "-" else 1, found[3])
    if found := COMPARISON.fullmatch(op):
        return Sum("", found[1] or found[3], -1, found[2] or found[4] or "0")
    return None
