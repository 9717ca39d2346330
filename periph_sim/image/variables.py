"""Variables of an image by name: an image goes in; where each one is, how long it is and how to read it, comes out.

    x        as the debug data declare it, or 16 bits unsigned where only a symbol names it
    x-long   32 bits unsigned from there on, whatever it is

Names are those of C, and those of the symbol table (`_x`). Source: DWARF 3, sections 5.1 (base types) and 2.6.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

from elftools.dwarf.compileunit import CompileUnit
from elftools.dwarf.die import DIE
from msgspec import Struct

from ..core.suggest import did_you_mean
from .debug_info import DebugInfo, text_of
from .model import Image

LONG = "-long"  # no name in C has a hyphen
UNSIGNED, SIGNED, FLOAT = "unsigned", "signed", "float"
KINDS = {4: FLOAT, 5: SIGNED, 6: SIGNED}  # DW_ATE of the number's encoding; others are unsigned
THROUGH = ("DW_TAG_typedef", "DW_TAG_volatile_type", "DW_TAG_const_type")
DW_OP_ADDR = 3
WORDS = (1, 2)  # of numbers that an access of the CPU reads at once


class BadVariable(ValueError):
    """A name that is no variable of an image, or a value that it does not hold; one sentence."""


class Variable(Struct, frozen=True):
    """words: 16 bits each. kind: UNSIGNED, SIGNED or FLOAT."""

    name: str
    address: int
    words: int
    kind: str

    def value_of(self, bits: int) -> int:
        """The number that its bits are; of a float the bits themselves."""
        top = 1 << 16 * self.words - 1
        return (bits ^ top) - top if self.kind == SIGNED else bits

    def bits_of(self, value: float) -> int:
        """The bits of a number. BadVariable if it does not fit."""
        if self.kind == FLOAT:
            return int.from_bytes(struct.pack("<f", value), "little")
        if not isinstance(value, int):
            raise BadVariable(f"{self.name} is no float, so {value} does not fit; give a whole number")
        bits = 16 * self.words
        if not -(1 << bits - 1) <= value < 1 << bits:
            raise BadVariable(f"{self.name} has {bits} bits, so {value} does not fit")
        return value & (1 << bits) - 1


class Variables:
    """Those of one image."""

    def __init__(self, image: Image) -> None:
        code = {section.name for section in image.code}
        self._known: dict[str, Variable] = {
            symbol.name: Variable(symbol.name, symbol.address, 1, UNSIGNED)
            for symbol in image.symbols
            if symbol.section and symbol.section not in code
        }
        for told in DebugInfo(image).each(_declared):
            self._known[told.name] = told
            linked = f"_{told.name}"
            if linked in self._known:
                self._known[linked] = Variable(linked, told.address, told.words, told.kind)

    def find(self, name: str) -> Variable:
        """The variable of a name. BadVariable if there is none."""
        short = name.removesuffix(LONG)
        found = self._known.get(short)
        if found is None:
            raise BadVariable(f"the image has no variable {short!r}; {did_you_mean(short, self._known)}")
        return found if short == name else Variable(name, found.address, 2, UNSIGNED)


def _declared(dwarf: object, unit: CompileUnit) -> Iterator[Variable]:
    for entry in unit.get_top_DIE().iter_children():
        told = entry.attributes
        if entry.tag != "DW_TAG_variable" or "DW_AT_location" not in told or "DW_AT_type" not in told:
            continue
        location = told["DW_AT_location"].value
        if not isinstance(location, list) or len(location) < 5 or location[0] != DW_OP_ADDR:
            continue
        number = _number_type(entry)
        if number is not None and "DW_AT_name" in told:
            words, kind = number
            address = int.from_bytes(bytes(location[1:5]), "little")
            yield Variable(text_of(told["DW_AT_name"].value), address, words, kind)


def _number_type(entry: DIE) -> tuple[int, str] | None:
    """(words, kind) of a variable that is one number; None for arrays, structures and numbers of four words."""
    at = entry
    while at is entry or at.tag in THROUGH:
        if "DW_AT_type" not in at.attributes:
            return None
        at = at.get_DIE_from_attribute("DW_AT_type")
    if at.tag in ("DW_TAG_pointer_type", "DW_TAG_enumeration_type"):
        words, kind = at.attributes["DW_AT_byte_size"].value if "DW_AT_byte_size" in at.attributes else 2, UNSIGNED
    elif at.tag == "DW_TAG_base_type":
        words = at.attributes["DW_AT_byte_size"].value  # in characters, which have 16 bits
        kind = KINDS.get(at.attributes["DW_AT_encoding"].value, UNSIGNED)
    else:
        return None
    return (words, kind) if words in WORDS else None
