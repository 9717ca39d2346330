"""Types of variables in debug data: offset, width and sign of a number at a path such as ".member[3]".

TI's compilers count sizes and offsets in characters of 16 bits. Source: DWARF 3, sections 5.1 to 5.6.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from elftools.dwarf.die import DIE

from ...core.suggest import did_you_mean
from .debug_info import text_of

UNSIGNED, SIGNED, FLOAT = "unsigned", "signed", "float"
KINDS = {4: FLOAT, 5: SIGNED, 6: SIGNED}  # by DW_ATE encoding; others are unsigned
FAR = "DW_TAG_lo_user"  # TI's qualifier `far`, 0x4080
THROUGH = ("DW_TAG_typedef", "DW_TAG_volatile_type", "DW_TAG_const_type", FAR)
OF_MEMBERS = ("DW_TAG_structure_type", "DW_TAG_union_type", "DW_TAG_class_type")
ARRAY = "DW_TAG_array_type"
WORDS = (1, 2)  # of numbers that the CPU reads in one access
DW_OP_PLUS_UCONST = 0x23
MOST_NAMES = 64  # names and qualifiers of one type
STEP = re.compile(r"\.([^.\[]+)|\[(\d{1,6})\]")


class BadVariable(ValueError):
    """A name is not a variable of the image, or a value does not fit it; one sentence."""


def number_type(kind: DIE) -> tuple[int, str] | None:
    """Return (words, sign) of a numeric type; None for arrays, structures and numbers of four words."""
    at = _plain(kind)
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
    """Return (word offset, type) of a part of a variable. path: ".member", "[3]", or several of them.

    Raise BadVariable if the part does not exist.
    """
    offset, at = 0, 0
    indices = 0  # used so far of a multidimensional array
    while at < len(path):
        step = STEP.match(path, at)
        if step is None:
            raise BadVariable(f"{name + path!r}: {path[at:]!r} is neither a member, .NAME, nor an element, [NUMBER]")
        begin, at = at, step.end()
        whole, plain = name + path[:begin], _plain(kind)
        if step[1] is not None:
            offset, kind = offset + _member_offset(whole, plain, step[1]), _member(whole, plain, step[1])
            continue
        if plain is None or plain.tag != ARRAY:
            raise BadVariable(f"{whole} is not an array, so it has no element {step[0]}")
        sizes = _sizes(plain)
        element = plain.get_DIE_from_attribute("DW_AT_type")
        if not sizes or int(step[2]) >= sizes[indices]:
            least = f"{sizes[indices]} elements, from 0 on" if sizes else "an unknown number of elements"
            raise BadVariable(f"{name + path[:at]!r}: {whole} has {least}")
        stride = _words(element)
        for size in sizes[indices + 1 :]:
            stride *= size
        offset += int(step[2]) * stride
        indices += 1
        if indices == len(sizes):
            kind, indices = element, 0
    return offset, kind


def members_of(kind: DIE) -> list[str]:
    """Return the names of a structure's members; none for other types."""
    plain = _plain(kind)
    return [name for name, _ in _members(plain)] if plain is not None else []


def _plain(kind: DIE) -> DIE | None:
    """Resolve typedefs and qualifiers; None for `void`, and for damaged data with a cycle."""
    for _ in range(MOST_NAMES):
        if kind.tag not in THROUGH:
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


def _entry(whole: str, plain: DIE | None, name: str) -> DIE:
    found = dict(_members(plain)) if plain is not None else {}
    if not found:
        raise BadVariable(f"{whole} has no members, so none is called {name!r}")
    if name not in found:
        raise BadVariable(f"{whole} has no member {name!r}; {did_you_mean(name, found)}")
    if "DW_AT_bit_size" in found[name].attributes:
        raise BadVariable(f"{whole}.{name} is a bit-field; give the address of its word, for example 0x9042")
    return found[name]


def _member(whole: str, plain: DIE | None, name: str) -> DIE:
    return _entry(whole, plain, name).get_DIE_from_attribute("DW_AT_type")


def _member_offset(whole: str, plain: DIE | None, name: str) -> int:
    """Return the word offset of a member in a structure; 0 for a union."""
    location = _entry(whole, plain, name).attributes.get("DW_AT_data_member_location")
    if location is None:
        return 0
    if isinstance(location.value, int):
        return location.value
    if not location.value or location.value[0] != DW_OP_PLUS_UCONST:
        raise BadVariable(f"{whole}.{name}: the debug data give its offset as an expression; use its address")
    offset = 0
    for place, byte in enumerate(location.value[1:]):
        offset |= (byte & 0x7F) << 7 * place
    return offset


def _sizes(array: DIE) -> list[int]:
    """Return the number of elements of each dimension; an empty list if one is open."""
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


def _words(kind: DIE) -> int:
    """Return the size of a type in words."""
    plain = _plain(kind)
    if plain is None:
        return 0
    if "DW_AT_byte_size" in plain.attributes:
        return int(plain.attributes["DW_AT_byte_size"].value)
    if plain.tag == ARRAY:
        words = _words(plain.get_DIE_from_attribute("DW_AT_type"))
        for size in _sizes(plain):
            words *= size
        return words
    return 2  # a pointer: all other element types state their size
