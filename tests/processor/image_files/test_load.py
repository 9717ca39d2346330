"""A linker's output file is parsed to an image, or refused in one sentence."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.processor.image_files.coff2 import write
from periph_sim.processor.image_files.load import load, parse
from periph_sim.processor.image_files.model import BadImage, Section
from tests.processor.image_files.own_images import ENTRY, image, text
from tests.processor.image_files.test_elf import TEXT, Load, file_of

SECTION_AT = 22 + 28  # the first section header of a COFF file
GOOD = write(image())
PARTS = [TEXT], [Load(0x8000, ".text", ".text")]
ELF = file_of(*PARTS)


def changed(data: bytes, at: int, layout: str, value: int) -> bytes:
    return data[:at] + struct.pack(f"<{layout}", value) + data[at + struct.calcsize(f"<{layout}") :]


def refused(data: bytes) -> str:
    with pytest.raises(BadImage) as error:
        parse(data)
    return str(error.value)


def test_names_of_more_than_8_characters_are_read_without_symbols():
    """strip leaves such a file."""
    found = parse(write(image(text(), Section("a_long_name", 0x9000, 0x9000, 1, (1,)))))
    assert [one.name for one in found.sections] == [".text", "a_long_name"] and found.symbols == ()


def test_elf_is_recognized_by_its_first_bytes():
    assert [(one.name, one.code) for one in parse(ELF).sections] == [(".text", True)]


REFUSED = [
    (b"", "neither TI COFF nor ELF"),
    (b"#!/bin/sh\n", "neither TI COFF nor ELF"),
    (GOOD[:10], "truncated: its header"),
    (GOOD[:40], "truncated: its optional header"),
    (GOOD[: SECTION_AT + 50], "truncated: its section table"),
    (changed(GOOD, 0, "H", 0xC1), "COFF1 for C24x or an older target"),
    (changed(GOOD, 20, "H", 0x98), "COFF2 for TMS320C54x"),
    (changed(GOOD, 20, "H", 0x1234), "target 0x1234"),
    (changed(GOOD, 18, "H", 0x0101), "partly linked"),
    (changed(GOOD, 16, "H", 0), "optional header has 0 bytes"),
    (changed(GOOD, SECTION_AT + 32, "I", 4), "section '.text' has relocations"),
    (changed(GOOD, SECTION_AT + 16, "I", 0x10000), "truncated: section '.text' ends at byte"),
    (changed(GOOD, 8, "I", 1 << 31), "truncated: its symbol table"),
    (changed(GOOD, 22 + 16, "I", 0x9000), "entry 0x009000 is not in a loaded code"),
    (
        write(image(text(address=0x320000, run=ENTRY))),
        "entry 0x008000 is not in a loaded code",
    ),  # before the code is copied
    (write(image(text(), text(address=0x8008, name=".text.2"))), "sections '.text' and '.text.2' overlap at 0x008008"),
    (write(image(text(address=0x7900))), "'.text' lies at 0x007900, over peripheral registers (peripheral frame 2)"),
    (write(image(text(address=0xD00))), "over peripheral registers (PIE vectors)"),
    (write(image(text(address=0x3FE000))), "over ROM (boot ROM)"),
    (write(image(text(address=0x33FFF8))), "at 0x340000, where the F28335 has nothing"),
    (write(image(text(address=0x82000))), "at 0x082000, where the F28335 has nothing; an F2837x has its flash there"),
    (write(image(text(address=0x12000))), "at 0x012000, where the F28335 has nothing; an F2806x and an F2837x have"),
    (write(image(text(address=0x3E8000))), "at 0x3e8000, where the F28335 has nothing; an F281x, F280x, F2803x or F2"),
    (write(image(text(address=0x320000, run=0x7900), entry=0x320000)), "'.text' lies at 0x007900"),
    (write(image(Section("Cla1Prog", 0x9000, 0x9000, 1, (1,)))), "a part with a CLA"),
    (write(image(Section(".econst", 0x9000, 0x9000, 1, (1,)))), "not in a loaded code section"),
    (write(image(Section(".ebss", 0x9000, 0x9000, 1))), "it has no loaded section"),
    (file_of(*PARTS, machine=40), "ELF for ARM"),
    (file_of(*PARTS, kind=1), "object file"),
    (ELF[:-10], "ELF structure is damaged"),
]


@pytest.mark.parametrize(("data", "sentence"), REFUSED, ids=[sentence for _, sentence in REFUSED])
def test_refused_in_one_sentence(data: bytes, sentence: str):
    said = refused(data)
    assert sentence in said
    assert "\n" not in said and len(said) < 200


def test_a_damaged_name_is_quoted_and_shortened():
    data = write(image(text(name="\n\1\2" + "x" * 500)))
    said = refused(changed(data, SECTION_AT + 32, "I", 4))
    assert "has relocations" in said and said.isprintable() and len(said) < 200


def test_a_refusal_names_the_file(tmp_path: Path):
    file = tmp_path / "x.out"
    with pytest.raises(BadImage, match=r"x\.out: No such file"):
        load(file)
    file.write_bytes(b"MZ")
    with pytest.raises(BadImage, match=r"x\.out: it is neither"):
        load(file)


def parsed_or_refused(data: bytes) -> None:
    try:
        found = parse(data)
    except BadImage:
        return
    assert found.code


@given(st.binary(max_size=200))
def test_any_bytes_after_a_coff_header_are_parsed_or_refused(tail: bytes):
    parsed_or_refused(GOOD[:22] + tail)


@given(st.sampled_from((GOOD, ELF)), st.data())
def test_a_damaged_file_is_parsed_or_refused(data: bytes, draw: st.DataObject):
    places = draw.draw(st.lists(st.tuples(st.integers(0, len(data) - 1), st.integers(0, 255)), max_size=8))
    damaged = bytearray(data)
    for at, byte in places:
        damaged[at] = byte
    parsed_or_refused(bytes(damaged[: draw.draw(st.integers(len(data) // 2, len(data)))]))
