"""Types of variables, from debug data: a type and a path into it go in; offset, width and sign of a number come out.

TI's compilers count sizes and offsets in characters, which have 16 bits. Source: DWARF 3, sections 5.1 to 5.6.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from elftools.dwarf.die import DIE

from ..core.suggest import did_you_mean
from .debug_info import text_of

UNSIGNED, SIGNED, FLOAT = "unsigned", "signed", "float"
KINDS = {4: FLOAT, 5: SIGNED, 6: SIGNED}  # DW_ATE of the number's encoding; others are unsigned
FAR = "DW_TAG_lo_user"  # TI's qualifier `far`, 0x4080
THROUGH = ("DW_TAG_typedef", "DW_TAG_volatile_type", "DW_TAG_const_type", FAR)
OF_MEMBERS = ("DW_TAG_structure_type", "DW_TAG_union_type", "DW_TAG_class_type")
ARRAY = "DW_TAG_array_type"
WORDS = (1, 2)  # of numbers that an access of the CPU reads at once
DW_OP_PLUS_UCONST = 0x23
MOST_NAMES = 64  # and qualifiers of one type
STEP = re.compile(r"\.([^.\[]+)|\[(\d{1,6})\]")


class BadVariable(ValueError):
    """A name that is no variable of an image, or a value that it does not hold; one sentence."""


def number_type(kind: DIE) -> tuple[int, str] | None:
    """(words, sign) of a type that is one number; None for arrays, structures and numbers of four words."""
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
    """(words from its begin, type) of a part of a variable. path: ".member", "[3]", or several of them.

    BadVariable if it has no such part.
    """
    offset, at = 0, 0
    indices = 0  # that an array of several dimensions has taken
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
            raise BadVariable(f"{whole} is no array, so it has no element {step[0]}")
        sizes = _sizes(plain)
        element = plain.get_DIE_from_attribute("DW_AT_type")
        if not sizes or int(step[2]) >= sizes[indices]:
            least = f"{sizes[indices]} elements, from 0 on" if sizes else "no elements of a known number"
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
    """Names of a structure's members; none of any other type."""
    plain = _plain(kind)
    return [name for name, _ in _members(plain)] if plain is not None else []


def _plain(kind: DIE) -> DIE | None:
    """The type behind its names and qualifiers; None for `void`, and for damaged data that lead round in a circle."""
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
        raise BadVariable(f"{whole}.{name} is a bit-field; name the word that it is in by its address, as 0x9042")
    return found[name]


def _member(whole: str, plain: DIE | None, name: str) -> DIE:
    return _entry(whole, plain, name).get_DIE_from_attribute("DW_AT_type")


def _member_offset(whole: str, plain: DIE | None, name: str) -> int:
    """Words from the begin of the structure; of a union's members 0."""
    told = _entry(whole, plain, name).attributes.get("DW_AT_data_member_location")
    if told is None:
        return 0
    if isinstance(told.value, int):
        return told.value
    if not told.value or told.value[0] != DW_OP_PLUS_UCONST:
        raise BadVariable(f"{whole}.{name}: the debug data tell its place by an expression; name it by its address")
    offset = 0
    for place, byte in enumerate(told.value[1:]):
        offset |= (byte & 0x7F) << 7 * place
    return offset


def _sizes(array: DIE) -> list[int]:
    """How many elements each dimension has; none where one is open."""
    found = []
    for child in array.iter_children():
        if child.tag == "DW_TAG_subrange_type":
            told = child.attributes
            if "DW_AT_upper_bound" in told:
                found.append(told["DW_AT_upper_bound"].value + 1)
            elif "DW_AT_count" in told:
                found.append(told["DW_AT_count"].value)
            else:
                return []
    return found


def _words(kind: DIE) -> int:
    """Words of a type."""
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
    return 2  # a pointer: every other type that an array can be of tells its size
