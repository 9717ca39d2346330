"""Build images for tests from words of code."""

from __future__ import annotations

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
    """Return an image of these sections; if none are given, of the code above, data and a stack."""
    if sections:
        return Image("TI COFF2", entry, sections)
    data = Section(".econst", 0x9000, 0x9000, 3, (1, 0xFFFF, 3))
    stack = Section(".stack", 0x400, 0x400, 0x300)
    return Image("TI COFF2", entry, (text(), data, stack), NAMES, tool_version=5002)
