"""Images: the contents of a linker's output file.

Addresses count words of 16 bits. The contents of a section are loaded at `Section.address`, and are used at
`Section.run`. Start-up code copies them if these addresses differ. Symbols and source lines have run addresses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from ...core.phrases import shorten

NO_STACK = (0, 0xFFFF)  # the range of the stack if it is unknown
LEAST_STACK = 15  # minimum number of words of a stack, because a single interrupt needs this number
LONGEST_NAME = 60  # maximum number of characters of a name in a message


def quoted(name: str) -> str:
    """Return a name from a file, quoted and shortened for a message. A name in a damaged file may have any length."""
    return f"{shorten(name, LONGEST_NAME)!r}"


class BadImage(ValueError):
    """Raised if a file is not an image of this chip. The message is one sentence."""


@dataclass(frozen=True, eq=False)
class Section:
    """A section of an image.

    address, run: its load address and its run address.
    size: its number of words.
    words: the contents that are loaded; empty if the section only reserves memory, or is not in memory.
    allocated: True if the section occupies memory of the chip.
    code: True if the section contains instructions.
    """

    name: str
    address: int
    run: int
    size: int
    words: Sequence[int] = ()
    allocated: bool = True
    code: bool = False

    @property
    def loaded(self) -> bool:
        return len(self.words) > 0

    @property
    def end(self) -> int:
        return self.address + self.size

    @property
    def copied(self) -> bool:
        """True if start-up code copies the section to its run address."""
        return self.address != self.run

    def runs_at(self, address: int) -> bool:
        return self.run <= address < self.run + self.size


@dataclass(frozen=True)
class Symbol:
    """A symbol of an image: the name of an address or of a number.

    address: the run address; for a symbol that names a number, the number.
    section: the name of the section that contains the address; "" for a symbol that names a number.
    external: True if the symbol is visible in other source files.
    label: True for a label inside a function, for example one that the compiler has generated.
    """

    name: str
    address: int
    section: str
    external: bool = True
    label: bool = False


@dataclass(frozen=True, eq=False)
class Image:
    """A linked program.

    kind: "TI COFF2", "ELF" or "assembled".
    entry: the address of the entry point.
    initial: for each block of initial values that a loader writes into reserved memory, (address, words).
    debug: for the name of each DWARF section, its contents.
    tool_version: the version of the linker; 0 if it is not known.
    """

    kind: str
    entry: int
    sections: tuple[Section, ...]
    symbols: tuple[Symbol, ...] = ()
    initial: tuple[tuple[int, Sequence[int]], ...] = ()
    debug: Mapping[str, bytes] = field(default_factory=dict)
    tool_version: int = 0

    @property
    def loaded(self) -> tuple[Section, ...]:
        return tuple(section for section in self.sections if section.loaded)

    @property
    def code(self) -> tuple[Section, ...]:
        return tuple(section for section in self.loaded if section.code)

    @property
    def stack(self) -> tuple[int, int]:
        """The address range of the section .stack, (start, end); NO_STACK if it is absent or too small."""
        of_stack = (one for one in self.sections if one.name == ".stack" and one.size >= LEAST_STACK)
        return next(((one.run, one.run + one.size) for one in of_stack), NO_STACK)

    @cached_property
    def symbol_at(self) -> dict[int, str]:
        """For each address with symbols, the name of one of them. Labels inside functions are the last choice."""
        named: dict[int, str] = {}
        for symbol in sorted(self.symbols, key=lambda symbol: (symbol.label, not symbol.external, symbol.name)):
            if symbol.section:
                named.setdefault(symbol.address, symbol.name)
        return named
