"""The contents of a linker's output file of any format: sections, symbols, entry, debug data.

Addresses count words of 16 bits. Contents are loaded at `Section.address`; code copied at start-up runs at
`Section.run`; symbols and lines use run addresses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from ...core.shorten import shorten

LEAST_STACK = 15  # words that an interrupt pushes


LONGEST_NAME = 60


def quoted(name: str) -> str:
    """Quote and shorten a name from a file for messages; in a damaged file it may have any bytes and length."""
    return f"{shorten(name, LONGEST_NAME)!r}"


class BadImage(ValueError):
    """A file is not an image of this chip; the message is one sentence."""


@dataclass(frozen=True, eq=False)
class Section:
    """A section of an image.

    size: in words.
    words: the loaded contents; empty if memory is only reserved, or unused.
    allocated: True if the section occupies memory of the chip.
    code: True if it is marked as instructions.
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
        """True if start-up code copies it to its run address."""
        return self.address != self.run

    def runs_at(self, address: int) -> bool:
        return self.run <= address < self.run + self.size


@dataclass(frozen=True)
class Symbol:
    """Symbol of an image. label: True for a label inside a function that the compiler generated."""

    name: str
    address: int
    section: str
    external: bool = True
    label: bool = False


@dataclass(frozen=True, eq=False)
class Image:
    """A linked program.

    kind: "TI COFF2" or "ELF".
    initial: (address, words) that a loader writes into reserved memory.
    debug: the DWARF sections by name.
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
        """The address range of the stack, (begin, end); all of low memory if .stack is absent or too small."""
        of_stack = (one for one in self.sections if one.name == ".stack" and one.size >= LEAST_STACK)
        return next(((one.run, one.run + one.size) for one in of_stack), (0, 0xFFFF))

    @cached_property
    def symbol_at(self) -> dict[int, str]:
        """Names by address; functions are preferred to labels inside them."""
        named: dict[int, str] = {}
        for symbol in sorted(self.symbols, key=lambda symbol: (symbol.label, not symbol.external, symbol.name)):
            if symbol.section:
                named.setdefault(symbol.address, symbol.name)
        return named
