"""Assemble a program: source text goes in; an image comes out, whose sections stand where the source says.

            .sect   ".text", 0x8000      ; name, address; a third number: where it is loaded, if not there
    _main:  MOVW    DP, #0x7900 >> 6
            MOV     @0x7909, #0x4600     ; of an address the operand takes its word within the data page
    wait:   TBIT    @0x7902, #4
            SB      wait, NTC
            RPT     #9 || NOP
            LRETR
            .reserve ".stack", 0x400, 0x300

.word and .long put numbers, .string characters, .space words of 0; NAME .set EXPRESSION names a number; .align 2 begins
at an even address; .entry NAME says where the program begins, else at `_c_int00`. .global NAME makes a label a function
or a variable; other labels are places inside one. One pass finds addresses, one words.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ..c28x.assembler import BadInstruction, Parsed, parse
from ..c28x.expressions import BadExpression, Undefined, evaluate
from .load import parse as parse_image
from .model import BadImage, Image, Section, Symbol
from .write_coff2 import write

ENTRY = "_c_int00"
LABEL = re.compile(r"([A-Za-z_$][\w.$]*)\s*:\s*(.*)")
SETS = re.compile(r"([A-Za-z_$][\w.$]*)\s+\.set\s+(.+)", re.IGNORECASE)
NOP = 0x7700
MOST_WORDS = 0x40_0000  # of a section: program space


@dataclass
class _Block:
    """A section in the making. pieces: what puts words at an address, with the line of source that says so."""

    name: str
    address: int
    load: int
    at: int
    pieces: list[tuple[int, int, Callable[[int, Mapping[str, int]], tuple[int, ...]]]] = field(default_factory=list)
    has_code: bool = False


class _Source:
    """The first pass: lines go in; sections with their pieces, and symbols, are kept."""

    def __init__(self) -> None:
        self.blocks: list[_Block] = []
        self.reserved: list[Section] = []
        self.symbols: dict[str, int] = {}
        self.sections: dict[str, str] = {}  # of symbols: the section, "" for numbers
        self.globals: set[str] = set()
        self.entry = ENTRY

    @property
    def here(self) -> _Block:
        if not self.blocks:
            raise BadInstruction("no section has begun; say .sect NAME, ADDRESS first")
        return self.blocks[-1]

    def define(self, name: str, value: int, section: str) -> None:
        if name in self.symbols:
            raise BadInstruction(f"{name!r} is defined twice")
        self.symbols[name] = value
        self.sections[name] = section

    def number(self, text: str) -> int:
        return evaluate(text, self.symbols, self.blocks[-1].at if self.blocks else 0)

    def line(self, number: int, text: str) -> None:
        """One line without its comment."""
        sets = SETS.fullmatch(text)
        if sets:
            self.define(sets[1], self.number(sets[2]), "")
            return
        labelled = LABEL.fullmatch(text)
        if labelled:
            self.define(labelled[1], self.here.at, self.here.name)
            text = labelled[2]
        text = text.removeprefix("||").strip()
        if text.startswith("."):
            directive, _, rest = text.partition(" ")
            self._directive(number, directive.lower(), rest.strip())
        elif text:
            self._instructions(number, text)

    def _instructions(self, number: int, text: str) -> None:
        repeat, bars, repeated = text.partition("||")
        for one in (repeat, repeated) if bars and repeat.upper().startswith("RPT ") else (text,):
            parsed: Parsed = parse(one, self.here.at, self.symbols)
            self._put(number, parsed.encoding.words, parsed.words)
            self.here.has_code = True

    def _put(self, number: int, words: int, put: Callable[[int, Mapping[str, int]], tuple[int, ...]]) -> None:
        block = self.here
        block.pieces.append((number, block.at, put))
        block.at += words
        if block.at - block.address > MOST_WORDS:
            raise BadInstruction(f"section {block.name!r} has more than {MOST_WORDS} words")

    def _directive(self, number: int, directive: str, rest: str) -> None:
        if directive in (".sect", ".reserve"):
            name, *numbers = _operands(rest)
            places = [self.number(one) for one in numbers]
            wanted = (1, 2) if directive == ".sect" else (2,)
            if not re.fullmatch(r'"[^"]+"', name) or len(places) not in wanted or min(places) < 0:
                usage = (
                    '.sect "NAME", ADDRESS [, LOAD ADDRESS]' if wanted[0] == 1 else '.reserve "NAME", ADDRESS, WORDS'
                )
                raise BadInstruction(f"{directive} {rest} is not {usage}")
            self._section(directive, name.strip('"'), places)
        elif directive == ".entry":
            self.entry = rest
        elif directive in (".word", ".long", ".string"):
            self._data(number, directive, rest)
        elif directive == ".space":
            self._put(number, (count := self._count(rest)), lambda at, symbols: (0,) * count)
        elif directive == ".align":
            size = max(1, self._count(rest))
            fill = -self.here.at % size
            self._put(number, fill, lambda at, symbols: (NOP,) * fill)
        elif directive in (".global", ".def"):
            self.globals.update(_operands(rest))
        else:
            raise BadInstruction(f"there is no directive {directive!r}")

    def _count(self, rest: str) -> int:
        count = self.number(rest)
        if not 0 <= count <= MOST_WORDS:
            raise BadInstruction(f"{rest!r} is {count}, no number of words")
        return count

    def _section(self, directive: str, name: str, places: list[int]) -> None:
        if any(block.name == name for block in self.blocks) or any(one.name == name for one in self.reserved):
            raise BadInstruction(f"section {name!r} has begun already")
        if directive == ".sect":
            self.blocks.append(_Block(name, places[0], places[-1], places[0]))
        else:
            self.reserved.append(Section(name, places[0], places[0], places[1]))

    def _data(self, number: int, directive: str, rest: str) -> None:
        for operand in _operands(rest):
            if directive == ".string":
                if not re.fullmatch(r'"[^"]*"', operand):
                    raise BadInstruction(f"{operand} is no text in double quotes")
                characters = tuple(operand[1:-1].encode("latin-1", "replace"))
                self._put(number, len(characters), lambda at, symbols, put=characters: put)  # type: ignore[misc]
            else:
                count = 2 if directive == ".long" else 1
                self._put(number, count, _number_of(operand, count))


def _number_of(operand: str, count: int) -> Callable[[int, Mapping[str, int]], tuple[int, ...]]:
    def put(at: int, symbols: Mapping[str, int]) -> tuple[int, ...]:
        value = evaluate(operand, symbols, at)
        if not -(1 << 16 * count - 1) <= value < 1 << 16 * count:
            raise BadInstruction(f"{operand!r} is {value}, which {16 * count} bits do not hold")
        return (value & 0xFFFF, value >> 16 & 0xFFFF)[:count]

    return put


def _operands(text: str) -> list[str]:
    """Separated by commas outside of quotes."""
    return [one.strip() for one in re.findall(r'(?:"[^"]*"|[^,"])+', text)] or [""]


def assemble(text: str) -> Image:
    """The image of a program. BadImage with the line where it is none."""
    source = _Source()
    for number, line in enumerate(text.splitlines(), 1):
        with _Line(number):
            source.line(number, _without_comment(line).strip())
    sections = []
    for block in source.blocks:
        words: list[int] = []
        for number, at, put in block.pieces:
            with _Line(number):
                words += put(at, source.symbols)
        sections.append(Section(block.name, block.load, block.address, len(words), tuple(words), code=block.has_code))
    if source.entry not in source.symbols:
        raise BadImage(f"its entry {source.entry!r} is not defined; define it, or name another one with .entry")
    for name in sorted(source.globals - source.symbols.keys()):
        raise BadImage(f"{name!r} is .global, but not defined")
    named = source.globals | {source.entry}
    symbols = tuple(
        Symbol(name, address, source.sections[name], name in named, bool(source.sections[name]) and name not in named)
        for name, address in source.symbols.items()
    )
    return Image("assembled", source.symbols[source.entry], (*sections, *source.reserved), symbols)


def _without_comment(line: str) -> str:
    return re.sub(r'((?:"[^"]*"|\'.\'|[^;"])*);.*', r"\1", line)


class _Line:
    """Says in which line of the source something is wrong."""

    def __init__(self, number: int) -> None:
        self._number = number

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        if isinstance(error, BadInstruction | BadExpression | Undefined):
            raise BadImage(f"line {self._number}: {error}") from None


def assemble_file(path: Path) -> tuple[Image, bytes]:
    """The image of a source file, and the bytes of its .out. BadImage, which names the file, where it is none."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise BadImage(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise BadImage(f"{path}: it is no text in UTF-8") from None
    try:
        data = write(assemble(text))
        return parse_image(data), data
    except BadImage as error:
        raise BadImage(f"{path}: {error}") from None
