"""Lines that the assembler tells: rows go in, and pyelftools, which reads debug data for us, tells the same rows."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from periph_sim.processor.image_files.assemble import assemble
from periph_sim.processor.image_files.debug_info import DebugInfo
from periph_sim.processor.image_files.model import Image
from periph_sim.processor.image_files.write_dwarf import debug_sections

SOURCE = """\
 .sect ".text", 0x9000
 .global _c_int00
_c_int00: NOP

 MOVL XAR4,#0x9000
 RPT #9 || NOP
 .sect "far", 0x8000
 NOP
"""


def test_each_address_has_the_line_that_it_was_assembled_from():
    """NOP in line 3, MOVL of two words in line 5, RPT and NOP in line 6; a second section below the first."""
    debug = DebugInfo(assemble(SOURCE, Path("own.asm")))
    lines = {address: str(debug.line_at(address)) for address in (0x8000, 0x9000, 0x9001, 0x9002, 0x9003, 0x9004)}
    assert lines == {
        0x8000: "own.asm:8", 0x9000: "own.asm:3", 0x9001: "own.asm:5", 0x9002: "own.asm:5", 0x9003: "own.asm:6",
        0x9004: "own.asm:6",
    }  # fmt: skip
    assert [debug.line_at(address) for address in (0x7FFF, 0x8001, 0x8FFF, 0x9005)] == [None] * 4
    assert debug.damaged == ""


def test_an_address_is_set_by_an_operation_that_tells_its_length():
    """DWARF 2, section 6.2.5.3: a zero, the bytes that follow, DW_LNE_set_address and the address."""
    lines = assemble(SOURCE, Path("own.asm")).debug[".debug_line"]
    assert bytes((0, 5, 2)) + (0x9000).to_bytes(4, "little") in lines


def test_every_byte_of_a_program_of_two_lines():
    """A line of the source and one of a file that it includes, 197 lines further; 128 words behind it is the end."""
    sections = debug_sections("a.asm", [([(0x8000, "a.asm", 3), (0x8001, "b.inc", 200)], 0x8081)])
    assert sections == {
        ".debug_abbrev": bytes.fromhex("01 11 00  03 08  10 06  13 05  25 08  00 00  00"),
        ".debug_info": bytes.fromhex("28000000 0200 00000000 04  01")
        + b"a.asm\0"
        + bytes.fromhex("00000000 0180")
        + b"periph-sim assemble\0",
        ".debug_line": bytes.fromhex("44000000 0200 22000000  01 01 FB 0E 0A  00 01 01 01 01 00 00 00 01  00")
        + b"a.asm\0\0\0\0b.inc\0\0\0\0\0"
        + bytes.fromhex("00 05 02 00800000  04 01  02 00  03 02  01  04 02  02 01  03 C501  01  02 8001  00 01 01"),
    }


def test_no_file_no_debug_data():
    assert assemble(SOURCE).debug == {}


@given(
    st.lists(
        st.tuples(st.integers(1, 300), st.sampled_from(["a.asm", "b c.inc", "x/d.asm"]), st.integers(1, 100_000)),
        min_size=1,
        max_size=20,
    ),
    st.integers(0, 0x3F_0000),
    st.integers(1, 1000),
)
def test_any_rows_come_back(steps: list[tuple[int, str, int]], first: int, last: int):
    rows, at = [], first
    for words, file, line in steps:
        rows.append((at, file, line))
        at += words
    sections = debug_sections("a.asm", [(rows, at + last)])
    debug = DebugInfo(Image("own", 0, (), debug=sections))
    assert [(at, *(line or (None, None))) for at, line in debug.lines] == [*rows, (at + last, None, None)]
    assert debug.damaged == ""
