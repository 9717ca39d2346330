"""Addresses, on the chip, of the members of register structures, from the debug information of a library.

    extern volatile struct SCI_REGS SciaRegs --DWARF--> RegisterLayout: offset and size on the host --> Place

gcc and TI's compiler lay out a structure differently, because the sizes of their types differ. So each member has two
positions: its position on the host is in the debug information (DWARF); its position on the chip is computed from the
types. A member whose two positions cannot be matched is refused. Offsets on the host are bytes from the host address of
the chip's word 0.

Source: SPRU514Z sections 6.4 (sizes of types) and 7.1.7 (structures); SPRAC71B section 2.8 (bit fields: the access may
be narrower than the declared type; here it is always the 16-bit word with the field).
"""

from __future__ import annotations

import platform
import re
from math import prod
from pathlib import Path

from elftools.dwarf.compileunit import CompileUnit
from elftools.dwarf.die import DIE
from elftools.elf.elffile import ELFFile
from msgspec import Struct

from ...f28335.parts.f28335 import PART
from ..image_files.variables import QUALIFIERS, size_of, sizes_of, without_qualifiers

BYTES_A_WORD = 4  # number of bytes on the host for each word of the chip, the size of the host's unsigned int
IER, IFR = 0x0F00, 0x0F04  # addresses given to the CPU registers IER and IFR, which no module uses
VECTORS = range(0x0D00, 0x0E00)

SYMBOLS: dict[str, int] = {
    "IER": IER,
    "IFR": IFR,
    **{name: module.base + offset for module in PART.modules for name, offset in module.header.items()},
    "DevEmuRegs": 0x0880,
    "FlashRegs": 0x0A80,
    "CsmRegs": 0x0AE0,
    "AdcMirror": 0x0B00,
    "XintfRegs": 0x0B20,
    "PieVectTable": VECTORS.start,
    "DmaRegs": 0x1000,
    "McbspaRegs": 0x5000,
    "McbspbRegs": 0x5040,
    **{
        f"ECan{letter}{part}": base + offset
        for letter, base in (("a", 0x6000), ("b", 0x6200))
        for part, offset in (("Regs", 0), ("LAMRegs", 0x40), ("MOTSRegs", 0x80), ("MOTORegs", 0xC0), ("Mboxes", 0x100))
    },
    **{f"EPwm{number}Regs": 0x6800 + 0x40 * (number - 1) for number in range(1, 7)},
    **{f"ECap{number}Regs": 0x6A00 + 0x20 * (number - 1) for number in range(1, 7)},
    "EQep1Regs": 0x6B00,
    "EQep2Regs": 0x6B40,
    "AdcRegs": 0x7100,
}
# Symbols of code that start-up code copies to RAM. On the host they are 0, so nothing is copied.
COPIED = ("RamfuncsLoadStart", "RamfuncsLoadEnd", "RamfuncsRunStart", "RamfuncsLoadSize")


WORD = 16  # bits of a word of the chip
CHIP_BITS = {  # bits of a type on the chip; types that are not listed have 16
    **dict.fromkeys(("float", "long int", "long unsigned int"), 32),
    **dict.fromkeys(("double", "long double", "long long int", "long long unsigned int", "__int128"), 64),
}
FIXED_WIDTH = re.compile(r"u?int(?:_least|_fast)?(8|16|32|64)_t")
SIGNED = (5, 6)  # DWARF encodings of signed types: DW_ATE_signed, DW_ATE_signed_char
COMPOUND = ("DW_TAG_structure_type", "DW_TAG_union_type")
LARGEST = 8  # maximum number of bytes of an access
STORES_ARE_DECODED = platform.machine() == "x86_64"  # True if runtime.c can decode a store instruction of the host
NO_REGISTER = "no register has this type; declare 16 bits as unsigned int or uint16_t, 32 as unsigned long or uint32_t"


class BadLayout(ValueError):
    """Raised if a register structure has a member whose place on the chip is not known.

    The message is one sentence with the file and line of the member.
    """


class Place(Struct, frozen=True):
    """A number in a register structure, or a word with bit fields.

    at, size: its offset and number of bytes on the host.
    word, width: its address on the chip, and its bits there, 16 or 32.
    signed: True if the number on the host is the sign-extended number of the chip.
    partial: True if the word contains a bit field of less than 16 bits. A write of such a field begins with a read of
        the word.
    """

    at: int
    size: int
    word: int
    width: int
    signed: bool = False
    partial: bool = False


class RegisterLayout:
    """Places of all members of the structures in `SYMBOLS` that the sources use."""

    def __init__(self, library: Path) -> None:
        """Raise BadLayout if the place of a member on the chip is not certain."""
        self._numbers: dict[tuple[int, int], Place] = {}  # maps (offset, size) to a place that is no bit field
        self._fields: dict[int, Place] = {}  # maps the offset of a byte in a bit field to the place of the field
        # Maps the offset of adjacent bit fields to their total size in bytes. gcc announces a write of one of these
        # fields as a write of all.
        self._announced: dict[int, int] = {}
        self._path: list[DIE] = []  # the variable, then the members that lead to the present member
        with library.open("rb") as file:
            for unit in ELFFile(file).get_dwarf_info().iter_CUs():
                for die in unit.get_top_DIE().iter_children():
                    name = _name(die)
                    if die.tag == "DW_TAG_variable" and name in SYMBOLS and "DW_AT_type" in die.attributes:
                        self._path = [die]
                        self._add(die, BYTES_A_WORD * SYMBOLS[name], SYMBOLS[name])
        uncertain = any(map(self._is_ambiguous, self._numbers.values())) or max(self._announced.values(), default=0) > 2
        if uncertain and not STORES_ARE_DECODED:
            raise BadLayout(
                f"on a host of {platform.machine()} a bit field beside a number of its size, or fields of another "
                "word, cannot be followed; run C sources with such registers on x86_64"
            )

    def read(self, at: int, size: int) -> tuple[Place, ...]:
        """Return the places that a read of these bytes reads; an empty tuple if the bytes are no member."""
        number = self._numbers.get((at, size))
        if number is not None:
            return (number,)
        return self._words(at, size) if all(byte in self._fields for byte in range(at, at + size)) else ()

    def may_write(self, at: int, size: int) -> bool:
        """Return True if a write that gcc has announced for these bytes can be a write to a member."""
        return (at, size) in self._numbers or (size <= LARGEST and bool(self._words(at, size)))

    def announced(self, at: int, size: int) -> Place | None:
        """Return the place of a write that gcc has announced for these bytes.

        Return None if the announcement does not determine the place. Only `stored` can then find the place, from the
        store itself.
        """
        number, words = self._numbers.get((at, size)), self._words(at, size)
        if number is not None:
            return number if not words or not self._is_ambiguous(number) else None
        return words[0] if len(words) == 1 and size <= words[0].size else None

    def stored(self, announced: tuple[int, int], at: int, size: int) -> Place | None:
        """Return the place that a store writes; None if there is none.

        announced: offset and size of the bytes that gcc has announced.
        at, size: offset and size of the store. For a store to a bit field, `at` is the offset of the first byte of the
            field, and `size` is 0.
        """
        if (at, size) == announced and announced in self._numbers:
            return self._numbers[announced]
        place = self._fields.get(at)
        return place if place is not None and place.at <= at and at + size <= place.at + place.size else None

    def _is_ambiguous(self, number: Place) -> bool:
        """Return True if gcc may announce a write of bit fields like a write of this number.

        This is so if adjacent bit fields begin at the offset of the number and have at least its size, as in a union.

        number: a place that is no bit field.
        """
        return number.size <= self._announced.get(number.at, 0)

    def _add_field(self, place: Place, first: int, last: int) -> bool:
        """Add a bit field in the bytes `first` to `last`. Return False if a byte belongs to another word."""
        for byte in range(first, last + 1):
            here = self._fields.setdefault(byte, place)
            if (here.at, here.word) != (place.at, place.word):
                return False
            if place.partial:
                self._fields[byte] = place
        return True

    def _words(self, at: int, size: int) -> tuple[Place, ...]:
        return tuple(dict.fromkeys(self._fields[byte] for byte in range(at, at + size) if byte in self._fields))

    # Walk through the type of a variable ------------------------------------------------

    def _add(self, member: DIE, at: int, word: int) -> int:
        """Add a member that is no bit field, and return its number of words on the chip.

        at, word: the offset on the host and the address on the chip at which the member begins.
        """
        kind = _stripped(member)
        if kind.tag == "DW_TAG_array_type":
            words, stride = 0, size_of(_stripped(kind))
            for index in range(prod(sizes_of(kind) or (0,))):
                words += self._add(kind, at + index * stride, word + words)
            return words
        if kind.tag in COMPOUND:
            return self._add_compound(kind, at, word)
        bits = self._bits(member)
        place = Place(
            at, size_of(kind), word, bits, _value(kind, "DW_AT_encoding") in SIGNED and 8 * size_of(kind) > bits
        )
        if bits > 2 * WORD or place.size * WORD > BYTES_A_WORD * bits:
            raise self._refusal(NO_REGISTER)
        if self._numbers.setdefault((at, place.size), place) != place:
            raise self._refusal("another declaration of it has another type; keep one of them")
        return bits // WORD

    def _add_compound(self, compound: DIE, at: int, word: int) -> int:
        # bit, host_bit: the first bit after the members so far, on the chip and on the host.
        # begin: the first bit, on the host, of the adjacent bit fields that end at host_bit.
        bit = host_bit = longest = begin = 0
        for member in _members(compound):
            self._path.append(member)
            if compound.tag == "DW_TAG_union_type":
                bit = host_bit = begin = 0
            if "DW_AT_bit_size" in member.attributes:
                bit, host_bit = self._add_bit_field(member, at, word, bit, host_bit)
                run = at + begin // 8
                size = -(-(host_bit - begin) // WORD) * WORD // 8
                self._announced[run] = max(size, self._announced.get(run, 0))
            else:
                if bit % WORD:
                    raise self._refusal("bit fields before it end within a word; name all 16 bits of the word")
                offset, align = _value(member, "DW_AT_data_member_location"), self._alignment(member)
                first = -(-bit // WORD // align) * align
                if begin < host_bit and not self._is_certain(member, bit // WORD, host_bit):
                    raise self._refusal("unnamed bits may be before it; put the bit fields in a separate structure")
                bit = WORD * (first + self._add(member, at + offset, word + first))
                host_bit = begin = 8 * (offset + size_of(_stripped(member)))
            self._path.pop()
            longest = max(longest, bit)
        align = self._alignment_of_members(compound)
        return -(-longest // WORD // align) * align

    def _is_certain(self, member: DIE, word: int, host_bit: int) -> bool:
        """Return True if a member after bit fields has the same position with and without unnamed bits before it.

        The debug information does not list unnamed bits, so it is unknown whether there are any.

        word: the first word after these bit fields, in the structure on the chip.
        host_bit: the first bit after these bit fields, in the structure on the host.
        """
        offset, align = _value(member, "DW_AT_data_member_location"), self._alignment(member)
        host_align = _host_alignment(member)
        here, moved = (-(-bits // 8 // host_align) * host_align for bits in (host_bit, host_bit + 1))
        return offset == here and (offset != moved or -(-word // align) == -(-(word + 1) // align))

    def _add_bit_field(self, member: DIE, at: int, word: int, bit: int, host_bit: int) -> tuple[int, int]:
        """Add a bit field. Return the first bit after the field, on the chip and on the host.

        at, word: the offset on the host and the address on the chip at which the structure begins.
        bit, host_bit: the first bit after the members before this field, on the chip and on the host.

        DWARF does not list unnamed bits. A distance on the host that the alignment does not explain is a gap of
        unnamed bits.
        """
        width, bits = _value(member, "DW_AT_bit_size"), self._bits(member)
        if bits > 2 * WORD:
            raise self._refusal(NO_REGISTER)
        host = _value(member, "DW_AT_data_bit_offset")
        if host == _aligned(host_bit, width, 8 * size_of(_stripped(member))):
            first = _aligned(bit, width, bits)
        else:
            first = bit + host - host_bit
            if (first - 1) // WORD != bit // WORD:
                raise self._refusal("unnamed bits before it continue in another word; name them, word by word")
        last, host = first + width - 1, 8 * at + host
        host_last = host + width - 1
        if first // WORD != last // WORD or host // WORD != host_last // WORD or first % 8 != host % 8:
            raise self._refusal(
                f"with the fields before it, its {width} bits cross a 16-bit word; fill each word by itself"
            )
        place = Place(host // 8 - first % WORD // 8, 2, word + first // WORD, WORD, partial=width != WORD)
        if not self._add_field(place, host // 8, host_last // 8):
            raise self._refusal("another declaration of it has another place; keep one of them")
        return last + 1, host_last + 1 - 8 * at

    def _alignment(self, member: DIE) -> int:
        """Return the member's alignment on the chip, in words."""
        kind = _stripped(member)
        if kind.tag in COMPOUND:
            return self._alignment_of_members(kind)
        return self._alignment(kind) if kind.tag == "DW_TAG_array_type" else min(self._bits(member) // WORD, 2)

    def _alignment_of_members(self, compound: DIE) -> int:
        align = 1
        for member in _members(compound):
            self._path.append(member)
            align = max(align, self._alignment(member))
            self._path.pop()
        return align

    def _bits(self, member: DIE) -> int:
        """Return the number of bits that the numeric type of a member has on the chip."""
        kind, die = _stripped(member), member
        names = []  # the names of the typedefs in the declaration of the member
        while "DW_AT_type" in die.attributes and die.tag in (member.tag, "DW_TAG_typedef", *QUALIFIERS):
            die = die.get_DIE_from_attribute("DW_AT_type")
            if die.tag == "DW_TAG_typedef":
                names.append(_name(die))
        if kind.tag == "DW_TAG_pointer_type":
            return 2 * WORD
        bits = CHIP_BITS.get(_name(kind), WORD)
        for name in names:
            fixed = FIXED_WIDTH.fullmatch(name)
            if fixed and max(int(fixed[1]), WORD) != bits:
                if f"__{name}" not in names:  # glibc declares a type by a typedef of this name with __ in front
                    raise self._refusal(f"{name} is declared as {_name(kind)}, which has {bits} bits on the chip")
                return max(int(fixed[1]), WORD)
        return bits

    def _refusal(self, why: str) -> BadLayout:
        path = ".".join(filter(None, map(_name, self._path)))
        return BadLayout(f"{_declared_at(self._path[-1])}: {path} is not a register's: {why}")


def _aligned(bit: int, width: int, container: int) -> int:
    """Return the first bit of a bit field: `bit` if the field fits in its container, else the start of the next one.

    A container is a storage unit of the declared type. A bit field does not cross the end of a container.

    width: number of bits of the field.
    container: number of bits of a container.
    """
    return bit if bit % container + width <= container else -(-bit // container) * container


def _name(die: DIE) -> str:
    name = die.attributes.get("DW_AT_name")
    return "" if name is None else name.value.decode("utf-8", "replace")


def _value(die: DIE, attribute: str) -> int:
    found = die.attributes.get(attribute)
    return 0 if found is None else int(found.value)


def _members(compound: DIE) -> list[DIE]:
    return [die for die in compound.iter_children() if die.tag == "DW_TAG_member"]


def _stripped(member: DIE) -> DIE:
    """Return the type of a member or of array elements, without typedefs and qualifiers."""
    kind = without_qualifiers(member.get_DIE_from_attribute("DW_AT_type"))
    assert kind is not None, "a member has a type"
    return kind


def _host_alignment(member: DIE) -> int:
    """Return the member's alignment on the host, in bytes."""
    kind = _stripped(member)
    if kind.tag in COMPOUND:
        return max(map(_host_alignment, _members(kind)), default=1)
    return _host_alignment(kind) if kind.tag == "DW_TAG_array_type" else size_of(kind)


def _declared_at(member: DIE) -> str:
    """Return the place of a declaration as text, such as "DSP2833x_Gpio.h, line 31"; without a file if unknown."""
    assert isinstance(member.cu, CompileUnit)
    program = member.dwarfinfo.line_program_for_CU(member.cu)
    number, line = _value(member, "DW_AT_decl_file"), _value(member, "DW_AT_decl_line")
    if program is None:
        return f"line {line}"
    entry = program["file_entry"][number - (0 if program["version"] >= 5 else 1)]
    return f"{entry.name.decode('utf-8', 'replace')}, line {line}"
