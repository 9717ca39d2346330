"""Variables of an image by name: address, length and number format.

    x               as declared in the debug data, or 16 bits unsigned if only a symbol names it
    x.member, x[3]  part of a structure or an array, as declared; one word if only a symbol names x
    0x9042          the word at an address
    x-long          32 bits unsigned at the address of x, whatever its type

Names are C names or those of the symbol table (`_x`). Source: DWARF 3, sections 5.1 (base types) and 2.6.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator

from elftools.dwarf.compileunit import CompileUnit
from elftools.dwarf.die import DIE
from msgspec import Struct

from ...core.suggest import did_you_mean
from ...f28335.memory.address_space import Content, area_at
from .debug_info import DebugInfo, text_of
from .model import Image
from .number_types import FLOAT, SIGNED, UNSIGNED, BadVariable, inside, members_of, number_type

LONG = "-long"  # no name in C has a hyphen
DW_OP_ADDR = 3
ADDRESS = re.compile(r"0x[0-9a-fA-F]{1,6}")
INDEX = re.compile(r"\[(\d{1,6})\]")


class Variable(Struct, frozen=True):
    """words: 16 bits each. kind: UNSIGNED, SIGNED or FLOAT."""

    name: str
    address: int
    words: int
    kind: str

    def value_of(self, bits: int) -> int:
        """Return the number that the bits represent; for a float the bits themselves."""
        top = 1 << 16 * self.words - 1
        return (bits ^ top) - top if self.kind == SIGNED else bits

    def bits_of(self, value: float) -> int:
        """Return the bits of a number. Raise BadVariable if it does not fit."""
        if self.kind == FLOAT:
            return int.from_bytes(struct.pack("<f", value), "little")
        if not isinstance(value, int):
            raise BadVariable(f"{self.name} is not a float, so {value} does not fit; give an integer")
        bits = 16 * self.words
        if not -(1 << bits - 1) <= value < 1 << bits:
            raise BadVariable(f"{self.name} has {bits} bits, so {value} does not fit")
        return value & (1 << bits) - 1


class Variables:
    """The variables of an image."""

    def __init__(self, image: Image) -> None:
        code = {section.name for section in image.code}
        self._known: dict[str, Variable] = {
            symbol.name: Variable(symbol.name, symbol.address, 1, UNSIGNED)
            for symbol in image.symbols
            if symbol.section and symbol.section not in code
        }
        self._types: dict[str, DIE] = {}
        self._debug = DebugInfo(image)  # reads types on demand
        for name, address, kind, number in self._debug.each(_declared):
            words, sign = number or (1, UNSIGNED)
            for known in (name, f"_{name}"):
                if known == name or known in self._known:
                    self._known[known] = Variable(known, address, words, sign)
                    self._types[known] = kind

    def find(self, name: str) -> Variable:
        """Return the variable with a name. Raise BadVariable if there is none."""
        short = name.removesuffix(LONG)
        found = self._found(short)
        area = area_at(found.address)
        if area is None or area.content is Content.REGISTERS:
            where = f"{name} is at {found.address:#06x}, which is not memory"
            raise BadVariable(f"{where}; write a register's field as MODULE.REGISTER.FIELD")
        return found if short == name else Variable(name, found.address, 2, UNSIGNED)

    def _found(self, name: str) -> Variable:
        if ADDRESS.fullmatch(name):
            return Variable(name, int(name, 16), 1, UNSIGNED)
        outer = name
        if name not in self._known:  # a symbol may contain such characters
            outer = re.split(r"[.\[]", name, maxsplit=1)[0]
        found, kind = self._known.get(outer), self._types.get(outer)
        if found is None:
            raise BadVariable(f"the image has no variable {outer!r}; {did_you_mean(outer, self._known)}")
        path = name[len(outer) :]
        if not path:
            return found
        if kind is None:
            index = INDEX.fullmatch(path)
            if index is None:
                way = _by_word(outer, found.address)
                raise BadVariable(f"the debug data do not describe {outer}, so {name!r} is unknown; {way}")
            return Variable(name, found.address + int(index[1]), 1, UNSIGNED)
        try:
            return _part(name, found, kind, path)
        except BadVariable:
            raise
        except Exception as error:  # the library raises many types for damaged data
            what = f"the debug data of {outer} cannot be read ({type(error).__name__})"
            raise BadVariable(f"{what}; {_by_word(outer, found.address)}") from None


def _part(name: str, outer: Variable, kind: DIE, path: str) -> Variable:
    """Return a member or element of a variable. Raise BadVariable if it is missing or not a number."""
    offset, inner = inside(kind, outer.name, path)
    number = number_type(inner)
    if number is None:
        parts = members_of(inner)
        way = f"give one of its members, {', '.join(parts)}" if parts else _by_word(name, outer.address + offset)
        raise BadVariable(f"{name} is not a number of 16 or 32 bits; {way}")
    return Variable(name, outer.address + offset, *number)


def _by_word(outer: str, address: int) -> str:
    return f"give the address of a word, for example 0x{address:04x} for {outer}"


def _declared(dwarf: object, unit: CompileUnit) -> Iterator[tuple[str, int, DIE, tuple[int, str] | None]]:
    """Yield variables at fixed addresses: name, address, type, and (words, sign) if it is a number."""
    for entry in unit.get_top_DIE().iter_children():
        attributes = entry.attributes
        if entry.tag != "DW_TAG_variable" or not {"DW_AT_location", "DW_AT_type", "DW_AT_name"} <= attributes.keys():
            continue
        location = attributes["DW_AT_location"].value
        if isinstance(location, list) and len(location) >= 5 and location[0] == DW_OP_ADDR:
            address = int.from_bytes(bytes(location[1:5]), "little")
            kind = entry.get_DIE_from_attribute("DW_AT_type")
            yield text_of(attributes["DW_AT_name"].value), address, kind, number_type(kind)
