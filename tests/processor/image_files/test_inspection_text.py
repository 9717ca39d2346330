"""The text and the dictionary of an inspection, here of one that is written by hand."""

from __future__ import annotations

from dataclasses import replace

from periph_sim.processor.image_files.debug_info import Function, SourceLine
from periph_sim.processor.image_files.function_cycles import FunctionCycles, Row, cycles_as_json, cycles_text
from periph_sim.processor.image_files.inspection import (
    Inspection,
    Register,
    Unknown,
    Vector,
    as_json,
    text,
)
from periph_sim.processor.image_files.model import Image, Section, Symbol

SECTIONS = (
    Section(".text", 0x8000, 0x8000, 12, [0] * 12, code=True),
    Section("ramfuncs", 0x320000, 0x9000, 4, [0] * 4, code=True),
    Section(".ebss", 0x9100, 0x9100, 8),
    Section("regs", 0x7900, 0x7900, 8),
    Section(".debug", 0, 0, 9, allocated=False),
)
IMAGE = Image("TI COFF2", 0x8001, SECTIONS, (Symbol("_begin", 0x8001, ".text"),), ((0x9100, (7, 8)), (0x9104, (9,))))
MAIN = Function("main", 0x8000, 4, ".text", SourceLine("main.c", 12))
FUNCTIONS = (MAIN, *(Function(f"f{n}", 0x8004 + n, n % 3 + 1, ".text", None) for n in range(10)))
WHOLE = Inspection(
    image=IMAGE,
    entry_name="_begin",
    functions=FUNCTIONS,
    vectors=(Vector("TINT0", 0xD4C, "on_timer", "main"),),
    registers=(
        Register("I2C-A", "I2CMDR", 0x7909, 1, 12, ("main", "f1")),
        Register("I2C-A", "I2CSTR", 0x7902, 3, 0, ("main",)),
        Register("", "0x0880", 0x880, 0, 1, ("main",)),
        Register("ADC", "+0x03", 0x7103, 0, 1, ("main",)),
    ),
    unknown=(Unknown(0x8003, 0xE271, "main"), Unknown(0x8009, 0x0001, "f5")),
    instructions=9,
    words=16,
    debug_damaged="",
)
EMPTY = replace(WHOLE, vectors=(), registers=(), unknown=(), functions=FUNCTIONS[:10])


def test_complete_text():
    assert text(WHOLE).splitlines() == [
        "TI COFF2, entry 0x008001 (_begin)",
        "9 instructions in 16 words of code, 2 unknown words",
        "",
        " section          loaded at  runs at   words  contents",
        " ────────────────────────────────────────────────────────────────────────",
        " .text            0x008000                12  code",
        " ramfuncs         0x320000   0x009000      4  code",
        " .ebss            0x009100                 8  reserved",
        " .cinit, applied                           3  data that the loader writes",
        "",
        " vector  address  handler   stored in",
        " ────────────────────────────────────",
        " TINT0   0x0d4c   on_timer  main",
        "",
        " module  registers touched",
        " ─────────────────────────",
        " I2C-A   I2CMDR, I2CSTR",
        " -       0x0880",
        " ADC     +0x03",
        "not modelled: ADC",
        "",
        " function  address   words  source",
        " ────────────────────────────────────",
        " main      0x008000      4  main.c:12",
        " f2        0x008006      3",
        " f5        0x008009      3",
        " f8        0x00800c      3",
        " f1        0x008005      2",
        " f4        0x008008      2",
        " f7        0x00800b      2",
        " f0        0x008004      1",
        " f3        0x008007      1",
        " f6        0x00800a      1",
        "and 1 smaller functions; -v lists all",
        "",
        "words of code that are not instructions of the F28335:",
        "  0x008003  0xe271  main  the TMU of an F2837x",
        "  0x008009  0x0001  f5",
    ]


def test_verbose_text_lists_all_functions_by_address_and_the_functions_of_each_register():
    lines = text(WHOLE, every=True).splitlines()
    first = lines.index(" register      address  reads  writes  in")
    assert lines[first + 2 : first + 6] == [
        " I2C-A I2CMDR  0x7909       1      12  main, f1",
        " I2C-A I2CSTR  0x7902       3       0  main",
        "  0x0880       0x0880       0       1  main",
        " ADC +0x03     0x7103       0       1  main",
    ]
    assert [line.split()[0] for line in lines[first + 9 : first + 20]] == ["main", *(f"f{n}" for n in range(10))]
    assert not [line for line in lines if line.startswith(("and ", "not modelled"))]


def test_text_of_an_image_without_vectors_registers_and_unknown_words():
    without_symbol = replace(IMAGE, tool_version=6, entry=0x8004)
    lines = text(replace(EMPTY, debug_damaged="KeyError: 3", entry_name="f0", image=without_symbol))
    assert lines.startswith(
        "TI COFF2, linker 6, entry 0x008004 (f0)\n9 instructions in 16 words of code, all known\n"
        "note: debug data are damaged and partly read (KeyError: 3)\n"
    )
    assert "\n\nno vector is stored to a constant address\n\nno register is accessed by a constant address\n\n" in lines
    assert "smaller functions" not in lines and "not instructions" not in lines


def test_complete_dictionary():
    found = as_json(replace(WHOLE, functions=FUNCTIONS[:2], registers=WHOLE.registers[:1], unknown=WHOLE.unknown[:1]))
    assert found == {
        "kind": "TI COFF2",
        "linker": 0,
        "entry": {"address": 0x8001, "name": "_begin"},
        "instructions": 9,
        "words": 16,
        "sections": [
            {"name": ".text", "loaded_at": 0x8000, "runs_at": 0x8000, "words": 12, "contents": "code"},
            {"name": "ramfuncs", "loaded_at": 0x320000, "runs_at": 0x9000, "words": 4, "contents": "code"},
            {"name": ".ebss", "loaded_at": 0x9100, "runs_at": 0x9100, "words": 8, "contents": "reserved"},
            {"name": "regs", "loaded_at": 0x7900, "runs_at": 0x7900, "words": 8, "contents": "registers"},
        ],
        "vectors": [{"name": "TINT0", "address": 0xD4C, "handler": "on_timer", "stored_in": "main"}],
        "registers": [
            {
                "module": "I2C-A",
                "name": "I2CMDR",
                "address": 0x7909,
                "reads": 1,
                "writes": 12,
                "functions": ("main", "f1"),
            }
        ],
        "functions": [
            {"name": "main", "address": 0x8000, "words": 4, "section": ".text", "file": "main.c", "line": 12},
            {"name": "f0", "address": 0x8004, "words": 1, "section": ".text", "file": None, "line": None},
        ],
        "unknown": [{"address": 0x8003, "word": 0xE271, "function": "main"}],
        "debug_damaged": "",
        "shared_memory": [],
    }


def test_cycles_of_a_function():
    rows = (Row(0x8000, "MOV AL,#1", "1", 0, "", "12"), Row(0x8001, "SB 4,EQ", "7/4", 3, "waits for SP", ""))
    found = FunctionCycles(MAIN, rows, 8)
    assert cycles_text(found).splitlines() == [
        " address   instruction  cycles  stall  why           line",
        " ────────────────────────────────────────────────────────",
        " 0x008000  MOV AL,#1         1                       12",
        " 0x008001  SB 4,EQ         7/4      3  waits for SP",
        "",
        "main: 8 cycles with no condition true, 3 of them stalls by rule. cycles:",
        "  published, taken/not taken. Not included: wait states of registers, accesses",
        "  through pointers.",
    ]
    assert cycles_as_json(found) == {
        "function": "main",
        "address": 0x8000,
        "cycles": 8,
        "rows": [
            {"address": 0x8000, "text": "MOV AL,#1", "published": "1", "stall": 0, "why": "", "line": "12"},
            {"address": 0x8001, "text": "SB 4,EQ", "published": "7/4", "stall": 3, "why": "waits for SP", "line": ""},
        ],
    }
