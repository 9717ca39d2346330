"""Routines in a library of objects: an archive as TI's tools write it goes in; words of a routine, with its address in
place and its tables bound, come out.

    "!<arch>" | member: header 60, COFF2 object | ...        "//" holds names of more than 15 characters

Source: SPRAAO8 (COFF2 objects; an entry of relocation has 12 bytes), SPRU513 chapter 7 (archiver).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from periph_sim.processor.image_files.coff2 import COPY, EXTERNAL, FILE_HEADER, SECTION_HEADER, SYMBOL

MAGIC, MEMBER_HEADER, NAMES = b"!<arch>\n", 60, "//"
RELOCATION = struct.Struct("<IIHH")


@dataclass(frozen=True)
class Routine:
    """The one section of an object that is loaded. binds: what a 22-bit address in it means, by its offset."""

    words: tuple[int, ...]
    binds: Mapping[int, str]
    defines: Mapping[str, int]

    def at(self, symbols: Mapping[str, int]) -> tuple[int, ...]:
        """Its words, where symbols are at these addresses."""
        words = list(self.words)
        for offset, name in self.binds.items():
            address = symbols[name] + (words[offset] << 16 | words[offset + 1])  # what is there is added
            words[offset] = words[offset] & ~0x3F | address >> 16 & 0x3F
            words[offset + 1] = address & 0xFFFF
        return tuple(words)


def routines(library: Path) -> dict[str, Routine]:
    """Each member of an archive by its name without the ending."""
    return {name.rpartition(".")[0]: _object(data) for name, data in _members(library.read_bytes())}


def _members(data: bytes) -> Iterator[tuple[str, bytes]]:
    assert data.startswith(MAGIC)
    names, at = b"", len(MAGIC)
    while at + MEMBER_HEADER <= len(data):
        name, size = data[at : at + 16].decode("latin-1").rstrip(), int(data[at + 48 : at + 58])
        contents = data[at + MEMBER_HEADER : at + MEMBER_HEADER + size]
        if name == NAMES:
            names = contents
        elif name != "/":
            if name.startswith("/"):
                first = int(name[1:])
                name = names[first : names.index(b"/", first)].decode("latin-1")
            yield name.rstrip("/"), contents
        at += MEMBER_HEADER + size + (size & 1)


def _object(data: bytes) -> Routine:
    _, sections, _, symbols_at, symbols, optional, _, _ = FILE_HEADER.unpack_from(data)
    strings = data[symbols_at + SYMBOL.size * symbols :]
    named: dict[int, str] = {}
    defines: dict[str, int] = {}
    index = 0
    while index < symbols:
        name, value, section, _, kind, more = SYMBOL.unpack_from(data, symbols_at + SYMBOL.size * index)
        named[index] = _name(name, strings)
        if section > 0 and kind == EXTERNAL:
            defines[named[index]] = value
        index += 1 + more
    for number in range(sections):
        header = SECTION_HEADER.unpack_from(data, FILE_HEADER.size + optional + SECTION_HEADER.size * number)
        size, raw, relocations_at, relocations, flags = header[3], header[4], header[5], header[7], header[9]
        if size and raw and not flags & COPY and not header[0].startswith(b".debug"):
            bound = (RELOCATION.unpack_from(data, relocations_at + RELOCATION.size * n) for n in range(relocations))
            binds = {offset: named.get(symbol, "") for offset, symbol, *_ in bound}
            return Routine(struct.unpack_from(f"<{size}H", data, raw), binds, defines)
    return Routine((), {}, defines)


def _name(field: bytes, strings: bytes) -> str:
    zero, offset = struct.unpack("<II", field)
    if zero:
        return field.rstrip(b"\0").decode("latin-1")
    return strings[offset : strings.index(b"\0", offset)].decode("latin-1")
