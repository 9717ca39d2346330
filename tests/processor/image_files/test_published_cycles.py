"""Calls of TI's library routines take the cycles that TI states. Skipped if the libraries are missing.

The formulas are those in the heads of the sources, "including the call and return". Heads of the FPU library count
cycles of the manual without stalls, as one of them says; those of IQmath corrected in 2002 (1.4) include stalls.

Routines are read from an archive of objects written by TI's tools; addresses are inserted and tables are linked:

    "!<arch>" | member: header 60, COFF2 object | ...        "//" holds names of more than 15 characters

Sources: SPRAAO8 (COFF2 objects; a relocation entry has 12 bytes), SPRU513 chapter 7 (archiver).
"""

from __future__ import annotations

import struct
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import pytest

from periph_sim.core.options import Value
from periph_sim.processor.image_files.assemble import assemble
from periph_sim.processor.image_files.coff2 import COPY, EXTERNAL, FILE_HEADER, SECTION_HEADER, SYMBOL
from periph_sim.processor.image_files.model import Section
from tests.processor.image.rig import HEAD, ended
from tests.processor.image_files.public_images import public_file

MAGIC, MEMBER_HEADER, NAMES = b"!<arch>\n", 60, "//"
RELOCATION = struct.Struct("<IIHH")


@dataclass(frozen=True)
class Routine:
    """The only loaded section of an object.

    binds: the symbol of each 22-bit address in it, by offset.
    """

    words: tuple[int, ...]
    binds: Mapping[int, str]
    defines: Mapping[str, int]

    def at(self, symbols: Mapping[str, int]) -> tuple[int, ...]:
        """Return its words with symbols at these addresses."""
        words = list(self.words)
        for offset, name in self.binds.items():
            address = symbols[name] + (words[offset] << 16 | words[offset + 1])  # the words hold an addend
            words[offset] = words[offset] & ~0x3F | address >> 16 & 0x3F
            words[offset + 1] = address & 0xFFFF
        return tuple(words)


def routines(library: Path) -> dict[str, Routine]:
    """Return each member of an archive by its name without the suffix."""
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


LIBRARIES = tomllib.loads(Path(__file__).with_name("public_libraries.toml").read_text(encoding="utf-8"))
CODE, ARRAYS, ZONE_6 = 0xB000, (0x8000, 0x8400, 0x8800), 0x10_0000  # memory without wait states, and with one
COUNTS = (8, 16, 32)
CALL = """
 MOVL XAR4,#0x8000
 MOVL XAR5,#0x8400
 MOVL XAR6,#0x8800
 ADDB SP,#2
 MOV @AL,#{pushed} & 0xFFFF
 MOV @AH,#{pushed} >> 16
 RPT #4 || NOP
 MOVL *-SP[2],ACC
 MOV @AL,#{acc} & 0xFFFF
 MOV @AH,#{acc} >> 16
 MOVIZ R0H,#0x3F80
 RPT #4 || NOP
 .align 2
"""


@cache
def library(name: str) -> dict[str, Routine]:
    return routines(public_file(name, LIBRARIES[name]))


def took(routine: Routine, acc: int, pushed: int, data: tuple[Section, ...], **options: Value) -> int:
    """Return the cycles of a call with these arguments, LCR and LRETR included."""
    words = routine.at(
        {name: data[0].run + at for name, at in library("iqmath")["IQmathTables"].defines.items()}
        if routine.binds
        else {}
    )
    code = Section("routine", CODE, CODE, len(words), words, code=True)

    def until(call: str) -> int:
        image = assemble(HEAD + CALL.format(acc=acc, pushed=pushed) + call + " ESTOP0\n")
        return ended(replace(image, sections=(*image.sections, code, *data)), skip=False, **options)

    return until(f" LCR #{CODE + min(routine.defines.values())}\n") - until("")


# FPU library: base + N * cycles of a loop pass ----------------------------------------------------------------------

NUMBERS = struct.unpack("<512H", struct.pack("<256f", *(1.5 + n for n in range(256))))
VECTORS = tuple(Section(f"array{at:x}", at, at, len(NUMBERS), NUMBERS) for at in ARRAYS)
FPU = {  # routine: cycles outside the loop, cycles per element, stalls and further cycles that the head omits
    "abs_SP_CV": (9, 28, 0, 4),  # the head of iabs_SP_CV, with the same instructions outside its loop, states 13
    "abs_SP_CV_2": (22, 18, 0, 0),
    "add_SP_CSxCV": (19, 4, 3, 0),  # MOVL XAR6,*-SP[4], MOV32 R0H,*XAR6++
    "add_SP_CVxCV": (15, 6, 0, 0),
    "iabs_SP_CV": (13, 25, 0, 0),
    "iabs_SP_CV_2": (22, 15, 0, 0),
    "mac_SP_CVxCV": (24, 5, 0, 1),
    "mac_SP_RVxCV": (28, 3, 0, 3),
    "mac_SP_i16RVxCV": (28, 3, 0, 5),
    "maxidx_SP_RV_2": (21, 3, 0, 0),
    "mean_SP_CV_2": (34, 2, 2, 0),  # MOV *SP++,AL, LSR, UI16TOF32 R1H,*--SP: "we'll take the stall"
    "mpy_SP_CSxCS": (19, 0, 0, 0),
    "mpy_SP_CVxCV": (16, 10, 0, 0),
    "mpy_SP_CVxCVC": (16, 11, 0, 0),
    "mpy_SP_RSxRV_2": (15, 2, 0, 0),
    "mpy_SP_RSxRVxRV_2": (22, 3, 0, 0),
    "mpy_SP_RVxCV": (15, 5, 0, 0),
    "mpy_SP_RVxRV_2": (17, 3, 0, 0),
    "rnd_SP_RS": (18, 0, 0, 1),
    "sub_SP_CSxCV": (19, 4, 3, 0),
    "sub_SP_CVxCV": (15, 6, 0, 0),
}


@pytest.mark.parametrize("name", FPU)
def test_a_routine_of_the_fpu_library(name: str):
    base, each, stalls, columns = FPU[name]
    for count in COUNTS:
        stated, counts = base + each * count, count << 16 | count
        assert took(library("fpu")[name], counts, ARRAYS[-1], VECTORS, stalls=False) == stated + columns
        assert took(library("fpu")[name], counts, ARRAYS[-1], VECTORS) == stated + columns + stalls


# IQmath: tables in memory without wait states, and with one ----------------------------------------------------------

CORRECTED = {  # routine: (ACC, cycles with tables in SARAM, in ROM)
    "IQ24rmpy": (0x100_0000, 16, 18),
    "IQ10rmpy": (0x100_0000, 17, 19),
    "IQ24rsmpy": (0x100_0000, 20, 26),
    "IQ10rsmpy": (0x10_0000, 21, 27),
    "IQ24div": (0x200_0000, 62, 70),
    "IQ24isqrt": (0x400_0000, 66, 73),  # 3 stalls, also below: MOVL XAR4,@ACC, MOVL XT,@XAR4
    "IQ10isqrt": (0x1000, 67, 74),
    "IQ24sqrt": (0x400_0000, 65, 69),
    "IQ22sqrt": (0x400_0000, 64, 68),
    "IQ10sqrt": (0x4000, 65, 69),
    "IQ24mag": (0x300_0000, 89, 93),
}
WITHOUT_TABLES = {"IQ24int": 15, "IQ24toF": 22}
COLUMNS = {  # routine: (ACC, cycles as stated, stalls and further cycles that the head omits)
    "IQ30sin": (0x1000_0000, 45, 3, 0),  # MOVL XAR5,*+XAR7[AR0], SUBL ACC,@XAR5
    "IQ24sin": (0x100_0000, 45, 3, 0),
    "IQ10sin": (0x1000, 46, 3, 0),
    "IQ24cos": (0x100_0000, 43, 2, 0),
    "IQ26cos": (0x100_0000, 44, 2, 0),
    "IQ24sinPU": (0x40_0000, 39, 3, 1),
    "IQ24cosPU": (0x40_0000, 37, 2, 1),
    "IQ24atan2": (0x80_0000, 109, 5, 0),
}


def tables(at: int) -> tuple[Section, ...]:
    words = library("iqmath")["IQmathTables"].words
    return (Section("IQmathTables", at, at, len(words), words),)


@pytest.mark.parametrize("name", CORRECTED)
def test_a_routine_of_iqmath_with_its_stalls(name: str):
    acc, in_ram, in_rom = CORRECTED[name]
    routine = library("iqmath")[name]
    assert took(routine, acc, 0x100_0000, tables(ARRAYS[0])) == in_ram
    assert took(routine, acc, 0x100_0000, tables(ZONE_6)) == in_rom


@pytest.mark.parametrize("name", WITHOUT_TABLES)
def test_a_routine_of_iqmath_without_tables(name: str):
    assert took(library("iqmath")[name], 0x180_0000, 0, ()) == WITHOUT_TABLES[name]


@pytest.mark.parametrize("name", COLUMNS)
def test_a_routine_of_iqmath_whose_head_counts_no_stalls(name: str):
    acc, stated, stalls, columns = COLUMNS[name]
    routine = library("iqmath")[name]
    assert took(routine, acc, 0x100_0000, tables(ARRAYS[0]), stalls=False) == stated + columns
    assert took(routine, acc, 0x100_0000, tables(ARRAYS[0])) == stated + columns + stalls


# Heads that describe another version, or are approximate ------------------------------------------------------------

REWRITTEN = {  # routine: (cycles stated, cycles of the code); their histories: "1.4d: re-implemented without branch"
    "IQ24frac": (18, 17),  # "Regs Used: XT, XAR7", neither of which the code uses
    "IQ24mpyI32int": (28, 22),  # "worst case", but the code has only one case
    "IQ24mpyI32frac": (34, 24),
}


@pytest.mark.parametrize("name", REWRITTEN)
def test_a_routine_whose_head_is_older_than_its_code(name: str):
    """Each instruction takes the manual's cycles without stalls: 9 + 8, 14 + 8 and 16 + 8 with LCR and LRETR."""
    stated, body = REWRITTEN[name]
    assert body < stated
    for acc in (0x80_0000, 0xFF80_0000):
        for stalls in (False, True):
            assert took(library("iqmath")[name], acc, 0xFFFF_FFFD, (), stalls=stalls) == body


def test_atan2_per_unit():
    """Its head states 121; the manual's cycles are 117, and 122 with the stalls, which IQ24atan2 has too.

    121 is 117 and a second cycle for each of the four MOV loc16,#16bit that follow the part shared with IQ24atan2.
    """
    routine = library("iqmath")["IQ24atan2PU"]
    assert took(routine, 0x80_0000, 0x100_0000, tables(ARRAYS[0]), stalls=False) == 117
    assert took(routine, 0x80_0000, 0x100_0000, tables(ARRAYS[0])) == 117 + 3 + 2  # @XAR6 after its load; SP, LRETR


ROUGH = {  # routine: cycles besides one per word; "~20 cycles of overhead (including the call and return)"
    "memcpy_fast": 19,  # LCR 4, ADDB 1, BF 4, MOVL 1, RPT @AL 4, PREAD N + 1, LRETR 4
    "memset_fast": 17,  # LCR 4, ADDB 1, BF 4, RPT @AH 4, MOV N, LRETR 4
}


@pytest.mark.parametrize("name", ROUGH)
@pytest.mark.parametrize("count", COUNTS)
def test_a_routine_that_fills_memory(name: str, count: int):
    acc = count if name == "memcpy_fast" else count << 16
    assert took(library("fpu")[name], acc, 0, VECTORS) == ROUGH[name] + count
