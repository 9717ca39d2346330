"""Writer for TI COFF2 (.out) files, readable by `coff2` and TI's tools.

Source: SPRAAO8.
"""

from __future__ import annotations

import struct

from .coff2 import (
    BSS,
    C28X,
    COFF2,
    COPY,
    DATA,
    EXECUTABLE,
    EXTERNAL,
    FILE_HEADER,
    LABEL,
    OPTIONAL_HEADER,
    SECTION_HEADER,
    STATIC,
    SYMBOL,
    TEXT,
)
from .model import Image, Section, Symbol

LITTLE_ENDIAN, NO_RELOCATIONS = 0x0100, 0x0001
OPTIONAL_MAGIC = 0x0108
ABSOLUTE = -1
SHORT_NAME = 8


def write(image: Image) -> bytes:
    """Return the file's bytes. Debug sections are COPY sections, whose size counts bytes."""
    strings = _Strings()
    contents = [_contents(section) for section in image.sections]
    debug = list(image.debug.items())
    count = len(image.sections) + len(debug)
    at = FILE_HEADER.size + OPTIONAL_HEADER.size + SECTION_HEADER.size * count
    headers, raw = b"", b""
    for section, data in zip(image.sections, contents, strict=True):
        place = at + len(raw) if data else 0
        headers += _header(
            strings.field(section.name), section.run, section.address, section.size, place, _flags(section)
        )
        raw += data
    for name, data in debug:
        headers += _header(strings.field(name), 0, 0, len(data), at + len(raw), COPY)
        raw += data
    numbers = {section.name: number for number, section in enumerate(image.sections, 1)}
    symbols = b"".join(_symbol(symbol, numbers, strings) for symbol in image.symbols)
    flags = EXECUTABLE | LITTLE_ENDIAN | NO_RELOCATIONS
    symbols_at = at + len(raw)
    header = FILE_HEADER.pack(COFF2, count, 0, symbols_at, len(image.symbols), OPTIONAL_HEADER.size, flags, C28X)
    code_words = sum(section.size for section in image.code)
    optional = OPTIONAL_HEADER.pack(OPTIONAL_MAGIC, image.tool_version, code_words, 0, 0, image.entry, 0, 0)
    return header + optional + headers + raw + symbols + strings.table()


class _Strings:
    """The string table, for names longer than 8 characters."""

    def __init__(self) -> None:
        self._names = b""

    def field(self, name: str) -> bytes:
        """Return the 8 bytes of a name field: the name, or zero and its offset in the table."""
        raw = name.encode("latin-1")
        if len(raw) <= SHORT_NAME:
            return raw.ljust(SHORT_NAME, b"\0")
        place = 4 + len(self._names)
        self._names += raw + b"\0"
        return struct.pack("<II", 0, place)

    def table(self) -> bytes:
        return struct.pack("<I", 4 + len(self._names)) + self._names


def _contents(section: Section) -> bytes:
    return struct.pack(f"<{len(section.words)}H", *section.words)


def _flags(section: Section) -> int:
    if not section.loaded:
        return BSS
    return TEXT if section.code else DATA


def _header(name: bytes, run: int, load: int, size: int, raw: int, flags: int) -> bytes:
    return SECTION_HEADER.pack(name, run, load, size, raw, 0, 0, 0, 0, flags, 0, 0)


def _symbol(symbol: Symbol, numbers: dict[str, int], strings: _Strings) -> bytes:
    kind = LABEL if symbol.label else EXTERNAL if symbol.external else STATIC
    section = numbers[symbol.section] if symbol.section else ABSOLUTE
    return SYMBOL.pack(strings.field(symbol.name), symbol.address, section, 0, kind, 0)
