"""What a linker's output file holds, whatever its format: sections, symbols, entry, debug data.

Addresses count words of 16 bits. Contents are loaded at `Section.address`; code that start-up copies elsewhere runs at
`Section.run`, and symbols and lines carry run addresses.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from ..core.shorten import shorten

LEAST_STACK = 15  # words that an interrupt takes


LONGEST_NAME = 60


def quoted(name: str) -> str:
    """A name of a file as a message shows it: a damaged one may have any bytes, and any length."""
    return f"{shorten(name, LONGEST_NAME)!r}"


class BadImage(ValueError):
    """A file that is no image of this chip, in one sentence."""


@dataclass(frozen=True, eq=False)
class Section:
    """size: in words. words: contents that are loaded; empty where memory is only reserved, or nothing is.

    allocated: it has its place in the chip's memory. code: it is marked as instructions.
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
        """Start-up code moves it to where it runs."""
        return self.address != self.run

    def runs_at(self, address: int) -> bool:
        return self.run <= address < self.run + self.size


@dataclass(frozen=True)
class Symbol:
    """label: a place inside a function that the compiler named."""

    name: str
    address: int
    section: str
    external: bool = True
    label: bool = False


@dataclass(frozen=True, eq=False)
class Image:
    """kind: "TI COFF2" or "ELF". initial: what a loader writes into reserved memory, as (address, words).

    debug: DWARF sections by name. tool_version: of the linker, 0 where nothing says it.
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
        """From where to where SP may point; anywhere if no section says it, or too small a one."""
        of_stack = (one for one in self.sections if one.name == ".stack" and one.size >= LEAST_STACK)
        return next(((one.run, one.run + one.size) for one in of_stack), (0, 0xFFFF))

    @cached_property
    def symbol_at(self) -> dict[int, str]:
        """The name of each address that has one; a function's rather than a label's inside one."""
        named: dict[int, str] = {}
        for symbol in sorted(self.symbols, key=lambda symbol: (symbol.label, not symbol.external, symbol.name)):
            if symbol.section:
                named.setdefault(symbol.address, symbol.name)
        return named

    def words_at(self, address: int, count: int) -> Iterator[int]:
        """Words that are loaded from an address on, up to the end of their section."""
        for section in self.loaded:
            if section.address <= address < section.end:
                start = address - section.address
                yield from section.words[start : start + count]
                return

    def symbol(self, name: str) -> Symbol | None:
        return next((symbol for symbol in self.symbols if symbol.name == name), None)
