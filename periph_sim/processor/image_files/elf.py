"""Reader for C28x ELF files, as TI's linker writes them for programs in EABI.

Addresses count words, sizes count bytes. The physical address of a segment is the load address, the virtual address is
the run address.

Source: SPRAC71B chapters 4 and 13. Tested only with our own files, because no public F28335 image of this format is
known.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator

from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import Section as ElfSection
from elftools.elf.sections import SymbolTableSection

from .model import BadImage, Image, Section, Symbol, quoted

C2000 = "EM_TI_C2000"


def read(data: bytes) -> Image:
    """Return the image in the data of an executable ELF file for the C28x. Raise BadImage for any other data."""
    try:
        elf = ELFFile(io.BytesIO(data))
        machine = elf["e_machine"]
        if machine != C2000 or elf.elfclass != 32 or not elf.little_endian:
            named = elf.get_machine_arch().strip("<>")
            raise BadImage(
                f"it is ELF for {named}; the F28335 runs ELF for TI C2000, 32 bits, little-endian; build it for that"
            )
        if elf["e_type"] != "ET_EXEC":
            raise BadImage("it is an object file or a library; link it into an executable .out")
        sections = list(elf.iter_sections())
        return Image(
            kind="ELF",
            entry=elf["e_entry"],
            sections=tuple(_section(section, elf) for section in sections if section["sh_flags"] & SH_FLAGS.SHF_ALLOC),
            symbols=tuple(_symbols(elf)),
            debug={
                section.name: section.data()
                for section in sections
                if section.name.startswith(".debug") and section["sh_type"] == "SHT_PROGBITS"
            },
        )
    except BadImage:
        raise
    except Exception as error:  # for a damaged file, the library raises exceptions of many types
        raise BadImage(
            f"its ELF structure is damaged ({type(error).__name__}: {error}); link or fetch it again"
        ) from None


def _section(section: ElfSection, elf: ELFFile) -> Section:
    run, size = section["sh_addr"], section["sh_size"]
    has_contents = section["sh_type"] != "SHT_NOBITS" and size > 0
    raw = b""
    if has_contents:
        raw = section.data()
        if len(raw) != size:
            raise BadImage(
                f"it is truncated: section {quoted(section.name)} has {len(raw)} of its {size} bytes; fetch it again"
            )
        if size % 2:
            raise BadImage(f"section {quoted(section.name)} has {size} bytes, which is not a whole number of words")
    return Section(
        name=section.name,
        address=_load_address(section, elf) if has_contents else run,
        run=run,
        size=(size + 1) // 2,
        words=struct.unpack(f"<{len(raw) // 2}H", raw),
        allocated=size > 0,
        code=bool(section["sh_flags"] & SH_FLAGS.SHF_EXECINSTR),
    )


def _load_address(section: ElfSection, elf: ELFFile) -> int:
    """Return the load address of the contents of a section. Raise BadImage if no segment contains them."""
    begin, end = section["sh_offset"], section["sh_offset"] + section["sh_size"]
    for segment in elf.iter_segments("PT_LOAD"):
        if segment["p_offset"] <= begin and end <= segment["p_offset"] + segment["p_filesz"]:
            return int(segment["p_paddr"] + (begin - segment["p_offset"]) // 2)
    raise BadImage(f"section {quoted(section.name)} has contents that no segment loads")


def _symbols(elf: ELFFile) -> Iterator[Symbol]:
    for table in elf.iter_sections("SHT_SYMTAB"):
        if not isinstance(table, SymbolTableSection):
            continue
        for symbol in table.iter_symbols():
            kind, index = symbol["st_info"]["type"], symbol["st_shndx"]
            if not symbol.name or kind in ("STT_SECTION", "STT_FILE") or index == "SHN_UNDEF":
                continue
            where = elf.get_section(index).name if isinstance(index, int) else ""
            label = kind == "STT_NOTYPE" and symbol.name.startswith("$")
            yield Symbol(symbol.name, symbol["st_value"], where, symbol["st_info"]["bind"] == "STB_GLOBAL", label)
