"""An image whose debug data declare variables with types, written byte by byte as in DWARF 2, sections 7.5 and 7.6.

struct { far long count; unsigned parts[3][2]; struct { int sign; float gain; } inner; unsigned low : 3; } state;
unsigned words[5];    long long wide;    int *pointers[3];
"""

from __future__ import annotations

import struct

from periph_sim.processor.image_files.model import Image, Section, Symbol

UNIT, BASE, STRUCT, MEMBER, ARRAY, RANGE, VARIABLE, BITS, TYPEDEF, FAR, POINTER, COUNTED = range(1, 13)
NAME, LOCATION, SIZE, ENCODING, TYPE, UPPER, OFFSET, BIT_SIZE, COUNT = (
    0x03,
    0x02,
    0x0B,
    0x3E,
    0x49,
    0x2F,
    0x38,
    0x0D,
    0x37,
)
STRING, DATA1, REF4, BLOCK1 = 0x08, 0x0B, 0x13, 0x0A
ABBREVIATIONS = {  # number: tag, has children, attributes with their forms
    UNIT: (0x11, 1, ()),
    BASE: (0x24, 0, ((NAME, STRING), (SIZE, DATA1), (ENCODING, DATA1))),
    STRUCT: (0x13, 1, ((SIZE, DATA1),)),
    MEMBER: (0x0D, 0, ((NAME, STRING), (OFFSET, BLOCK1), (TYPE, REF4))),
    ARRAY: (0x01, 1, ((TYPE, REF4),)),
    RANGE: (0x21, 0, ((UPPER, DATA1),)),
    VARIABLE: (0x34, 0, ((NAME, STRING), (LOCATION, BLOCK1), (TYPE, REF4))),
    BITS: (0x0D, 0, ((NAME, STRING), (OFFSET, BLOCK1), (TYPE, REF4), (BIT_SIZE, DATA1))),
    TYPEDEF: (0x16, 0, ((NAME, STRING), (TYPE, REF4))),
    FAR: (0x4080, 0, ((TYPE, REF4),)),
    POINTER: (0x0F, 0, ((TYPE, REF4),)),
    COUNTED: (0x21, 0, ((COUNT, DATA1),)),
}
HEAD = 11  # bytes of a unit before its first entry
SIGNED, UNSIGNED, FLOAT = 5, 7, 4


class Entries:
    """Consecutive debug entries; `add` returns the offset of an entry, by which others refer to it."""

    def __init__(self) -> None:
        self.data = bytes((UNIT,))

    def add(self, number: int, *values: bytes) -> int:
        place = HEAD + len(self.data)
        self.data += bytes((number,)) + b"".join(values)
        return place

    def end(self) -> None:
        self.data += b"\0"


def text(name: str) -> bytes:
    return name.encode() + b"\0"


def uleb(number: int) -> bytes:
    return bytes((number,)) if number < 0x80 else bytes((number & 0x7F | 0x80,)) + uleb(number >> 7)


def to(place: int) -> bytes:
    return struct.pack("<I", place)


def at(offset: int) -> bytes:
    """Return a DW_OP_plus_uconst block."""
    return bytes((2, 0x23, offset))


def address(of: int) -> bytes:
    """Return a DW_OP_addr block."""
    return bytes((5, 0x03)) + struct.pack("<I", of)


def typed_image() -> Image:
    """Return it: state is at 0x9040, words at 0x9060, wide at 0x9070, pointers at 0x90A0; plain is only a symbol."""
    entries = Entries()
    add = entries.add
    long_ = add(BASE, text("long"), b"\2", bytes((SIGNED,)))
    wide = add(BASE, text("long long"), b"\4", bytes((SIGNED,)))
    word = add(BASE, text("unsigned int"), b"\1", bytes((UNSIGNED,)))
    int_ = add(BASE, text("int"), b"\1", bytes((SIGNED,)))
    gain = add(BASE, text("float"), b"\2", bytes((FLOAT,)))
    far = add(FAR, to(long_))
    int16 = add(TYPEDEF, text("int16"), to(int_))
    inner = add(STRUCT, b"\4")
    add(MEMBER, text("sign"), at(0), to(int16))
    add(MEMBER, text("gain"), at(2), to(gain))
    entries.end()
    parts = add(ARRAY, to(word))
    add(RANGE, b"\2")
    add(RANGE, b"\1")
    entries.end()
    state = add(STRUCT, b"\x0e")
    add(MEMBER, text("count"), at(0), to(far))
    add(MEMBER, text("parts"), at(2), to(parts))
    add(MEMBER, text("inner"), at(8), to(inner))
    add(BITS, text("low"), at(12), to(word), b"\3")
    entries.end()
    words = add(ARRAY, to(word))
    add(RANGE, b"\4")
    entries.end()
    pointer = add(POINTER, to(int_))
    pointers = add(ARRAY, to(pointer))
    add(COUNTED, b"\3")
    entries.end()
    of_state = (("state", 0x9040, state), ("words", 0x9060, words), ("wide", 0x9070, wide))
    for name, place, kind in (*of_state, ("pointers", 0x90A0, pointers)):
        add(VARIABLE, text(name), address(place), to(kind))
    add(VARIABLE, text("of_a_frame"), bytes((2, 0x91, 0x05)), to(int_))  # DW_OP_fbreg
    add(VARIABLE, text("computed"), bytes((5, 0x23, 0x60, 0x90, 0, 0)), to(int_))
    entries.end()
    body = struct.pack("<HIB", 2, 0, 4) + entries.data
    abbreviations = b"".join(
        bytes((number, *uleb(tag), children, *(byte for pair in attributes for byte in pair), 0, 0))
        for number, (tag, children, attributes) in ABBREVIATIONS.items()
    )
    known = {
        "_state": 0x9040,
        "_words": 0x9060,
        "_wide": 0x9070,
        "_pointers": 0x90A0,
        "_plain": 0x9080,
        "_regs": 0x7900,
    }
    return Image(
        "TI COFF2",
        0x9000,
        (Section(".text", 0x9000, 0x9000, 1, [0], code=True), Section(".ebss", 0x9040, 0x9040, 0x80)),
        tuple(Symbol(name, place, ".ebss") for name, place in known.items()),
        debug={".debug_info": struct.pack("<I", len(body)) + body, ".debug_abbrev": abbreviations + b"\0"},
    )
