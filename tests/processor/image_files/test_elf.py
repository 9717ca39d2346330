"""ELF of a C28x, field by field: which sections are the chip's, their load addresses, and which symbols are read."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import NamedTuple

import pytest

from periph_sim.processor.image_files import elf
from periph_sim.processor.image_files.model import BadImage, Image, Symbol

HEADER = struct.Struct("<16sHHIIIIIHHHHHH")
SECTION, SEGMENT, SYMBOL = struct.Struct("<IIIIIIIIII"), struct.Struct("<IIIIIIII"), struct.Struct("<IIIBBH")
PROGBITS, SYMTAB, STRTAB, NOTE, NOBITS = 1, 2, 3, 7, 8
WRITE, ALLOC, EXEC = 1, 2, 4
LOCAL, GLOBAL, WEAK = 0, 0x10, 0x20
NOTYPE, OBJECT, FUNC, OF_SECTION, OF_FILE = range(5)
UNDEFINED, ABSOLUTE = 0, 0xFFF1


Row = tuple[str, int, int, int]  # name, value, binding and type, section from 1


class Part(NamedTuple):
    """A section.

    size: in bytes; None is the size of its contents.
    """

    name: str
    kind: int
    flags: int
    address: int
    contents: bytes = b""
    size: int | None = None


class Load(NamedTuple):
    """A segment that contains sections from `first` to `last`.

    kind: 1 is PT_LOAD.
    """

    load: int
    first: str
    last: str
    kind: int = 1


def file_of(
    parts: list[Part], loads: list[Load], symbols: Sequence[Row] = (), *, machine: int = 141, kind: int = 2
) -> bytes:
    names = b"\0" + b"".join(name.encode() + b"\0" for name in (*(part.name for part in parts), ".symtab", ".strtab"))
    strings = b"\0" + b"".join(name.encode() + b"\0" for name, *_ in symbols)
    table = SYMBOL.pack(0, 0, 0, 0, 0, 0)
    for name, value, info, section in symbols:
        table += SYMBOL.pack(strings.index(name.encode() + b"\0") if name else 0, value, 0, info, 0, section)
    own = [*parts, Part(".symtab", SYMTAB, 0, 0, table), Part(".strtab", STRTAB, 0, 0, strings + names)]
    at = HEADER.size + SEGMENT.size * len(loads)
    body, rows, places = b"", SECTION.pack(*[0] * 10), {}
    for part in own:
        size = len(part.contents) if part.size is None else part.size
        places[part.name] = (at + len(body), at + len(body) + size, part.address)
        name = len(strings) + names.index(part.name.encode() + b"\0")
        link = (len(own), 1) if part.kind == SYMTAB else (0, 0)
        entry = SYMBOL.size if part.kind == SYMTAB else 0
        rows += SECTION.pack(name, part.kind, part.flags, part.address, at + len(body), size, *link, 2, entry)
        body += part.contents
    segments = b""
    for one in loads:
        begin, end = places[one.first][0], places[one.last][1]
        run = places[one.first][2]
        segments += SEGMENT.pack(one.kind, begin, run, one.load, end - begin, end - begin, 5, 2)
    head = HEADER.pack(
        b"\x7fELF\1\1\1".ljust(16, b"\0"), kind, machine, 1, 0x8001, HEADER.size,
        at + len(body), 0, HEADER.size, SEGMENT.size, len(loads), SECTION.size, len(own) + 1, len(own),
    )  # fmt: skip
    return head + segments + body + rows


TEXT = Part(".text", PROGBITS, ALLOC | EXEC, 0x8000, struct.pack("<3H", 0x7700, 0xFF, 6))
CONST = Part(".const", PROGBITS, ALLOC | WRITE, 0x9000, struct.pack("<2H", 1, 0xFFFF))
BSS = Part(".bss", NOBITS, ALLOC, 0x400, size=9)
BYTE = Part(".byte", NOBITS, ALLOC, 0x600, size=1)
EMPTY = Part(".empty", PROGBITS, ALLOC, 0x500)
DEBUG = Part(".debug_x", PROGBITS, 0, 0, b"abc")


def read(*parts: Part, loads: list[Load], symbols: Sequence[Row] = ()) -> Image:
    return elf.read(file_of([*parts], loads, symbols))


def test_sections_have_the_load_address_of_their_segment():
    """The second section is loaded directly after the first one; segments of another kind load nothing."""
    parts = (TEXT, CONST, BSS, BYTE, EMPTY, DEBUG, Part(".note", NOTE, 0, 0, b"d"), Part(".debug_y", NOTE, 0, 0, b"e"))
    found = read(*parts, loads=[Load(0x1000, ".text", ".const", kind=4), Load(0x320000, ".text", ".const")])
    assert (found.kind, found.entry, found.tool_version, found.initial) == ("ELF", 0x8001, 0, ())
    assert [
        (one.name, one.address, one.run, one.size, one.words, one.allocated, one.code) for one in found.sections
    ] == [
        (".text", 0x320000, 0x8000, 3, (0x7700, 0xFF, 6), True, True),
        (".const", 0x320003, 0x9000, 2, (1, 0xFFFF), True, False),
        (".bss", 0x400, 0x400, 5, (), True, False),
        (".byte", 0x600, 0x600, 1, (), True, False),
        (".empty", 0x500, 0x500, 0, (), False, False),
    ]
    assert found.debug == {".debug_x": b"abc"}


def test_each_section_may_have_a_segment_of_its_own():
    found = read(TEXT, CONST, loads=[Load(0x320000, ".text", ".text"), Load(0x330000, ".const", ".const")])
    assert [one.address for one in found.sections] == [0x320000, 0x330000]
    with pytest.raises(BadImage, match=r"^section '\.const' has contents that no segment loads$"):
        read(TEXT, CONST, loads=[Load(0x320000, ".text", ".text")])


def test_symbols_with_a_name_and_a_section_are_read():
    rows = [
        ("main", 0x8000, GLOBAL | FUNC, 1), ("helper", 0x8001, LOCAL | FUNC, 1), ("weak", 0x8002, WEAK | OBJECT, 2),
        ("$C$L1", 0x8002, LOCAL | NOTYPE, 1), ("$C$F", 0x8002, LOCAL | FUNC, 1), ("place", 0x8002, LOCAL | NOTYPE, 1),
        ("SIZE", 7, GLOBAL | NOTYPE, ABSOLUTE), ("elsewhere", 0, GLOBAL | FUNC, UNDEFINED), ("", 0x8000, LOCAL, 1),
        (".text", 0x8000, LOCAL | OF_SECTION, 1), ("main.c", 0, LOCAL | OF_FILE, ABSOLUTE),
    ]  # fmt: skip
    assert read(TEXT, CONST, loads=[Load(0x8000, ".text", ".const")], symbols=rows).symbols == (
        Symbol("main", 0x8000, ".text", external=True),
        Symbol("helper", 0x8001, ".text", external=False),
        Symbol("weak", 0x8002, ".const", external=False),
        Symbol("$C$L1", 0x8002, ".text", external=False, label=True),
        Symbol("$C$F", 0x8002, ".text", external=False),
        Symbol("place", 0x8002, ".text", external=False),
        Symbol("SIZE", 7, "", external=True),
    )


def test_contents_of_an_odd_number_of_bytes_are_refused():
    odd = TEXT._replace(contents=b"abc")
    with pytest.raises(BadImage, match=r"^section '\.text' has 3 bytes, which is not a whole number of words$"):
        read(odd, loads=[Load(0x8000, ".text", ".text")])


@pytest.mark.parametrize(("bits", "little"), [(64, True), (32, False)])
def test_another_class_or_byte_order_is_refused(monkeypatch: pytest.MonkeyPatch, bits: int, little: bool):
    class Other(dict[str, str]):
        elfclass, little_endian = bits, little

        def get_machine_arch(self) -> str:
            return "<unknown>"

    monkeypatch.setattr(elf, "ELFFile", lambda file: Other(e_machine="EM_TI_C2000", e_type="ET_EXEC"))
    with pytest.raises(BadImage) as error:
        elf.read(b"")
    assert str(error.value) == (
        "it is ELF for unknown; the F28335 runs ELF for TI C2000, 32 bits, little-endian; build it for that"
    )
