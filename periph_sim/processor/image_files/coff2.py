"""TI COFF2 files (.out) as the C2000 linker writes them.

    file header 22 | optional header 28 | section headers 48 each | raw data | symbols 18 each | strings

The numbers are lengths in bytes. The *virtual* address in a section header is the load address, the *physical* address
is the run address.

Source: SPRAAO8. Two facts are not documented, but were found in linked images: which sections are loaded, and that the
size of a COPY section counts bytes if it is neither a text nor a data section.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import Any, NamedTuple

from .model import BadImage, Image, Section, Symbol, quoted

VERSIONS = {0xC0: "COFF0", 0xC1: "COFF1", 0xC2: "COFF2"}
COFF2 = 0xC2
C28X = 0x009D
TARGETS = {
    0x0092: "TMS320C1x, C2x, C2xx or C5x",
    0x0097: "TMS470",
    0x0098: "TMS320C54x",
    0x0099: "TMS320C6000",
    0x009C: "TMS320C55x",
    0x00A0: "MSP430",
    0x00A1: "TMS320C55x+",
}
EXECUTABLE = 0x0002

FILE_HEADER = struct.Struct("<HHiIIHHH")
OPTIONAL_HEADER = struct.Struct("<HHIIIIII")
SECTION_HEADER = struct.Struct("<8sIIIIIIIIIHH")
SYMBOL = struct.Struct("<8sIhHBB")

DSECT, NOLOAD, COPY, TEXT, DATA, BSS = 0x01, 0x02, 0x10, 0x20, 0x40, 0x80
LOADED_IF_NONE_OF = DSECT | NOLOAD | COPY | BSS

EXTERNAL, STATIC, LABEL = 2, 3, 6
SYMBOL_CLASSES = (EXTERNAL, STATIC, LABEL)


class SectionHeader(NamedTuple):
    """Header of a section.

    run, load: the run address (physical) and the load address (virtual).
    size: the number of words. For a COPY section other than text and data, it is the number of bytes.
    raw: the offset of the contents in the file; 0 if there are none.
    relocations: the number of relocations; 0 in a linked file.
    """

    name: str
    run: int
    load: int
    size: int
    raw: int
    relocations: int
    flags: int


def is_coff(data: bytes) -> bool:
    """Return True if the data begin like a TI COFF file of any version, for any processor."""
    return len(data) >= 2 and struct.unpack_from("<H", data)[0] in VERSIONS


def read(data: bytes) -> Image:
    """Return the image in the data of a COFF2 file for the C28x. Raise BadImage for data of any other kind."""
    version, section_count, _, symbols_at, symbol_count, optional, flags, target = _unpack(
        FILE_HEADER, data, 0, "header"
    )
    if version != COFF2 or target != C28X:
        named = TARGETS.get(target, f"target {target:#06x}") if version == COFF2 else "C24x or an older target"
        raise BadImage(f"it is {VERSIONS[version]} for {named}; the F28335 runs COFF2 for C28x; build it for that")
    if not flags & EXECUTABLE:
        raise BadImage("it is an object file or partly linked; link it into an executable .out")
    if optional != OPTIONAL_HEADER.size:
        raise BadImage(f"its optional header has {optional} bytes; an executable .out has {OPTIONAL_HEADER.size}")
    _, tool_version, *_, entry, _, _ = _unpack(OPTIONAL_HEADER, data, FILE_HEADER.size, "optional header")
    strings_at = symbols_at + SYMBOL.size * symbol_count if symbols_at else len(data)
    size = int.from_bytes(data[strings_at : strings_at + 4], "little")
    strings = _Strings(data[strings_at : strings_at + size])
    first = FILE_HEADER.size + optional
    headers = [_header(data, first + SECTION_HEADER.size * n, strings) for n in range(section_count)]
    return Image(
        kind="TI COFF2",
        entry=entry,
        sections=tuple(_section(header, data) for header in headers),
        symbols=tuple(_symbols(data, symbols_at, symbol_count, headers, strings)),
        initial=tuple(_initial(headers, data)),
        debug={
            header.name: _raw(header, data)
            for header in headers
            if header.name.startswith(".debug") and header.flags & COPY and header.raw
        },
        tool_version=tool_version,
    )


def _unpack(layout: struct.Struct, data: bytes, at: int, what: str) -> tuple[Any, ...]:
    if at + layout.size > len(data):
        raise BadImage(f"it is truncated: its {what} needs byte {at + layout.size - 1}, the file has {len(data)} bytes")
    return layout.unpack_from(data, at)


class _Strings:
    """The string table of a file, with the names longer than 8 characters. The table begins with its own size."""

    def __init__(self, table: bytes = bytes(4)) -> None:
        self._table = table

    def name(self, field: bytes) -> str:
        """Return the name that a field of 8 bytes contains, or to which it refers.

        The field is the name itself, or 4 bytes of 0 and the offset of a longer name in the table.
        """
        zero, offset = struct.unpack("<II", field)
        if zero or not offset:
            return field.rstrip(b"\0").decode("latin-1")
        end = self._table.find(b"\0", offset)
        if offset < 4 or end < 0:
            raise BadImage(f"it is truncated: a name is at byte {offset} of its string table of {len(self._table)}")
        return self._table[offset:end].decode("latin-1")

    def field(self, name: str) -> bytes:
        """Return the field of 8 bytes for a name, and add a long name to the table."""
        raw = name.encode("latin-1")
        if len(raw) <= SHORT_NAME:
            return raw.ljust(SHORT_NAME, b"\0")
        offset = len(self._table)
        self._table += raw + b"\0"
        return struct.pack("<II", 0, offset)

    @property
    def table(self) -> bytes:
        return struct.pack("<I", len(self._table)) + self._table[4:]


def _header(data: bytes, at: int, strings: _Strings) -> SectionHeader:
    name, run, load, size, raw, _, _, relocations, _, flags, _, _ = _unpack(SECTION_HEADER, data, at, "section table")
    return SectionHeader(strings.name(name), run, load, size, raw, relocations, flags)


def _raw(header: SectionHeader, data: bytes) -> bytes:
    counts_bytes = header.flags & COPY and not header.flags & (TEXT | DATA)
    end = header.raw + (header.size if counts_bytes else 2 * header.size)
    if end > len(data):
        raise BadImage(
            f"it is truncated: section {quoted(header.name)} ends at byte {end}, and the file has {len(data)}; "
            "fetch it again"
        )
    return data[header.raw : end]


def _section(header: SectionHeader, data: bytes) -> Section:
    if header.relocations:
        raise BadImage(
            f"section {quoted(header.name)} has relocations: it is partly linked; link it into an executable .out"
        )
    loaded = header.raw and header.size and not header.flags & LOADED_IF_NONE_OF
    raw = _raw(header, data) if loaded else b""
    return Section(
        name=header.name,
        address=header.load,
        run=header.run,
        size=header.size,
        words=_words(raw),
        allocated=bool(header.size) and not header.flags & (DSECT | NOLOAD | COPY),
        code=bool(header.flags & TEXT),
    )


def _initial(headers: list[SectionHeader], data: bytes) -> Iterator[tuple[int, tuple[int, ...]]]:
    """Yield (address, words) of each .cinit record that a loader applies, in programs linked with --ram_model.

    A record begins with a word that is a signed count; 0 ends the list. A positive count n is followed by one word with
    the address and n words with the values. A negative count -n is followed by two words with the address, the low word
    first, and n words with the values.
    """
    for header in headers:
        if header.name != ".cinit" or not header.size or header.flags & (COPY | DATA) != COPY | DATA:
            continue
        words = _words(_raw(header, data))
        at = 0
        while at < len(words) and words[at]:
            count = (words[at] ^ 0x8000) - 0x8000
            first = at + (2 if count > 0 else 3)
            at = first + abs(count)
            if at > len(words):
                raise BadImage("it is truncated: a record of .cinit ends after its section")
            yield words[first - 1] << 16 | words[first - 2] if count < 0 else words[first - 1], words[first:at]


def _words(raw: bytes) -> tuple[int, ...]:
    return struct.unpack(f"<{len(raw) // 2}H", raw)


def _symbols(data: bytes, at: int, count: int, headers: list[SectionHeader], strings: _Strings) -> list[Symbol]:
    found = []
    index = 0
    while index < count:
        name, value, section, _, kind, auxiliary = _unpack(SYMBOL, data, at + SYMBOL.size * index, "symbol table")
        index += 1 + auxiliary
        if kind not in SYMBOL_CLASSES or section == 0 or section < -1 or section > len(headers):
            continue
        where = headers[section - 1].name if section > 0 else ""
        text = strings.name(name)
        if text == where or text.startswith(f"{where}:"):
            continue  # the name of the section itself, or of the part of it that comes from one object file
        found.append(Symbol(text, value, where, kind == EXTERNAL, kind == LABEL))
    return found


LITTLE_ENDIAN, NO_RELOCATIONS = 0x0100, 0x0001
OPTIONAL_MAGIC = 0x0108
ABSOLUTE = -1
SHORT_NAME = 8
WORD32 = 0xFFFF_FFFF


def write(image: Image) -> bytes:
    """Return the bytes of a file with this image. Debug sections become COPY sections, whose size counts bytes.

    Values of symbols are written as 32 bits, also negative ones.
    """
    strings = _Strings()
    debug = list(image.debug.items())
    count = len(image.sections) + len(debug)
    at = FILE_HEADER.size + OPTIONAL_HEADER.size + SECTION_HEADER.size * count
    headers, raw = b"", b""
    for section in image.sections:
        data = struct.pack(f"<{len(section.words)}H", *section.words)
        place = at + len(raw) if data else 0
        flags = BSS if not section.loaded else TEXT if section.code else DATA
        headers += _header_of(strings.field(section.name), section.run, section.address, section.size, place, flags)
        raw += data
    for name, data in debug:
        headers += _header_of(strings.field(name), 0, 0, len(data), at + len(raw), COPY)
        raw += data
    numbers = {section.name: number for number, section in enumerate(image.sections, 1)}
    symbols = b""
    for symbol in image.symbols:
        kind = LABEL if symbol.label else EXTERNAL if symbol.external else STATIC
        number = numbers[symbol.section] if symbol.section else ABSOLUTE
        symbols += SYMBOL.pack(strings.field(symbol.name), symbol.address & WORD32, number, 0, kind, 0)
    flags = EXECUTABLE | LITTLE_ENDIAN | NO_RELOCATIONS
    symbols_at = at + len(raw)
    header = FILE_HEADER.pack(COFF2, count, 0, symbols_at, len(image.symbols), OPTIONAL_HEADER.size, flags, C28X)
    code_words = sum(section.size for section in image.code)
    optional = OPTIONAL_HEADER.pack(OPTIONAL_MAGIC, image.tool_version, code_words, 0, 0, image.entry & WORD32, 0, 0)
    return header + optional + headers + raw + symbols + strings.table


def _header_of(name: bytes, run: int, load: int, size: int, raw: int, flags: int) -> bytes:
    return SECTION_HEADER.pack(name, run, load, size, raw, 0, 0, 0, 0, flags, 0, 0)
