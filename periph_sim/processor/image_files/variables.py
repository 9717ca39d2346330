"""Variables of an image by name: address, length and number format.

    x               a variable as declared in the debug data; an unsigned word if x is only in the symbol table
    x.member, x[3]  a part of a structure or an array, as declared; x[3] is an unsigned word if x is only in the symbol
                    table
    0x9042          the unsigned word at an address
    x-long          an unsigned number of 32 bits at the address of x, whatever the type of x

Names are C names, or those of the symbol table (`_x`). TI's compilers count sizes and offsets in words of 16 bits.
Source: DWARF 3, sections 5.1 to 5.6 (types) and 2.6.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from math import prod

from elftools.dwarf.compileunit import CompileUnit
from elftools.dwarf.die import DIE
from msgspec import Struct

from ...core.phrases import did_you_mean
from ...f28335.memory.address_space import Content, area_at
from .debug_info import DebugInfo, text_of
from .model import Image

UNSIGNED, SIGNED, FLOAT = "unsigned", "signed", "float"
KINDS = {4: FLOAT, 5: SIGNED, 6: SIGNED}  # for a DW_ATE encoding, the number format; all others are unsigned
FAR = "DW_TAG_lo_user"  # the name that the library gives to the tag 0x4080, TI's qualifier `far`
QUALIFIERS = ("DW_TAG_const_type", "DW_TAG_volatile_type", "DW_TAG_restrict_type", "DW_TAG_atomic_type", FAR)
OF_MEMBERS = ("DW_TAG_structure_type", "DW_TAG_union_type", "DW_TAG_class_type")
ARRAY = "DW_TAG_array_type"
WORDS = (1, 2)  # numbers of words that the CPU can read in one access
DW_OP_PLUS_UCONST = 0x23
MOST_NAMES = 64  # maximum number of typedefs and qualifiers around a type; more are a cycle in damaged data
STEP = re.compile(r"\.([^.\[]+)|\[(\d{1,6})\]")


class BadVariable(ValueError):
    """Raised if a name is no variable of the image, or if a value does not fit the variable.

    The message is one sentence.
    """


def number_type(kind: DIE) -> tuple[int, str] | None:
    """Return (number of words, number format) of a type; None if the type is no number of one or two words.

    The format is UNSIGNED, SIGNED or FLOAT.
    """
    at = without_qualifiers(kind)
    if at is None:
        return None
    if at.tag in ("DW_TAG_pointer_type", "DW_TAG_enumeration_type"):
        words, sign = at.attributes["DW_AT_byte_size"].value if "DW_AT_byte_size" in at.attributes else 2, UNSIGNED
    elif at.tag == "DW_TAG_base_type":
        words = at.attributes["DW_AT_byte_size"].value
        sign = KINDS.get(at.attributes["DW_AT_encoding"].value, UNSIGNED)
    else:
        return None
    return (words, sign) if words in WORDS else None


def inside(kind: DIE, name: str, path: str) -> tuple[int, DIE]:
    """Return (word offset, type) of a part of a variable. Raise BadVariable if it does not exist or is a bit field.

    kind, name: the type and the name of the variable. path: members and indices, such as ".member[3]".
    """
    offset, at = 0, 0
    indices = 0  # number of indices of the present, multidimensional array that have been processed
    while at < len(path):
        step = STEP.match(path, at)
        if step is None:
            raise BadVariable(f"{name + path!r}: {path[at:]!r} is neither a member, .NAME, nor an element, [NUMBER]")
        begin, at = at, step.end()
        whole, plain = name + path[:begin], without_qualifiers(kind)
        if step[1] is not None:
            more, kind = _member(whole, plain, step[1])
            offset += more
            continue
        if plain is None or plain.tag != ARRAY:
            raise BadVariable(f"{whole} is not an array, so it has no element {step[0]}")
        sizes = sizes_of(plain)
        element = plain.get_DIE_from_attribute("DW_AT_type")
        if not sizes or int(step[2]) >= sizes[indices]:
            least = f"{sizes[indices]} elements, from 0 on" if sizes else "an unknown number of elements"
            raise BadVariable(f"{name + path[:at]!r}: {whole} has {least}")
        offset += int(step[2]) * size_of(element) * prod(sizes[indices + 1 :])
        indices += 1
        if indices == len(sizes):
            kind, indices = element, 0
    return offset, kind


def members_of(kind: DIE) -> list[str]:
    """Return the names of the members of a structure, union or class; an empty list for a type without members."""
    plain = without_qualifiers(kind)
    return [name for name, _ in _members(plain)] if plain is not None else []


def without_qualifiers(kind: DIE) -> DIE | None:
    """Return a type without typedefs and qualifiers. Return None for `void`, and for a cycle in damaged debug data."""
    for _ in range(MOST_NAMES):
        if kind.tag != "DW_TAG_typedef" and kind.tag not in QUALIFIERS:
            return kind
        if "DW_AT_type" not in kind.attributes:
            return None
        kind = kind.get_DIE_from_attribute("DW_AT_type")
    return None


def _members(plain: DIE) -> Iterator[tuple[str, DIE]]:
    if plain.tag in OF_MEMBERS:
        for child in plain.iter_children():
            if child.tag == "DW_TAG_member" and {"DW_AT_name", "DW_AT_type"} <= child.attributes.keys():
                yield text_of(child.attributes["DW_AT_name"].value), child


def _member(whole: str, plain: DIE | None, name: str) -> tuple[int, DIE]:
    """Return (word offset, type) of a member of a structure; the offset is 0 in a union.

    whole, plain: the name and the type of the structure. name: the name of the member.
    """
    found = dict(_members(plain)) if plain is not None else {}
    if not found:
        raise BadVariable(f"{whole} has no members, so none is called {name!r}")
    if name not in found:
        raise BadVariable(f"{whole} has no member {name!r}; {did_you_mean(name, found)}")
    if "DW_AT_bit_size" in found[name].attributes:
        raise BadVariable(f"{whole}.{name} is a bit-field; give the address of its word, for example 0x9042")
    return _offset(f"{whole}.{name}", found[name]), found[name].get_DIE_from_attribute("DW_AT_type")


def _offset(member: str, entry: DIE) -> int:
    location = entry.attributes.get("DW_AT_data_member_location")
    if location is None:
        return 0
    if isinstance(location.value, int):
        return location.value
    if not location.value or location.value[0] != DW_OP_PLUS_UCONST:
        raise BadVariable(f"{member}: the debug data give its offset as an expression; use its address")
    offset = 0
    for place, byte in enumerate(location.value[1:]):
        offset |= (byte & 0x7F) << 7 * place
    return offset


def sizes_of(array: DIE) -> list[int]:
    """Return the number of elements in each dimension of an array; an empty list if one of them is not stated."""
    found = []
    for child in array.iter_children():
        if child.tag == "DW_TAG_subrange_type":
            attributes = child.attributes
            if "DW_AT_upper_bound" in attributes:
                found.append(attributes["DW_AT_upper_bound"].value + 1)
            elif "DW_AT_count" in attributes:
                found.append(attributes["DW_AT_count"].value)
            else:
                return []
    return found


def size_of(kind: DIE) -> int:
    """Return the size of a type: in words for an image, in bytes for a library of the host."""
    plain = without_qualifiers(kind)
    if plain is None:
        return 0
    if "DW_AT_byte_size" in plain.attributes:
        return int(plain.attributes["DW_AT_byte_size"].value)
    if plain.tag == ARRAY:
        return size_of(plain.get_DIE_from_attribute("DW_AT_type")) * prod(sizes_of(plain))
    return 2  # the type is a pointer, because all other types state their size


LONG = "-long"  # a name in C has no hyphen, so this suffix is unambiguous
DW_OP_ADDR = 3
ADDRESS = re.compile(r"0x[0-9a-fA-F]{1,6}")
INDEX = re.compile(r"\[(\d{1,6})\]")


class Variable(Struct, frozen=True):
    """A variable of an image. words: its number of words, 1 or 2. kind: its format: UNSIGNED, SIGNED or FLOAT."""

    name: str
    address: int
    words: int
    kind: str

    def value_of(self, bits: int) -> int:
        """Return the number that the bits represent. For a float, return the bits themselves."""
        top = 1 << 16 * self.words - 1
        return (bits ^ top) - top if self.kind == SIGNED else bits

    def bits_of(self, value: float) -> int:
        """Return the bits of a number. Raise BadVariable if the number does not fit the variable."""
        if self.kind == FLOAT:
            try:
                return int.from_bytes(struct.pack("<f", value), "little")
            except (OverflowError, struct.error):
                raise BadVariable(f"{self.name} is a float of 32 bits, so {value} does not fit") from None
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
        self._debug = DebugInfo(image)  # kept, because types are read from it when they are needed
        for name, address, kind in self._debug.each(_declared):
            for known in (name, f"_{name}"):
                if known == name or known in self._known:
                    self._known[known] = Variable(known, address, 1, UNSIGNED)
                    self._types[known] = kind

    def find(self, name: str) -> Variable:
        """Return the variable with a name. Raise BadVariable if there is none, or if it is not in memory.

        name: "x", "x.member", "x[3]", an address such as "0x9042", or one of these followed by "-long".
        """
        short = name.removesuffix(LONG)
        found = self._found(short, any_type=short != name)
        area = area_at(found.address)
        if area is None or area.content is Content.REGISTERS:
            where = f"{name} is at {found.address:#06x}, which is not memory"
            raise BadVariable(f"{where}; write a register's field as MODULE.REGISTER.FIELD")
        return found if short == name else Variable(name, found.address, 2, UNSIGNED)

    def _found(self, name: str, any_type: bool) -> Variable:
        """Return the variable with a name without "-long".

        any_type: if the type is no number of 16 or 32 bits, True to return the first word, False to raise BadVariable.
        """
        if ADDRESS.fullmatch(name):
            return Variable(name, int(name, 16), 1, UNSIGNED)
        outer = name
        if name not in self._known:  # the name of a symbol itself may contain "." or "["
            outer = re.split(r"[.\[]", name, maxsplit=1)[0]
        found, kind = self._known.get(outer), self._types.get(outer)
        if found is None:
            raise BadVariable(f"the image has no variable {outer!r}; {did_you_mean(outer, self._known)}")
        path = name[len(outer) :]
        if kind is None:
            if not path:
                return found
            index = INDEX.fullmatch(path)
            if index is None:
                way = _by_word(outer, found.address)
                raise BadVariable(f"the debug data do not describe {outer}, so {name!r} is unknown; {way}")
            return Variable(name, found.address + int(index[1]), 1, UNSIGNED)
        try:
            offset, inner = inside(kind, outer, path)
            number = number_type(inner)
            if number is None and not any_type:
                parts = members_of(inner)
                one = f"give one of its members, {', '.join(parts)}"
                way = one if parts else _by_word(name, found.address + offset)
                raise BadVariable(f"{name} is not a number of 16 or 32 bits; {way}")
            return Variable(name, found.address + offset, *(number or (1, UNSIGNED)))
        except BadVariable:
            raise
        except Exception as error:  # for damaged data, the library raises exceptions of many types
            what = f"the debug data of {outer} cannot be read ({type(error).__name__})"
            raise BadVariable(f"{what}; {_by_word(outer, found.address)}") from None


def _by_word(outer: str, address: int) -> str:
    return f"give the address of a word, for example 0x{address:04x} for {outer}"


def _declared(dwarf: object, unit: CompileUnit) -> Iterator[tuple[str, int, DIE]]:
    """Yield (name, address, type) of each variable at a fixed address."""
    for entry in unit.get_top_DIE().iter_children():
        attributes = entry.attributes
        if entry.tag != "DW_TAG_variable" or not {"DW_AT_location", "DW_AT_type", "DW_AT_name"} <= attributes.keys():
            continue
        location = attributes["DW_AT_location"].value
        if isinstance(location, list) and len(location) >= 5 and location[0] == DW_OP_ADDR:
            address = int.from_bytes(bytes(location[1:5]), "little")
            yield text_of(attributes["DW_AT_name"].value), address, entry.get_DIE_from_attribute("DW_AT_type")
