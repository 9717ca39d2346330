"""TI COFF2 [SPRAAO8]: every byte of a written file, and the flags, symbols and names of files that are read."""

from __future__ import annotations

import struct

import pytest

from periph_sim.processor.image_files import coff2
from periph_sim.processor.image_files.coff2 import write
from periph_sim.processor.image_files.load import parse
from periph_sim.processor.image_files.model import Image, Section, Symbol
from tests.processor.image_files.own_images import CODE, ENTRY, image, text
from tests.processor.image_files.test_load import GOOD, SECTION_AT, changed, refused

SYMBOL = struct.Struct("<8sIhHBB")
FLAGS_OF_SECOND = SECTION_AT + 48 + 40


def test_every_byte_of_a_written_file():
    """It has copied code, data with a long name, a stack, symbols of each kind and debug data."""
    sections = (
        Section(".text", 0x320000, 0x8000, 2, (0x7625, 0x7700), code=True),
        Section("long_name1", 0x9000, 0x9000, 1, (7,)),
        Section(".stack", 0x400, 0x400, 9),
    )
    symbols = (
        Symbol("_main", 0x8001, ".text"),
        Symbol("a_long_symbol", 0x9000, "long_name1", external=False),
        Symbol("here", 0x8001, ".text", external=False, label=True),
        Symbol("SIZE", 5, ""),
    )
    made = write(Image("TI COFF2", 0x320001, sections, symbols, debug={".debug_info": b"abc"}, tool_version=6))
    raw = 22 + 28 + 4 * 48
    header = struct.Struct("<8sIIIIIIIIIHH")
    none = (0, 0, 0, 0)
    assert made == b"".join(
        (
            struct.pack("<HHiIIHHH", 0xC2, 4, 0, raw + 9, 4, 28, 0x0103, 0x9D),
            struct.pack("<HHIIIIII", 0x0108, 6, 2, 0, 0, 0x320001, 0, 0),
            header.pack(b".text", 0x8000, 0x320000, 2, raw, *none, 0x20, 0, 0),
            header.pack(struct.pack("<II", 0, 4), 0x9000, 0x9000, 1, raw + 4, *none, 0x40, 0, 0),
            header.pack(b".stack", 0x400, 0x400, 9, 0, *none, 0x80, 0, 0),
            header.pack(struct.pack("<II", 0, 15), 0, 0, 3, raw + 6, *none, 0x10, 0, 0),
            struct.pack("<3H", 0x7625, 0x7700, 7) + b"abc",
            SYMBOL.pack(b"_main", 0x8001, 1, 0, 2, 0),
            SYMBOL.pack(struct.pack("<II", 0, 27), 0x9000, 2, 0, 3, 0),
            SYMBOL.pack(b"here", 0x8001, 1, 0, 6, 0),
            SYMBOL.pack(b"SIZE", 5, -1, 0, 2, 0),
            struct.pack("<I", 41) + b"long_name1\0.debug_info\0a_long_symbol\0",
        )
    )
    found = parse(made)
    assert [(one.name, one.address, one.run, one.size, one.code) for one in found.sections] == [
        (".text", 0x320000, 0x8000, 2, True), ("long_name1", 0x9000, 0x9000, 1, False),
        (".stack", 0x400, 0x400, 9, False), (".debug_info", 0, 0, 3, False),
    ]  # fmt: skip
    assert (found.symbols, found.debug, found.tool_version) == (symbols, {".debug_info": b"abc"}, 6)


Row = tuple[bytes, int, int, int, int]  # name, value, section, class, auxiliary entries


def with_symbols(*rows: Row, strings: bytes = b"") -> bytes:
    """Return a file that has only .text and these symbols; their auxiliary entries are zeros."""
    entries = [
        SYMBOL.pack(name, at, section, 0, kind, more) + bytes(18 * more) for name, at, section, kind, more in rows
    ]
    count = sum(1 + row[4] for row in rows)
    data = changed(write(image(text())), 12, "I", count)
    return data[:-4] + b"".join(entries) + struct.pack("<I", 4 + len(strings)) + strings


def test_symbols_of_addresses_are_read():
    """Symbols of the classes external, static and label are read; those of sections and objects are not."""
    rows = (
        (b"a", 0x8000, 1, 2, 1), (b"b", 0x8001, 1, 3, 0), (b"c", 0x8002, 1, 6, 2), (b"number", 1, -1, 2, 0),
        (b"d", 1, 0, 2, 0), (b"e", 1, -2, 2, 0), (b"f", 1, 2, 2, 0), (b".file", 1, 1, 103, 1), (b"g", 1, 1, 4, 0),
        (b".text", 0x8000, 1, 3, 1), (b".text:a", 0x8000, 1, 3, 0), (b".textual", 0x8000, 1, 3, 0),
        (struct.pack("<II", 0, 4), 0x8003, 1, 2, 0), (b"8letters", 0x8000, 1, 2, 0),
    )  # fmt: skip
    found = parse(with_symbols(*rows, strings=b"a_long_name\0")).symbols
    assert [(one.name, one.section, one.external, one.label) for one in found] == [
        ("a", ".text", True, False),
        ("b", ".text", False, False),
        ("c", ".text", False, True),
        ("number", "", True, False),
        (".textual", ".text", False, False),
        ("a_long_name", ".text", True, False),
        ("8letters", ".text", True, False),
    ]


@pytest.mark.parametrize(("place", "strings"), [(3, b"abc\0"), (9, b"abc\0"), (4, b"abc")])
def test_a_name_that_exceeds_the_string_table_is_refused(place: int, strings: bytes):
    said = refused(with_symbols((struct.pack("<II", 0, place), 0x8000, 1, 2, 0), strings=strings))
    assert said == f"it is truncated: a name is at byte {place} of its string table of {4 + len(strings)}"


def test_a_file_may_end_with_its_last_section():
    """strip leaves such a file, without symbols and without a string table."""
    data = write(image(text()))[:-4]
    assert parse(data).sections[0].words == CODE
    assert refused(data[:-1]) == (
        f"it is truncated: section '.text' ends at byte {len(data)}, and the file has {len(data) - 1}; fetch it again"
    )
    assert refused(GOOD[:21]) == "it is truncated: its header needs byte 21, the file has 21 bytes"


def test_coff_files_are_recognized_by_their_first_two_bytes():
    assert [coff2.is_coff(data) for data in (b"", b"\xc2", b"\xbf\0", b"\xc0\0", b"\xc1\0", b"\xc2\0", b"\xc3\0")] == [
        False, False, False, True, True, True, False
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("version", "target", "named"),
    [
        (0xC2, 0x92, "COFF2 for TMS320C1x, C2x, C2xx or C5x"), (0xC2, 0x97, "COFF2 for TMS470"),
        (0xC2, 0x98, "COFF2 for TMS320C54x"), (0xC2, 0x99, "COFF2 for TMS320C6000"),
        (0xC2, 0x9C, "COFF2 for TMS320C55x"), (0xC2, 0xA0, "COFF2 for MSP430"), (0xC2, 0xA1, "COFF2 for TMS320C55x+"),
        (0xC2, 0x77, "COFF2 for target 0x0077"), (0xC0, 0x98, "COFF0 for C24x or an older target"),
        (0xC1, 0x9D, "COFF1 for C24x or an older target"),
    ],
)  # fmt: skip
def test_a_file_for_another_target_is_named(version: int, target: int, named: str):
    data = changed(changed(GOOD, 0, "H", version), 20, "H", target)
    assert refused(data) == f"it is {named}; the F28335 runs COFF2 for C28x; build it for that"


@pytest.mark.parametrize(
    ("flags", "loaded", "allocated", "code"),
    [
        (0x00, True, True, False), (0x20, True, True, True), (0x40, True, True, False), (0x120, True, True, True),
        (0x80, False, True, False), (0x01, False, False, False), (0x02, False, False, False),
        (0x10, False, False, False), (0x50, False, False, False), (0x30, False, False, True), (0x60, True, True, True),
    ],
)  # fmt: skip
def test_section_flags(flags: int, loaded: bool, allocated: bool, code: bool):
    (_, section, _) = coff2.read(changed(GOOD, FLAGS_OF_SECOND, "I", flags)).sections
    assert (section.loaded, section.allocated, section.code) == (loaded, allocated, code)


def cinit(*words: int, flags: int = 0x50) -> bytes:
    data = write(image(text(), Section(".cinit", 0x9000, 0x9000, len(words), words)))
    return changed(data, FLAGS_OF_SECOND, "I", flags)


def test_cinit_is_applied_only_as_a_copy_of_data():
    assert [coff2.read(cinit(1, 0x9100, 7, flags=flags)).initial for flags in (0, 0x10, 0x20, 0x30, 0x40)] == [()] * 5
    assert coff2.read(cinit(1, 0x9100, 7, 0, 5)).initial == ((0x9100, (7,)),)  # a 0 ends the list
    assert coff2.read(cinit()).initial == ()


def test_records_of_cinit_may_name_22_bits_of_address_and_end_with_their_section():
    """A record is n words after a 16-bit address, or -n words after a 32-bit one, low word first; 0x8000 is -32768."""
    assert coff2.read(cinit(0xFFFE, 0x9200, 0x31, 5, 6, 1, 0x9100, 7)).initial == ((0x319200, (5, 6)), (0x9100, (7,)))
    for words in ((2, 0x9100, 7), (0xFFFF, 0x9200, 0x31), (0x8000, 0, 0, 1), (0x7FFF, 0, 1)):
        assert refused(cinit(*words)) == "it is truncated: a record of .cinit ends after its section"
    assert refused(cinit(1, 0x7900, 7)) == (
        ".cinit initialises 1 words at 0x007900, over peripheral registers (peripheral frame 2)"
    )


def test_debug_sections_are_copies_with_contents_whose_size_counts_bytes():
    data = write(Image("TI COFF2", ENTRY, (text(),), debug={".debug_x": b"abc", "debug": b"de"}))
    assert coff2.read(data).debug == {".debug_x": b"abc"}
    assert coff2.read(changed(data, FLAGS_OF_SECOND, "I", 0x20)).debug == {}
    assert coff2.read(changed(data, SECTION_AT + 48 + 20, "I", 0)).debug == {}
    assert coff2.read(changed(data, FLAGS_OF_SECOND, "I", 0x30)).debug == {".debug_x": b"abcde\4"}  # of text: words


def test_adjacent_sections_do_not_overlap_and_the_entry_is_within_one():
    more = text(address=ENTRY + len(CODE), name=".more")
    found = parse(write(image(text(), more, entry=ENTRY + 2 * len(CODE) - 1)))
    assert [one.name for one in found.sections] == [".text", ".more"]
    assert "not in a loaded code" in refused(write(image(text(), entry=ENTRY + len(CODE))))
    assert (
        parse(write(image(text(), Section("Cla1Prog", 0x9000, 0x9000, 0)))).entry == ENTRY
    )  # a section without contents


def test_symbols_stack_and_run_addresses_of_an_image():
    stack = [Section(".stack", 0x400, 0x500, size) for size in (14, 15)]
    far = text(address=0x320000, run=0x9000, name="far")
    symbols = (
        Symbol("z", 0x8000, ".text"),
        Symbol("a", 0x8000, ".text", external=False),
        Symbol("L", 0x8000, ".text", label=True),
        Symbol("y", 0x8000, ".text"),
        Symbol("b", 0x8001, ".text", external=False),
        Symbol("M", 0x8001, ".text", label=True),
        Symbol("N", 0x8002, ".text", label=True),
        Symbol("SIZE", 0x8003, ""),
    )
    found = Image("own", ENTRY, (text(), far, *stack), symbols)
    assert found.symbol_at == {0x8000: "y", 0x8001: "b", 0x8002: "N"}
    assert (found.stack, Image("own", ENTRY, (text(), stack[0])).stack) == ((0x500, 0x50F), (0, 0xFFFF))
    assert (far.end, far.copied, text().copied) == (0x320000 + len(CODE), True, False)
    places = (0x8FFF, 0x9000, 0x9000 + len(CODE) - 1, 0x9000 + len(CODE), 0x320000)
    assert [far.runs_at(at) for at in places] == [False, True, True, False, False]
