"""Source lines as DWARF debug data, readable by `debug_info`.

Source: DWARF 2, sections 6.2 (line program), 7.5 (abbreviations and entries).
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

VERSION = 2
ADDRESS_BYTES = 4
COMPILE_UNIT = 0x11
NAME, STMT_LIST, LANGUAGE, PRODUCER = 0x03, 0x10, 0x13, 0x25  # DW_AT
STRING, DATA2, DATA4 = 0x08, 0x05, 0x06  # DW_FORM
ASSEMBLER = 0x8001  # DW_LANG_Mips_Assembler, which other assemblers write, too
COPY, ADVANCE_PC, ADVANCE_LINE, SET_FILE = 1, 2, 3, 4  # DW_LNS
END_SEQUENCE, SET_ADDRESS = 1, 2  # DW_LNE
OPERANDS = bytes((0, 1, 1, 1, 1, 0, 0, 0, 1))  # of the standard opcodes 1 to 9

Row = tuple[int, str, int]  # address, file, line


def debug_sections(file: str, sequences: Sequence[tuple[Sequence[Row], int]]) -> dict[str, bytes]:
    """Return the sections by name. file: of the unit. sequences: ascending rows, and the address after the last one."""
    abbreviation = bytes(
        (1, COMPILE_UNIT, 0, NAME, STRING, STMT_LIST, DATA4, LANGUAGE, DATA2, PRODUCER, STRING, 0, 0, 0)
    )
    unit = b"\1" + _text(file) + struct.pack("<IH", 0, ASSEMBLER) + _text("periph-sim assemble")
    head = struct.pack("<HIB", VERSION, 0, ADDRESS_BYTES)
    numbers = {file: 1}
    program = b"".join(_sequence(rows, end, numbers) for rows, end in sequences)
    names = b"".join(_text(name) + b"\0\0\0" for name in numbers)  # folder, time and length are left 0
    files = b"\0" + names + b"\0"
    rest = struct.pack("<BBbBB", 1, 1, -5, 14, len(OPERANDS) + 1) + OPERANDS + files
    return {
        ".debug_abbrev": abbreviation,
        ".debug_info": _sized(head + unit),
        ".debug_line": _sized(struct.pack("<HI", VERSION, len(rest)) + rest + program),
    }


def _sequence(rows: Sequence[Row], end: int, numbers: dict[str, int]) -> bytes:
    """Encode one sequence. numbers: of files; new files are added."""
    at, line = rows[0][0], 1
    program = bytes((0, 1 + ADDRESS_BYTES, SET_ADDRESS)) + struct.pack("<I", at)
    for address, file, number in rows:
        program += bytes((SET_FILE,)) + _uleb(numbers.setdefault(file, len(numbers) + 1)) + _advance(address - at)
        program += bytes((ADVANCE_LINE,)) + _sleb(number - line) + bytes((COPY,))
        at, line = address, number
    return program + _advance(end - at) + bytes((0, 1, END_SEQUENCE))


def _advance(words: int) -> bytes:
    return bytes((ADVANCE_PC,)) + _uleb(words)


def _sized(data: bytes) -> bytes:
    return struct.pack("<I", len(data)) + data


def _text(text: str) -> bytes:
    return text.encode("utf-8", "replace") + b"\0"


def _uleb(number: int) -> bytes:
    """Encode an unsigned LEB128: seven bits per byte, low ones first."""
    coded = bytearray()
    while True:
        number, low = number >> 7, number & 0x7F
        coded.append(low | (0x80 if number else 0))
        if not number:
            return bytes(coded)


def _sleb(number: int) -> bytes:
    """Encode a signed LEB128: the sign is bit 6 of the last byte."""
    coded = bytearray()
    while True:
        number, low = number >> 7, number & 0x7F
        done = number == (-1 if low & 0x40 else 0)
        coded.append(low | (0 if done else 0x80))
        if done:
            return bytes(coded)
