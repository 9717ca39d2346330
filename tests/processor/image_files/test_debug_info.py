"""Functions and lines of debug data that are written byte by byte as in DWARF 2, sections 6.2, 7.5 and 7.6."""

from __future__ import annotations

import struct
from dataclasses import replace

from periph_sim.processor.image_files.assemble import debug_sections
from periph_sim.processor.image_files.debug_info import DebugInfo, Function
from periph_sim.processor.image_files.function_cycles import function_cycles
from periph_sim.processor.image_files.inspection import inspect
from periph_sim.processor.image_files.model import Image, Section, Symbol

ABBREVIATIONS = bytes.fromhex(
    "01 11 01 10 06 00 00"  # unit: DW_AT_stmt_list
    "02 2E 00 03 08 11 01 12 01 00 00"  # subprogram: DW_AT_name, low_pc, high_pc as an address
    "03 2E 00 03 08 11 01 12 06 00 00"  # high_pc as a length
    "04 2E 00 03 08 11 01 00 00"  # without high_pc: a declaration
    "05 34 00 03 08 11 01 12 01 00 00 00"  # a variable with addresses, which no compiler writes
)
BY_END, BY_LENGTH, DECLARED, VARIABLE = 2, 3, 4, 5


def entry(kind: int, name: str, low: int, high: int | None) -> bytes:
    addresses = (low,) if high is None else (low, high)
    return bytes((kind,)) + name.encode() + b"\0" + struct.pack(f"<{len(addresses)}I", *addresses)


ENTRIES = (
    entry(BY_END, "second", 0x8008, 0x8030)
    + entry(BY_LENGTH, "first", 0x8000, 4)
    + entry(BY_LENGTH, "first", 0x8000, 4)
    + entry(BY_LENGTH, "empty", 0x8004, 0)
    + entry(BY_END, "of no section", 0x9100, 0x9104)
    + entry(DECLARED, "elsewhere", 0x8005, None)
    + entry(VARIABLE, "data", 0x8005, 0x8006)
)
INFO = struct.pack("<HIB", 2, 0, 4) + b"\1" + struct.pack("<I", 0) + ENTRIES + b"\0"
DEBUG = {
    ".debug_info": struct.pack("<I", len(INFO)) + INFO,
    ".debug_abbrev": ABBREVIATIONS,
    ".debug_line": debug_sections("a.c", [([(0x8000, "a.c", 7), (0x8008, "b.c", 9)], 0x8020)])[".debug_line"],
}
SYMBOLS = (
    Symbol("_first", 0x8000, ".text"),
    Symbol("inner", 0x8002, ".text", external=False),
    Symbol("z_local", 0x8004, ".text", external=False),
    Symbol("_between", 0x8004, ".text"),
    Symbol("_c", 0x8004, ".text"),
    Symbol("a_local", 0x8004, ".text", external=False),
    Symbol("a_label", 0x8006, ".text", label=True),
    Symbol("_of_another_section", 0x8007, ".data"),
    Symbol("_behind", 0x8020, ".text"),
)
IMAGE = Image("own", 0x8000, (Section(".text", 0x8000, 0x8000, 0x20, [0x7700] * 0x20, code=True),), SYMBOLS, (), DEBUG)


def test_functions_are_those_with_an_extent_each_once_by_address():
    assert DebugInfo(IMAGE).functions == (
        ("first", 0x8000, 0x8004),
        ("second", 0x8008, 0x8030),
        ("of no section", 0x9100, 0x9104),
    )


def test_symbols_give_functions_where_debug_data_have_none_and_a_section_ends_the_last_one():
    """If an address has several symbols, the external one is used, and of several such the first by name."""
    a, b = DebugInfo(IMAGE).line_at(0x8000), DebugInfo(IMAGE).line_at(0x8008)
    assert (str(a), str(b)) == ("a.c:7", "b.c:9")
    assert inspect(IMAGE).functions == (
        Function("first", 0x8000, 4, ".text", a),
        Function("_between", 0x8004, 4, ".text", a),
        Function("second", 0x8008, 0x18, ".text", b),
    )
    assert inspect(replace(IMAGE, entry=0x8003)).entry_name == "first"


def test_cycles_of_instructions_are_listed_with_their_lines():
    assert [row.line for row in function_cycles(IMAGE, "_between").rows] == ["7"] * 4
    assert {row.line for row in function_cycles(replace(IMAGE, debug={}), "_first").rows} == {""}


def test_a_sequence_that_begins_at_the_end_of_another_and_the_last_of_two_rows_are_used():
    """The end of one sequence is the start of another: the line of the latter is used."""
    first, second = (
        ([(0x8000, "a.c", 1), (0x8002, "a.c", 2), (0x8002, "a.c", 3)], 0x8004),
        ([(0x8004, "a.c", 9)], 0x8006),
    )
    for sequences in ([first, second], [second, first]):
        debug = DebugInfo(replace(IMAGE, debug=debug_sections("a.c", sequences)))
        assert [(at, line and line.line) for at, line in debug.lines] == [
            (0x8000, 1), (0x8002, 3), (0x8004, 9), (0x8006, None)
        ]  # fmt: skip


def test_a_file_number_outside_the_table_is_unknown():
    sections = debug_sections("a.c", [([(0x8000, "a.c", 7), (0x8002, "b.c", 9)], 0x8004)])
    lines = sections[".debug_line"]
    for number, file in ((0, "?"), (1, "a.c"), (2, "b.c"), (3, "?")):
        changed = {**sections, ".debug_line": lines.replace(b"\4\2\2\2", bytes((4, number, 2, 2)))}  # DW_LNS_set_file
        line = DebugInfo(replace(IMAGE, debug=changed)).line_at(0x8002)
        assert line is not None and (line.file, line.line) == (file, 9)


def test_debug_data_without_one_of_their_sections_are_ignored():
    for name in (".debug_info", ".debug_abbrev"):
        debug = DebugInfo(replace(IMAGE, debug={key: data for key, data in DEBUG.items() if key != name}))
        assert (debug.functions, debug.lines, debug.damaged) == ((), (), "")


def test_functions_before_damaged_debug_data_are_read():
    whole = DEBUG[".debug_info"]
    debug = DebugInfo(replace(IMAGE, debug={**DEBUG, ".debug_info": whole + whole[:-20]}))
    assert debug.functions and debug.damaged
