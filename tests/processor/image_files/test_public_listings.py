"""The assembler and the decoder agree with listings of TI's assembler. Skipped if there are no listings.

The assembler and the decoder share a table, so they cannot check each other. Every line with an encoding is compared in
both directions: the words decode to an instruction of its mnemonic and length, and the source assembles to the words.
TI's assembler accepts some names for forms that have other names in the manual.

    "     98 00000004 FE02          ADDB      SP,#2     ; comment"
    "     107 00000007 761F!         MOVW      DP,#_CpuSysRegs+128"     "!" and similar: the linker changes this word
    "         00000008 0002"                                            the second word

In a listing, constants of symbols that other files define are 0.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from periph_sim.processor.c28x.assembler import parse
from periph_sim.processor.c28x.decoder import decode_at
from tests.processor.image_files.public_images import VARIABLE

BEGINS = "TMS320C2000 Assembler"
WORD = re.compile(r" *(\d+)? +([0-9a-fA-F]{8}) ([0-9A-Fa-f]{4})(.) *([^;]*)")
LABEL = re.compile(r" *\d+ ([0-9a-f]{8})? +([\w$.]+):")
SETS = re.compile(r" *\d+ +([0-9a-f]{4,8}) +([\w$.]+)\s+\.(?:set|asg)\b")
DATA = ("_CLA", "$C$DW")  # names of tables, whose lines have words too


@dataclass
class Line:
    """A line of a listing with an instruction.

    bound: True if the linker changes one of its words.
    """

    address: int
    source: str
    words: list[int]
    bound: bool


class Symbols(dict[str, int]):
    """Symbols of a file; a symbol that another file defines is 0."""

    def __contains__(self, name: object) -> bool:
        return True

    def __missing__(self, name: str) -> int:
        return 0


def instructions(text: str) -> tuple[list[Line], Symbols]:
    """Return the instructions of a listing, without lines of data, and its symbols."""
    symbols, labels = Symbols(), list[str]()
    for printed in text.splitlines():
        label, sets, word = LABEL.match(printed), SETS.match(printed), WORD.match(printed)
        if label and label[1]:
            symbols[label[2]] = int(label[1], 16)
        elif label:
            labels.append(label[2])  # the next line with words has its address
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


REPOSITORY = "Furkanprlk/DSP_F28335_Examples"  # at 3b480c1: boot ROMs of the F2837x, compiled code and assembly
BOTH_NAMES = {"C28OBJ": "SETC OBJMODE", "C28ADDR": "CLRC AMODE", "C28MAP": "SETC M0M1MAP"}
STACK_MOVES = ("PUSH", "POP")
NOT_THIS_CHIP = re.compile(r"V(MOV32|CRC)|SETFLG .*RNDF64")  # instructions of the VCU and 64-bit FPU of the F2837x
NUMBER_AS_DISTANCE = "SB 0, UNC"  # a branch to itself
WITHOUT_SHIFT = re.compile(r"(MOV ACC, ?#\w+)$")


@cache
def listings() -> dict[str, str]:
    """Return the texts of the different listings, by path."""
    folder = os.environ.get(VARIABLE)
    root = Path(folder or "", REPOSITORY)
    if not folder or not root.is_dir():
        pytest.skip(f"{VARIABLE} names no folder with listings of {REPOSITORY}")
    found: dict[bytes, tuple[str, str]] = {}
    for path in sorted(root.rglob("*.lst")):
        data = path.read_bytes()
        if data.startswith(BEGINS.encode()):
            found.setdefault(hashlib.sha256(data).digest(), (str(path), data.decode("latin-1")))
    return dict(found.values())


@cache
def lines() -> list[tuple[Line, Symbols]]:
    """Return the different lines of all listings, each once."""
    found: dict[tuple[str, tuple[int, ...]], tuple[Line, Symbols]] = {}
    for text in listings().values():
        of_file, symbols = instructions(text)
        for line in of_file:
            found.setdefault((line.source, tuple(line.words)), (line, symbols))
    return [(line, symbols) for line, symbols in found.values() if not NOT_THIS_CHIP.match(line.source)]


def by_the_manual(line: Line) -> str:
    """Return the source with the manual's names of short branches, byte moves and the page of an address."""
    source = BOTH_NAMES.get(line.source, line.source.removeprefix("||")).partition(" ||")[0]
    if len(line.words) == 1:
        source = re.sub(r"^(BF?) ", lambda name: f"S{name[1]} ", source)
    if line.words[0] >> 9 == 0x9A >> 1:
        source = source.replace("MOV ", "MOVB ", 1)
    source = re.sub(r"^SUBB (A[LH]), ?#(.*)", r"ADDB \1,#-(\2)", source)
    source = re.sub(r"<< (?=\d)", "<< #", WITHOUT_SHIFT.sub(r"\1 << #0", source))
    return re.sub(r"^MOVW DP, ?#(.*)", r"MOVW DP,#(\1) >> 6", source) if line.bound else source


def test_words_of_each_line_decode_to_its_instruction():
    assert len(lines()) > 2500
    for line, _ in lines():
        source = by_the_manual(line)
        found = decode_at(line.address, line.words[0], line.words[-1])
        assert found is not None, line
        two = line.source.partition("||")[2] != "" and line.source.startswith(
            "RPT"
        )  # RPT and the instruction that it repeats
        assert found.words == len(line.words) - two, line
        mnemonic = source.split()[0].upper()
        assert found.encoding.mnemonic == mnemonic or (found.encoding.mnemonic == "MOVL" and mnemonic in STACK_MOVES), (
            line
        )


def test_the_source_of_each_line_assembles_to_its_words():
    differ = []
    for line, symbols in lines():
        words = parse(by_the_manual(line), line.address, symbols).words(line.address, symbols)
        printed = tuple(line.words[: len(words)])
        if words != printed and not (moves(words) and moves(words) == moves(printed)):
            differ.append(line.source)
    assert differ == [NUMBER_AS_DISTANCE]


def moves(words: tuple[int, ...]) -> str:
    """Return the text of a move between two registers, which has two encodings of one cycle; otherwise ""."""
    found = decode_at(0, words[0], words[-1])
    return found.text.replace("@", "") if found is not None and found.encoding.mnemonic in ("MOV", "MOVL") else ""
