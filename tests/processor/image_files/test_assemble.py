"""Assembly source gives an image, or an error with the line."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.processor.c28x.decoder import sweep
from periph_sim.processor.image_files import assemble as assemble_module
from periph_sim.processor.image_files.assemble import assemble, assemble_file, debug_sections, sources_of
from periph_sim.processor.image_files.debug_info import DebugInfo
from periph_sim.processor.image_files.inspection import inspect
from periph_sim.processor.image_files.load import load
from periph_sim.processor.image_files.model import BadImage, Image
from tests.interfaces.commands.conftest import Run, periph_sim  # noqa: F401

ROOT = Path(__file__).resolve().parents[3]
ECHO = ROOT / "firmware" / "c28x" / "sci_echo.asm"
BEGUN = '.sect ".text", 0x8000\n_c_int00: NOP\n'


def words(source: str) -> tuple[int, ...]:
    return tuple(assemble(BEGUN + source).sections[0].words[1:])


def test_sections_have_the_addresses_of_the_source():
    found = assemble(
        BEGUN
        + '.sect "ramfuncs", 0x9000, 0x320000\nLRETR\n.sect ".econst", 0xA000\n.word 1\n.reserve ".bss", 0x400, 9\n'
    )
    assert [(one.name, one.run, one.address, one.size, one.code) for one in found.sections] == [
        (".text", 0x8000, 0x8000, 1, True),
        ("ramfuncs", 0x9000, 0x320000, 1, True),
        (".econst", 0xA000, 0xA000, 1, False),
        (".bss", 0x400, 0x400, 9, False),
    ]


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        (".word 1, -1, 'A', 0x10 + 2", (1, 0xFFFF, 65, 0x12)),
        (".word 0xFFFF, -0x8000", (0xFFFF, 0x8000)),
        (".long 0x12345678, -2", (0x5678, 0x1234, 0xFFFE, 0xFFFF)),
        (".long 0xFFFFFFFF, -0x80000000", (0xFFFF, 0xFFFF, 0, 0x8000)),
        ('.string "a;b", "c"  ; a comment', (97, 59, 98, 99)),
        (".space 3", (0, 0, 0)),
        ("a: SB b,EQ\n SB a,UNC\nb: LRETR", (0x6102, 0x6FFF, 0x0006)),
        ("MOVL XAR4,#table\ntable: .long table", (0x8F00, 0x8003, 0x8003, 0)),
        (".align 4\nLRETR", (0x7700, 0x7700, 0x7700, 0x0006)),
        (".align 0\n.align 1\nLRETR", (0x0006,)),
        ("RPT #9 || NOP", (0xF609, 0x7700)),
        ("RPT #9\n || NOP", (0xF609, 0x7700)),
    ],
)
def test_words(source: str, expected: tuple[int, ...]):
    assert words(source) == expected


def test_dollar_is_the_address_of_a_line_and_0_before_any_section():
    assert words(".word $, $\n.long $") == (0x8001, 0x8002, 0x8003, 0)
    found = assemble("BEFORE .set $ + 5\n" + BEGUN + "AT .set $\n")
    assert [one.address for one in found.symbols] == [5, 0x8000, 0x8001]


def test_limits_of_section_size_and_include_depth(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr(assemble_module, "MOST_WORDS", 4)
    assert words(".space 3") == (0, 0, 0)
    for directive, sentence in (
        (".space 4", "section '.text' has more than 4 words"),
        (".space 5", "'5' is 5, which is not a valid number of words"),
    ):  # fmt: skip
        with pytest.raises(BadImage, match=f"^line 3: {sentence}$"):
            words(directive)
    monkeypatch.setattr(assemble_module, "MOST_INCLUDES", 2)
    for name, inner in (("a", "b"), ("b", "c")):
        (tmp_path / f"{name}.inc").write_text(f'.include "{inner}.inc"\n')
    (tmp_path / "c.inc").write_text("NOP\n")
    source = f'{BEGUN}.include "{{}}.inc"\n.include "c.inc"'
    assert len(assemble(source.format("b"), tmp_path / "x.asm").sections[0].words) == 3
    with pytest.raises(BadImage, match=r'b\.inc, line 1: "c\.inc": .include is nested more than 2 deep'):
        assemble(source.format("a"), tmp_path / "x.asm")


def test_a_file_beside_the_source_hides_a_shipped_one(tmp_path: Path):
    (tmp_path / "f28335.inc").write_bytes(b"\xef\xbb\xbfI2CMDR .set 7")  # starts with a byte order mark
    assert assemble(f'.include "f28335.inc"\n{BEGUN}.word I2CMDR', tmp_path / "x.asm").sections[0].words[1] == 7


def test_functions_are_global_symbols_and_the_entry():
    found = assemble(BEGUN + "wait: NOP\n_f: LRETR\n .global _f\nSIZE .set 3\n")
    assert [(one.name, one.external, one.label, one.section) for one in found.symbols] == [
        ("_c_int00", True, False, ".text"),
        ("wait", False, True, ".text"),
        ("_f", True, False, ".text"),
        ("SIZE", False, False, ""),
    ]


def test_included_files_are_searched_beside_the_source_and_then_among_the_shipped_ones(tmp_path: Path):
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "a.inc").write_text('.include "b.inc"\nA .set B + 1')
    (tmp_path / "inner" / "b.inc").write_text("B .set 4 ; beside a.inc")
    source = tmp_path / "x.asm"
    source.write_text('.include "inner/a.inc"\n.include "f28335.inc"\n' + BEGUN + ".word A, I2CMDR")
    assert assemble_file(source)[0].sections[0].words[1:] == (5, 0x7909)
    assert [one.name for one in sources_of(source)] == ["x.asm", "a.inc", "f28335.inc", "b.inc"]


def test_a_missing_program_is_the_shipped_one_of_that_name(tmp_path: Path):
    mine = tmp_path / "blink.asm"
    assert assemble_file(mine)[0].symbol_at[0x9023] == "_toggle"
    mine.write_text(BEGUN + ".word 7", encoding="utf-8")
    assert "_toggle" not in assemble_file(mine)[0].symbol_at.values()
    with pytest.raises(BadImage, match=r"none\.asm: No such file"):
        assemble_file(tmp_path / "none.asm")
    assert assemble_file(tmp_path / "firmware" / "c28x" / "rtc.asm")[0].entry
    with pytest.raises(BadImage, match=r"rtc\.asm: No such file or directory; give a source in assembly"):
        assemble_file(tmp_path / "fiirmware" / "c28x" / "rtc.asm")


def test_an_error_in_an_included_file_has_the_line_of_that_file(tmp_path: Path):
    (tmp_path / "a.inc").write_text("\nA .set 1 +\n")
    (tmp_path / "x.asm").write_text(BEGUN + '.include "a.inc"')
    with pytest.raises(BadImage, match=r"x\.asm: a\.inc, line 2: '1 \+' is not a number"):
        assemble_file(tmp_path / "x.asm")


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("NOP", "line 1: no section is open"),
        ('.sect ".text"', 'line 1: .sect ".text" is not .sect'),
        (BEGUN + "MOVE AL,AH", "line 3: there is no instruction 'MOVE'"),
        (BEGUN + "SB nowhere,EQ", "line 3: 'nowhere' is not defined"),
        (BEGUN + ".space 200\nSB _c_int00,EQ", "line 4: '_c_int00' is -201 words away"),
        (BEGUN + "_c_int00: NOP", "line 3: '_c_int00' is defined twice"),
        (BEGUN + ".word 0x10000", "line 3: '0x10000' is 65536, which does not fit 16 bits"),
        (BEGUN + ".word -0x8001", "line 3: '-0x8001' is -32769, which does not fit 16 bits"),
        (BEGUN + ".long 1 << 32", "line 3: '1 << 32' is 4294967296, which does not fit 32 bits"),
        (BEGUN + ".long -0x80000001", "line 3: '-0x80000001' is -2147483649, which does not fit 32 bits"),
        ('.sect ".text", 1, 2, 3', 'line 1: .sect ".text", 1, 2, 3 is not .sect "NAME", ADDRESS [, LOAD ADDRESS]'),
        ('.sect ".text", 1, -2', 'is not .sect "NAME", ADDRESS [, LOAD ADDRESS]'),
        (BEGUN + '.sect ".far", 0x123456789', "line 3: '0x123456789' is 4886718345, which does not fit 32 bits"),
        (BEGUN + '.sect ".far", 0x9000, 1 << 32', "line 3: '1 << 32' is 4294967296, which does not fit 32 bits"),
        (BEGUN + '.sect ".far", 0xFFFFFFFF\n.word 1', "section '.far' lies at 0xffffffff"),
        (BEGUN + '.reserve ".far", 0x9000, 1 << 32', "line 3: '1 << 32' is 4294967296, which does not fit 32 bits"),
        (BEGUN + "X .set 0x1FFFFFFFF", "line 3: '0x1FFFFFFFF' is 8589934591, which does not fit 32 bits"),
        (BEGUN + "X .set -0x80000001", "line 3: '-0x80000001' is -2147483649, which does not fit 32 bits"),
        (BEGUN + "Xω .set 1", "line 3: 'Xω' has the character 'ω', which is not in Latin-1"),
        (BEGUN + '.sect "€", 0x9800', "line 3: '€' has the character '€', which is not in Latin-1"),
        (BEGUN + '.reserve "€", 0x9800, 1', "line 3: '€' has the character '€', which is not in Latin-1"),
        (BEGUN + '.string "5 €"', "line 3: '5 €' has the character '€', which is not in Latin-1"),
        (".sect text, 1", 'is not .sect "NAME", ADDRESS [, LOAD ADDRESS]'),
        ('.reserve ".x", 1', 'is not .reserve "NAME", ADDRESS, WORDS'),
        ('.reserve ".x", 1, 2, 3', 'is not .reserve "NAME", ADDRESS, WORDS'),
        (BEGUN + '.reserve ".x", 1, 2\n.reserve ".x", 3, 4', "line 4: section '.x' is defined twice"),
        (BEGUN + '.reserve ".text", 1, 2', "line 3: section '.text' is defined twice"),
        (BEGUN + '.reserve ".x", 1, 2\n.sect ".x", 3', "line 4: section '.x' is defined twice"),
        (BEGUN + ".space -1", "not a valid number of words"),
        (BEGUN + ".space 1 << 40", "not a valid number of words"),
        (BEGUN + ".align 0x400001", "not a valid number of words"),
        (BEGUN + ".string x", "not a text in double quotes"),
        (BEGUN + ".pragma x", "line 3: there is no directive '.pragma'"),
        (BEGUN + ".global _g", "line 3: '_g' is .global, but not defined"),
        (BEGUN + "NOP\n.entry main", "line 4: the entry 'main' is not defined"),
        ('.sect ".text", 0x8000\nmain: NOP', "its entry '_c_int00' is not defined; define it, or set another one"),
        (BEGUN + ".include none", "line 3: .include none is not .include"),
        (BEGUN + '.include "none.inc"', "none.inc: No such file"),
        (BEGUN + '.include "x.asm"', "'.text' is defined twice"),
        (BEGUN + "AND @0,#1 <<", "line 3: '1 <<' is not a number"),
        (BEGUN + ".entry X\nX .set -1", "its entry 0xffffffff is not in a loaded code section"),
        (BEGUN + '.sect ".text", 0x9000', "line 3: section '.text' is defined twice"),
        (BEGUN + '.sect ".d", 0x8000\n.word 1', "overlap at 0x008000"),
        (BEGUN + '.sect ".d", 0x7900\n.word 1', "over peripheral registers"),
    ],
)
def test_refused_in_one_sentence(tmp_path: Path, source: str, sentence: str):
    file = tmp_path / "x.asm"
    file.write_text(source, encoding="utf-8")
    with pytest.raises(BadImage) as error:
        assemble_file(file)
    assert sentence in str(error.value)
    assert str(error.value).startswith(f"{file}: ")


def test_a_negative_constant_is_a_symbol_of_32_bits_in_the_file(tmp_path: Path):
    (tmp_path / "x.asm").write_text(f"{BEGUN}X .set -1\n.word X")
    image, _ = assemble_file(tmp_path / "x.asm")
    assert {symbol.name: symbol.address for symbol in image.symbols}["X"] == 0xFFFF_FFFF
    assert image.sections[0].words == (0x7700, 0xFFFF)


def test_the_shipped_program_is_written_and_read_back(periph_sim: Run, tmp_path: Path):  # noqa: F811
    came = periph_sim("assemble", str(ECHO), str(tmp_path / "echo.out"))
    assert (came.status, came.out) == (0, f"{tmp_path / 'echo.out'}: 55 words in 1 section, entry 0x009000\n")
    found = inspect(load(tmp_path / "echo.out"))
    assert [one.name for one in found.functions] == ["_c_int00", "_echo", "_start_sci"]
    assert {"SCIRXBUF", "SCITXBUF", "PLLCR"} <= {one.name for one in found.registers}
    source = assemble_file(ECHO)[0].sections[0]
    assert [one.text for one in sweep(0x9000, source.words)][:4] == [
        "MOV @SP,#0x400", "EALLOW", "MOVW DP,#0x1c0", "MOV @0x29,#0x68"
    ]  # fmt: skip


def test_bad_source_is_one_sentence_and_status_2(periph_sim: Run, tmp_path: Path):  # noqa: F811
    (tmp_path / "x.asm").write_bytes(b"\xff\xfe")
    for source in ("x.asm", "none.asm"):
        came = periph_sim("assemble", str(tmp_path / source), str(tmp_path / "x.out"))
        assert came.status == 2
        assert came.err.startswith(f"Error: {tmp_path / source}: ") and came.err.count("\n") == 1
        assert not (tmp_path / "x.out").exists()


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
    """NOP is in line 3, MOVL of two words in line 5, RPT and NOP in line 6; a second section has lower addresses."""
    debug = DebugInfo(assemble(SOURCE, Path("own.asm")))
    lines = {address: str(debug.line_at(address)) for address in (0x8000, 0x9000, 0x9001, 0x9002, 0x9003, 0x9004)}
    assert lines == {
        0x8000: "own.asm:8", 0x9000: "own.asm:3", 0x9001: "own.asm:5", 0x9002: "own.asm:5", 0x9003: "own.asm:6",
        0x9004: "own.asm:6",
    }  # fmt: skip
    assert [debug.line_at(address) for address in (0x7FFF, 0x8001, 0x8FFF, 0x9005)] == [None] * 4
    assert debug.damaged == ""


def test_every_byte_of_a_program_of_two_lines():
    """One line of the source and one of an included file, 197 lines later; the sequence ends 128 words after it."""
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


def test_an_image_from_text_has_no_debug_data():
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
def test_any_line_table_is_read_back(steps: list[tuple[int, str, int]], first: int, last: int):
    rows, at = [], first
    for words, file, line in steps:
        rows.append((at, file, line))
        at += words
    sections = debug_sections("a.asm", [(rows, at + last)])
    debug = DebugInfo(Image("own", 0, (), debug=sections))
    assert [(at, *(line or (None, None))) for at, line in debug.lines] == [*rows, (at + last, None, None)]
    assert debug.damaged == ""
