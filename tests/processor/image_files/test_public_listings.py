"""Listings of TI's assembler judge ours and the decoder, which share a table. Skipped where they are not there.

Every line with an encoding is compared both ways: the words decode to an instruction of its mnemonic and length, and
the source assembles to the words. TI's assembler takes some names for forms that the manual names otherwise.
"""

from __future__ import annotations

import hashlib
import os
import re
from functools import cache
from pathlib import Path

import pytest

from periph_sim.processor.c28x.assembler import parse
from periph_sim.processor.c28x.decoder import decode_at
from tests.processor.image_files.public_images import VARIABLE
from tests.processor.image_files.public_listings import BEGINS, Line, Symbols, instructions

REPOSITORY = "Furkanprlk/DSP_F28335_Examples"  # at 3b480c1: boot ROMs of the F2837x, compiled code and assembly
BOTH_NAMES = {"C28OBJ": "SETC OBJMODE", "C28ADDR": "CLRC AMODE", "C28MAP": "SETC M0M1MAP"}
STACK_MOVES = ("PUSH", "POP")
NOT_THIS_CHIP = re.compile(r"V(MOV32|CRC)|SETFLG .*RNDF64")  # VCU and 64-bit FPU of the F2837x
NUMBER_AS_DISTANCE = "SB 0, UNC"  # to itself
WITHOUT_SHIFT = re.compile(r"(MOV ACC, ?#\w+)$")


@cache
def listings() -> dict[str, str]:
    """Text of each different listing by its path."""
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
    """Each different line once."""
    found: dict[tuple[str, tuple[int, ...]], tuple[Line, Symbols]] = {}
    for text in listings().values():
        of_file, symbols = instructions(text)
        for line in of_file:
            found.setdefault((line.source, tuple(line.words)), (line, symbols))
    return [(line, symbols) for line, symbols in found.values() if not NOT_THIS_CHIP.match(line.source)]


def by_the_manual(line: Line) -> str:
    """The source with the manual's names: short branches, moves of a byte, a page of an address."""
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
        two = line.source.partition("||")[2] != "" and line.source.startswith("RPT")  # RPT, and what it repeats
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
    """A move between two registers, which each of them may be the operand of: either form takes a cycle."""
    found = decode_at(0, words[0], words[-1])
    return found.text.replace("@", "") if found is not None and found.encoding.mnemonic in ("MOV", "MOVL") else ""
