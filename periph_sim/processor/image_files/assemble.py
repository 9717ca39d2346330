"""An assembler for C28x source text. No linker is needed, because the source states the address of each section.

            .sect   ".text", 0x8000      ; name and run address; a third operand is the load address, if that differs
    _main:  MOVW    DP, #0x7900 >> 6
            MOV     @0x7909, #0x4600     ; the operand contains the offset of the address in its data page
    wait:   TBIT    @0x7902, #4
            SB      wait, NTC
            RPT     #9 || NOP
            LRETR
            .reserve ".stack", 0x400, 0x300

.word and .long store numbers, .string stores characters, .space stores words of 0, .reserve reserves words. NAME .set
EXPRESSION defines a name for a number. .align 2 aligns to an even address. .entry NAME sets the entry point, which is
`_c_int00` by default. .global NAME makes a label a function or a variable; other labels are local to their function.
.include "FILE" inserts the lines of a file in the same folder, or of a file that is shipped with periph_sim. The first
pass over the source assigns addresses, the second pass emits words.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from ...core.examples import EXAMPLES
from ...core.input_files import read_input, similar_file
from ..c28x.assembler import Parsed, evaluate, parse
from ..c28x.operands import BadInstruction
from .coff2 import write
from .load import parse as parse_image
from .model import BadImage, Image, Section, Symbol

ENTRY = "_c_int00"
MOST_INCLUDES = 8  # largest nesting depth of .include
LABEL = re.compile(r"([A-Za-z_$][\w.$]*)\s*:\s*(.*)")
SETS = re.compile(r"([A-Za-z_$][\w.$]*)\s+\.set\s+(.+)", re.IGNORECASE)
INCLUDES = re.compile(r'\s*(?:[A-Za-z_$][\w.$]*\s*:)?[\s|]*\.include\s+"([^"]+)"', re.IGNORECASE)
COMMENT = re.compile(r'((?:"[^"]*"|\'.\'|[^;"])*);.*')
SHIPPED = EXAMPLES / "firmware" / "c28x"
USAGE = {".sect": ((1, 2), '"NAME", ADDRESS [, LOAD ADDRESS]'), ".reserve": ((2,), '"NAME", ADDRESS, WORDS')}
NOP = 0x7700
MOST_WORDS = 0x40_0000  # maximum number of words of a section: the size of program space


class _Place(NamedTuple):
    """A source line. path: the path of its file. included: the name of its file; "" for the main source."""

    path: str
    line: int
    included: str

    def __str__(self) -> str:
        return f"{self.included}, line {self.line}".removeprefix(", ")


NOWHERE = _Place("", 0, "")


@dataclass
class _Block:
    """A section that is being assembled.

    address, load: its run address and its load address.
    at: the run address of the next piece.
    pieces: for each piece of the section, its source line, its run address, and the function that returns its words for
        this address and the values of all symbols.
    """

    name: str
    address: int
    load: int
    at: int
    pieces: list[tuple[_Place, int, Callable[[int, Mapping[str, int]], tuple[int, ...]]]] = field(default_factory=list)
    has_code: bool = False


class _Source:
    """The first pass over the source lines, which collects the symbols, and the sections with their pieces.

    blocks, reserved: the sections with contents, and those that only reserve memory.
    symbols: for each symbol, its value.
    sections: for each symbol, the name of its section; "" for a symbol that .set defines.
    globals: for each name that .global states, the source line of .global.
    entry: the name of the entry point.
    entry_line: the line of .entry; NOWHERE if there is none.
    """

    def __init__(self, folder: Path) -> None:
        self._folders = [folder]  # the folders of the main source and of the files in .include, the innermost last
        self._place = NOWHERE
        self.blocks: list[_Block] = []
        self.reserved: list[Section] = []
        self.symbols: dict[str, int] = {}
        self.sections: dict[str, str] = {}
        self.globals: dict[str, _Place] = {}
        self.entry = ENTRY
        self.entry_line = NOWHERE

    @property
    def here(self) -> _Block:
        if not self.blocks:
            raise BadInstruction("no section is open; write .sect NAME, ADDRESS first")
        return self.blocks[-1]

    def define(self, name: str, value: int, section: str) -> None:
        if name in self.symbols:
            raise BadInstruction(f"{name!r} is defined twice")
        _latin_1(name)
        self.symbols[name] = value
        self.sections[name] = section

    def number(self, text: str) -> int:
        return evaluate(text, self.symbols, self.blocks[-1].at if self.blocks else 0)

    def text(self, text: str, path: str, included: str = "") -> None:
        """Process all lines of a file.

        text: the contents of the file. path: its path. included: its name; "" for the main source.
        """
        for number, line in enumerate(text.splitlines(), 1):
            outer, self._place = self._place, _Place(path, number, included)
            with _errors_at(self._place):
                self._line(re.sub(COMMENT, r"\1", line).strip())
            self._place = outer

    def _line(self, text: str) -> None:
        if sets := SETS.fullmatch(text):
            self.define(sets[1], _checked(self.number(sets[2]), sets[2], 32), "")
            return
        if labelled := LABEL.fullmatch(text):
            self.define(labelled[1], self.here.at, self.here.name)
            text = labelled[2]
        text = text.removeprefix("||").strip()
        if text.startswith("."):
            directive, _, rest = text.partition(" ")
            self._directive(directive.lower(), rest.strip())
            return
        repeat, bars, repeated = text.partition("||")
        for one in (repeat, repeated) if bars and repeat.upper().startswith("RPT ") else (text,) if text else ():
            parsed: Parsed = parse(one, self.here.at, self.symbols)
            self._put(parsed.encoding.words, parsed.words)
            self.here.has_code = True

    def _put(self, words: int, put: Callable[[int, Mapping[str, int]], tuple[int, ...]]) -> None:
        block = self.here
        block.pieces.append((self._place, block.at, put))
        block.at += words
        if block.at - block.address > MOST_WORDS:
            raise BadInstruction(f"section {block.name!r} has more than {MOST_WORDS} words")

    def _directive(self, directive: str, rest: str) -> None:
        if directive in USAGE:
            name, *numbers = _operands(rest)
            places = [_checked(self.number(one), one, 32) for one in numbers]
            wanted, usage = USAGE[directive]
            if not re.fullmatch(r'"[^"]+"', name) or len(places) not in wanted or min(places) < 0:
                raise BadInstruction(f"{directive} {rest} is not {directive} {usage}")
            _latin_1(name := name.strip('"'))
            if any(block.name == name for block in self.blocks) or any(one.name == name for one in self.reserved):
                raise BadInstruction(f"section {name!r} is defined twice")
            if directive == ".sect":
                self.blocks.append(_Block(name, places[0], places[-1], places[0]))
            else:
                self.reserved.append(Section(name, places[0], places[0], places[1]))
        elif directive == ".entry":
            self.entry, self.entry_line = rest, self._place
        elif directive == ".include":
            self._include(rest)
        elif directive == ".string":
            for operand in _operands(rest):
                if not re.fullmatch(r'"[^"]*"', operand):
                    raise BadInstruction(f"{operand} is not a text in double quotes")
                characters = tuple(_latin_1(operand[1:-1]))
                self._put(len(characters), lambda at, symbols, put=characters: put)  # type: ignore[misc]
        elif directive in (".word", ".long"):
            count = 2 if directive == ".long" else 1
            for operand in _operands(rest):
                self._put(count, _number_of(operand, count))
        elif directive == ".space":
            self._put((count := self._count(rest)), lambda at, symbols: (0,) * count)
        elif directive == ".align":
            size = max(1, self._count(rest))
            fill = -self.here.at % size
            self._put(fill, lambda at, symbols: (NOP,) * fill)
        elif directive in (".global", ".def"):
            self.globals |= dict.fromkeys(_operands(rest), self._place)
        else:
            raise BadInstruction(f"there is no directive {directive!r}")

    def _include(self, rest: str) -> None:
        if not re.fullmatch(r'"[^"]+"', rest):
            raise BadInstruction(f'.include {rest} is not .include "FILE"')
        if len(self._folders) > MOST_INCLUDES:
            raise BadInstruction(f"{rest}: .include is nested more than {MOST_INCLUDES} deep")
        path = included(rest.strip('"'), self._folders[-1])
        text = text_of(path)
        self._folders.append(path.parent)
        self.text(text, str(path), path.name)
        self._folders.pop()

    def _count(self, rest: str) -> int:
        count = self.number(rest)
        if not 0 <= count <= MOST_WORDS:
            raise BadInstruction(f"{rest!r} is {count}, which is not a valid number of words")
        return count


def _number_of(operand: str, count: int) -> Callable[[int, Mapping[str, int]], tuple[int, ...]]:
    def put(at: int, symbols: Mapping[str, int]) -> tuple[int, ...]:
        value = _checked(evaluate(operand, symbols, at), operand, 16 * count)
        return (value & 0xFFFF, value >> 16 & 0xFFFF)[:count]

    return put


def _checked(value: int, operand: str, bits: int) -> int:
    """Return the value of an operand. Raise BadInstruction if it does not fit this number of bits."""
    if not -(1 << bits - 1) <= value < 1 << bits:
        raise BadInstruction(f"{operand!r} is {value}, which does not fit {bits} bits")
    return value


def _latin_1(text: str) -> bytes:
    """Return the bytes of a text. Raise BadInstruction for a character that is not in Latin-1."""
    try:
        return text.encode("latin-1")
    except UnicodeEncodeError as error:
        raise BadInstruction(f"{text!r} has the character {text[error.start]!r}, which is not in Latin-1") from None


def _operands(text: str) -> list[str]:
    """Split a text at commas outside of quotes."""
    return [one.strip() for one in re.findall(r'(?:"[^"]*"|[^,"])+', text)] or [""]


def assemble(text: str, path: Path | None = None) -> Image:
    """Return the image of a program. Raise BadImage for an error, with the source line if there is one.

    text: the source text.
    path: the path of the source, for the debug data. Included files are searched in its folder. If it is None, the
        image has no debug data.
    """
    source = _Source(Path() if path is None else path.parent)
    source.text(text, str(path))
    sections = []
    for block in source.blocks:
        words: list[int] = []
        for place, at, put in block.pieces:
            with _errors_at(place):
                words += put(at, source.symbols)
        sections.append(Section(block.name, block.load, block.address, len(words), tuple(words), code=block.has_code))
    if source.entry not in source.symbols:
        if source.entry_line is not NOWHERE:
            raise BadImage(f"{source.entry_line}: the entry {source.entry!r} is not defined")
        raise BadImage(f"its entry {source.entry!r} is not defined; define it, or set another one with .entry")
    for name, place in source.globals.items():
        if name not in source.symbols:
            raise BadImage(f"{place}: {name!r} is .global, but not defined")
    named = {*source.globals, source.entry}
    symbols = tuple(
        Symbol(name, address, source.sections[name], name in named, bool(source.sections[name]) and name not in named)
        for name, address in source.symbols.items()
    )
    debug: dict[str, bytes] = {}
    if path is not None:
        coded = (([(at, *place[:2]) for place, at, _ in one.pieces], one.at) for one in source.blocks if one.has_code)
        debug = debug_sections(str(path), tuple(coded))
    return Image("assembled", source.symbols[source.entry], (*sections, *source.reserved), symbols, debug=debug)


def sources_of(path: Path) -> list[Path]:
    """Return a source file and all files that it includes. Raise BadImage if a file is missing."""
    found = [path]
    for source in found:
        names = (match[1] for match in map(INCLUDES.match, text_of(source).splitlines()) if match)
        found += [one for one in (included(name, source.parent) for name in names) if one not in found]
    return found


@contextmanager
def _errors_at(place: _Place) -> Iterator[None]:
    """Convert a BadInstruction, raised within the `with` block, to BadImage with this source line."""
    try:
        yield
    except BadInstruction as error:
        raise BadImage(f"{place}: {error}") from None


def included(name: str, folder: Path) -> Path:
    """Return the path of a file: in this folder, or, if it does not exist there, among those shipped with periph_sim.

    If it exists nowhere, return the path in this folder.
    """
    shipped = SHIPPED / name
    return shipped if not (folder / name).exists() and shipped.is_file() else folder / name


def text_of(path: Path) -> str:
    try:
        return read_input(path).decode("utf-8-sig")
    except OSError as error:
        hint = similar_file(path) or "give a source in assembly"
        raise BadImage(f"{path}: {error.strerror}; {hint}") from None
    except UnicodeDecodeError:
        raise BadImage(f"{path}: it is not UTF-8 text") from None


def assemble_file(path: Path) -> tuple[Image, bytes]:
    """Return the image of a source file, and the bytes of its .out file. Raise BadImage with the path for an error.

    If the folder has no such file, use the program of this name that is shipped with periph_sim. If the folder does not
    exist, its name may be mistyped, so a shipped program is then used only if the last two parts of the folder's path
    are those of the folder of shipped programs.
    """
    folder = path.parent
    is_there = folder.is_dir() or folder.parts[-2:] == SHIPPED.parts[-2:]
    text = text_of(included(path.name, folder) if is_there else path)
    try:
        data = write(assemble(text, path))
        return parse_image(data), data
    except BadImage as error:
        raise BadImage(f"{path}: {error}") from None


# Source lines are written as DWARF debug data, which `debug_info` reads.
# Source: DWARF 2, sections 6.2 (line program), 7.5 (abbreviations and entries).

VERSION = 2
ADDRESS_BYTES = 4
COMPILE_UNIT = 0x11
NAME, STMT_LIST, LANGUAGE, PRODUCER = 0x03, 0x10, 0x13, 0x25  # codes of DWARF attributes, DW_AT_...
STRING, DATA2, DATA4 = 0x08, 0x05, 0x06  # codes of DWARF forms, DW_FORM_...
ASSEMBLER = 0x8001  # the language code DW_LANG_Mips_Assembler, which assemblers for other processors use, too
COPY, ADVANCE_PC, ADVANCE_LINE, SET_FILE = 1, 2, 3, 4  # standard opcodes of a DWARF line program, DW_LNS_...
END_SEQUENCE, SET_ADDRESS = 1, 2  # extended opcodes of a DWARF line program, DW_LNE_...
OPERANDS = bytes((0, 1, 1, 1, 1, 0, 0, 0, 1))  # number of operands of each of the standard opcodes 1 to 9

Row = tuple[int, str, int]  # address, file and line of a piece


def debug_sections(file: str, sequences: Sequence[tuple[Sequence[Row], int]]) -> dict[str, bytes]:
    """Return the contents of the DWARF sections for the source lines, by the names of the sections.

    file: the path of the main source.
    sequences: for each section of code, its rows in ascending order of addresses, and the address after its end.
    """
    abbreviation = bytes(
        (1, COMPILE_UNIT, 0, NAME, STRING, STMT_LIST, DATA4, LANGUAGE, DATA2, PRODUCER, STRING, 0, 0, 0)
    )
    unit = b"\1" + _text(file) + struct.pack("<IH", 0, ASSEMBLER) + _text("periph-sim assemble")
    head = struct.pack("<HIB", VERSION, 0, ADDRESS_BYTES)
    numbers = {file: 1}
    program = b""
    for rows, end in sequences:
        at, line = rows[0][0], 1
        program += bytes((0, 1 + ADDRESS_BYTES, SET_ADDRESS)) + struct.pack("<I", at)
        for address, source, number in rows:
            place = numbers.setdefault(source, len(numbers) + 1)
            program += bytes((SET_FILE,)) + _leb(place) + _advance(address - at)
            program += bytes((ADVANCE_LINE,)) + _leb(number - line) + bytes((COPY,))
            at, line = address, number
        program += _advance(end - at) + bytes((0, 1, END_SEQUENCE))
    names = b"".join(_text(name) + b"\0\0\0" for name in numbers)  # folder, time and length are 0
    files = b"\0" + names + b"\0"
    rest = struct.pack("<BBbBB", 1, 1, -5, 14, len(OPERANDS) + 1) + OPERANDS + files
    return {
        ".debug_abbrev": abbreviation,
        ".debug_info": _sized(head + unit),
        ".debug_line": _sized(struct.pack("<HI", VERSION, len(rest)) + rest + program),
    }


def _advance(words: int) -> bytes:
    return bytes((ADVANCE_PC,)) + _leb(words)


def _sized(data: bytes) -> bytes:
    return struct.pack("<I", len(data)) + data


def _text(text: str) -> bytes:
    return text.encode("utf-8", "replace") + b"\0"


def _leb(number: int) -> bytes:
    """Return a number as signed LEB128: seven bits in each byte; bit 6 of the last byte is the sign.

    For numbers from 0 on, the result can also be read as unsigned LEB128.
    """
    coded = bytearray()
    while True:
        number, low = number >> 7, number & 0x7F
        done = number == (-1 if low & 0x40 else 0)
        coded.append(low | (0 if done else 0x80))
        if done:
            return bytes(coded)
