"""Lines of the assembler's listings: a .lst file of TI's tools goes in; address, words, source and symbols come out.

    "     98 00000004 FE02          ADDB      SP,#2     ; comment"
    "     107 00000007 761F!         MOVW      DP,#_CpuSysRegs+128"     "!" and the like: the linker changes this word
    "         00000008 0002"                                            the second word

Constants of symbols that other files define are 0 there.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

BEGINS = "TMS320C2000 Assembler"
WORD = re.compile(r" *(\d+)? +([0-9a-fA-F]{8}) ([0-9A-Fa-f]{4})(.) *([^;]*)")
LABEL = re.compile(r" *\d+ ([0-9a-f]{8})? +([\w$.]+):")
SETS = re.compile(r" *\d+ +([0-9a-f]{4,8}) +([\w$.]+)\s+\.(?:set|asg)\b")
DATA = ("_CLA", "$C$DW")  # names of tables, whose lines have words, too


@dataclass
class Line:
    """bound: the linker changes one of its words."""

    address: int
    source: str
    words: list[int]
    bound: bool


class Symbols(dict[str, int]):
    """0 for what another file defines."""

    def __contains__(self, name: object) -> bool:
        return True

    def __missing__(self, name: str) -> int:
        return 0


def instructions(text: str) -> tuple[list[Line], Symbols]:
    """The instructions of a listing, without lines of data."""
    symbols, labels = Symbols(), list[str]()
    for printed in text.splitlines():
        label, sets, word = LABEL.match(printed), SETS.match(printed), WORD.match(printed)
        if label and label[1]:
            symbols[label[2]] = int(label[1], 16)
        elif label:
            labels.append(label[2])  # what follows says where it is
        elif sets:
            symbols[sets[2]] = int(sets[1], 16)
        elif word:
            symbols |= dict.fromkeys(labels, int(word[2], 16))
            labels.clear()
    return [line for line in _lines(text) if line.source and not line.source.startswith((".", *DATA))], symbols


def _lines(text: str) -> Iterator[Line]:
    line = None
    for printed in text.splitlines():
        found = WORD.match(printed)
        if not found:
            continue
        address, word = int(found[2], 16), int(found[3], 16)
        if found[1]:
            if line is not None:
                yield line
            line = Line(address, " ".join(found[5].split()), [word], found[4] != " ")
        elif line is not None and address == line.address + len(line.words):
            line.words.append(word)
            line.bound |= found[4] != " "
    if line is not None:
        yield line
