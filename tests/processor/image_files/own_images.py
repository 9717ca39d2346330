"""Images of our own for tests: words of code go in; an image, or the bytes of a file of either format, come out."""

from __future__ import annotations

import struct
from collections.abc import Sequence

from periph_sim.processor.image_files.model import Image, Section, Symbol

ENTRY = 0x8000

# MOVW DP,#0x1E4 (0x7900 >> 6); MOV @0x9,#0x4600 (I2CMDR); OR @0x2,#0x20 (I2CSTR); MOVL XAR4,#0x800D;
# MOVW DP,#0x36 (0xD80 >> 6); MOVL @0x30,XAR4 (I2CINT1A at 0xDB0); SB $,UNC; handler: IRET
CODE = (0x761F, 0x01E4, 0x2809, 0x4600, 0x1A02, 0x0020, 0x8F00, 0x800D, 0x761F, 0x0036, 0xA830, 0x6F00, 0x0006, 0x7602)
HANDLER = ENTRY + len(CODE) - 1

NAMES = (
    Symbol("_main", ENTRY, ".text"),
    Symbol("_handler_of_the_transfer", HANDLER, ".text"),
    Symbol("$C$L1", ENTRY + 11, ".text", external=False, label=True),
    Symbol("__STACK_SIZE", 0x300, ""),
)


def text(words: Sequence[int] = CODE, address: int = ENTRY, name: str = ".text", run: int | None = None) -> Section:
    return Section(name, address, address if run is None else run, len(words), words, code=True)


def image(*sections: Section, entry: int = ENTRY) -> Image:
    """One with these sections; with the code above, data and a stack where none are given."""
    if sections:
        return Image("TI COFF2", entry, sections)
    data = Section(".econst", 0x9000, 0x9000, 3, (1, 0xFFFF, 3))
    stack = Section(".stack", 0x400, 0x400, 0x300)
    return Image("TI COFF2", entry, (text(), data, stack), NAMES, tool_version=5002)


ELF_HEADER = struct.Struct("<16sHHIIIIIHHHHHH")
ELF_SECTION = struct.Struct("<IIIIIIIIII")
ELF_SEGMENT = struct.Struct("<IIIIIIII")
ELF_SYMBOL = struct.Struct("<IIIBBH")
PROGBITS, SYMTAB, STRTAB, NOBITS = 1, 2, 3, 8
ALLOC, EXEC = 2, 4


def elf(machine: int = 141, kind: int = 2, *, code: Sequence[int] = CODE, load: int = 0x320000) -> bytes:
    """A C28x ELF by hand: .text runs at ENTRY and is loaded at `load`; .bss; one function symbol."""
    raw = struct.pack(f"<{len(code)}H", *code)
    names = b"\0.text\0.bss\0.symtab\0.strtab\0main\0"
    at = ELF_HEADER.size + ELF_SEGMENT.size
    symbols = ELF_SYMBOL.pack(0, 0, 0, 0, 0, 0) + ELF_SYMBOL.pack(names.index(b"main"), ENTRY, 2, 0x12, 0, 1)
    body = raw + symbols + names
    sections = (
        ELF_SECTION.pack(*[0] * 10),
        ELF_SECTION.pack(1, PROGBITS, ALLOC | EXEC, ENTRY, at, len(raw), 0, 0, 2, 0),
        ELF_SECTION.pack(names.index(b".bss"), NOBITS, ALLOC, 0x400, at, 0x20, 0, 0, 2, 0),
        ELF_SECTION.pack(names.index(b".symtab"), SYMTAB, 0, 0, at + len(raw), len(symbols), 4, 1, 4, 16),
        ELF_SECTION.pack(names.index(b".strtab"), STRTAB, 0, 0, at + len(raw) + len(symbols), len(names), 0, 0, 1, 0),
    )
    header = ELF_HEADER.pack(
        b"\x7fELF\x01\x01\x01".ljust(16, b"\0"), kind, machine, 1, load, ELF_HEADER.size, at + len(body), 0,
        ELF_HEADER.size, ELF_SEGMENT.size, 1, ELF_SECTION.size, len(sections), 4,
    )  # fmt: skip
    segment = ELF_SEGMENT.pack(1, at, ENTRY, load, len(raw), len(raw), 5, 2)
    return header + segment + body + b"".join(sections)
