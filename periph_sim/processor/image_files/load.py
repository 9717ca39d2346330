"""Images: the contents of a linker's output file, checked for the F28335.

Addresses count words of 16 bits. The contents of a section are loaded at `Section.address`. Start-up code may copy them
to `Section.run`, where they are used. Symbols and source lines have run addresses.

`parse` checks that no two loaded sections overlap, that each is in loadable memory, and that the entry is in loaded
code. Reserved memory, and the run addresses of copied code, may overlap on purpose, by UNION in the linker's command
file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations, pairwise
from pathlib import Path

from ...core.input_files import read_input
from ...core.phrases import shorten
from ...f28335.descriptor import Part
from ...f28335.memory.address_space import Content, area_at, not_loadable
from ...f28335.parts.f28335 import PART

OTHER_PART = "a part with a CLA (F2803x, F2806x or F2837x)"  # such an image has sections with names in Cla1...
ELF_MAGIC = b"\x7fELF"
WAY_OUT = "give the linker's .out file, or assembly (.asm)"
LARGEST = 1 << 28  # most bytes of a file; most of them would be debug data
SOURCE = ".asm"


def program_in(path: Path) -> Image:
    """Load an image from a file, or assemble a source. Raise BadImage, with the path, if there is no F28335 image."""
    if path.suffix != SOURCE:
        return load(path)
    from .assemble import assemble_file  # imported only for sources, because the import is slow

    return assemble_file(path)[0]


def load(path: Path) -> Image:
    """Load an image from a file. Raise BadImage, with the path, if it is not an F28335 image."""
    try:
        data = read_input(path, LARGEST)
    except OSError as error:
        raise BadImage(f"{path}: {error.strerror}; {WAY_OUT}") from None
    try:
        return parse(data)
    except BadImage as error:
        raise BadImage(f"{path}: {error}") from None


def parse(data: bytes) -> Image:
    """Return the image in the bytes of a file. Raise BadImage if it is not an F28335 image."""
    from . import coff2  # imported here, because it imports this module

    if coff2.is_coff(data):
        image = coff2.read(data)
    elif data.startswith(ELF_MAGIC):
        from . import elf  # imported only for ELF files, because it imports a library

        image = elf.read(data)
    else:
        raise BadImage(f"it is neither TI COFF nor ELF; {WAY_OUT}")
    for section in image.sections:
        if section.name.startswith("Cla1") and section.size:
            raise BadImage(f"section {quoted(section.name)} belongs to {OTHER_PART}, not to the F28335")
    loaded = sorted(image.loaded, key=lambda section: section.address)
    if not loaded:
        raise BadImage("it has no loaded section, so there is nothing to run")
    require_loadable(image, PART)
    for before, after in pairwise(loaded):
        if after.address < before.end:
            raise BadImage(
                f"sections {quoted(before.name)} and {quoted(after.name)} overlap at {after.address:#08x}; "
                "each word can be loaded once"
            )
    if not any(section.address <= image.entry < section.end for section in image.code):
        raise BadImage(f"its entry {image.entry:#08x} is not in a loaded code section; link it with an entry point")
    return image


def require_loadable(image: Image, part: Part) -> None:
    """Raise BadImage if a section is in memory that this part does not have, or that cannot be loaded."""
    named = [(f"section {quoted(one.name)} lies", one) for one in image.loaded]
    placed = [(what, address, one.size) for what, one in named for address in (one.address, one.run)]
    placed += [(f".cinit initialises {len(words)} words", address, len(words)) for address, words in image.initial]
    for what, address, size in placed:
        why = not_loadable(address, size, part)
        if why:
            raise BadImage(f"{what} {why}")


def shared_memory(image: Image) -> list[str]:
    """Return a sentence about each pair of sections that overlap in RAM."""
    placed = [section for section in image.sections if section.allocated and section.size]
    in_ram = [one for one in placed if (area := area_at(one.run)) is not None and area.content is Content.RAM]
    notes = []
    for one, other in combinations(sorted(in_ram, key=lambda section: section.run), 2):
        end = min(one.run + one.size, other.run + other.size)
        if other.run < end:
            notes.append(
                f"sections {one.name} and {other.name} share {other.run:#08x} to {end - 1:#08x}: "
                "unless this is a UNION in the linker's command file, one overwrites the other"
            )
    return notes


LEAST_STACK = 15  # smallest number of words of a stack; an interrupt needs that many


LONGEST_NAME = 60


def quoted(name: str) -> str:
    """Return a name from a file, quoted and shortened for a message. In a damaged file it may be of any length."""
    return f"{shorten(name, LONGEST_NAME)!r}"


class BadImage(ValueError):
    """A file is not an image of this chip; the message is one sentence."""


@dataclass(frozen=True, eq=False)
class Section:
    """A section of an image.

    address, run: its load address and its run address.
    size: its number of words.
    words: the loaded contents; empty if the section only reserves memory, or is not in memory.
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
    """Symbol of an image.

    address: its run address, or the value of a number.
    section: the name of its section; "" for a number.
    external: True if the symbol is visible in other source files.
    label: True for a label inside a function, which the compiler has generated.
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
    initial: (address, words) of the initial values that a loader writes into reserved memory.
    debug: a dictionary from the name of a DWARF section to its contents.
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
        """The address range of the stack, (begin, end); (0, 0xFFFF) if .stack is absent or too small."""
        of_stack = (one for one in self.sections if one.name == ".stack" and one.size >= LEAST_STACK)
        return next(((one.run, one.run + one.size) for one in of_stack), (0, 0xFFFF))

    @cached_property
    def symbol_at(self) -> dict[int, str]:
        """A dictionary from an address to a symbol; symbols of functions are preferred to labels inside functions."""
        named: dict[int, str] = {}
        for symbol in sorted(self.symbols, key=lambda symbol: (symbol.label, not symbol.external, symbol.name)):
            if symbol.section:
                named.setdefault(symbol.address, symbol.name)
        return named
