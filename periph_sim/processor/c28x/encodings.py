"""The instruction set as data: forms with their fields, read from `encodings.toml`, and the texts of operand fields.

    bits    1100110xllllllll cccccccccccccccc      first word first, most significant bit first
    fields  x = 0, l = 0x41, c = 0x00FF            in a given pair of words

A pattern of one word is matched against the upper half of (first word << 16 | second word), so a field has the same
position for either length.

Source: SPRU430F chapters 2, 4 to 6; SPRUEO2A. The head of `encodings.toml` explains its columns.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

WORD = 16
PAIR = 2 * WORD  # bits that a pattern is matched against
CYCLES_WHERE = re.compile(r"(\w) (&|=) (\w+): (\d+)")


class BitField(NamedTuple):
    """The position of a field within the two words, first word first."""

    shift: int
    mask: int  # at bit 0

    def of(self, pair: int) -> int:
        return pair >> self.shift & self.mask


@dataclass(frozen=True, eq=False, slots=True)
class Encoding:
    """One form of an instruction.

    mask, value: the fixed bits within the two words. bounds: values of fields that belong to the pattern.
    kind: core, fpu, c2xlp, c27x, emu or trap. alias_of: the form for which this is
    a fixed value of the operand field. also: another syntax of it, or "". shift_bias: the shift minus the
    value of field s. cycles: when executed alone. cycles_where: "y & 0x30: 2" or "k = 15: 4", those that apply if field
    y has any of these bits, or field k this value; or "". repeated: cycles of N + 1 executions after RPT,
    less N; 0 if not repeatable. latency: "2p" if the result is available one instruction later; "2p/1", "2p/2p"
    for the halves of a pair; else "". depends: status bits that change its effect. flags, op: its effect, for the
    tests of `execution`.
    """

    id: str
    mnemonic: str
    syntax: str
    also: str
    words: int
    mask: int
    value: int
    fields: Mapping[str, BitField]
    bounds: Mapping[str, range]
    kind: str
    alias_of: str
    shift_bias: int
    cycles: int
    not_taken: int
    cycles_where: str
    repeated: int
    latency: str
    flags: str
    depends: str
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    op: str

    def matches(self, pair: int) -> bool:
        """Return True if the words match this form; the second counts only if the form has two."""
        return pair & self.mask == self.value and all(
            self.fields[name].of(pair) in allowed for name, allowed in self.bounds.items()
        )

    def values(self, pair: int) -> dict[str, int]:
        """Return the value of each field."""
        return {name: place.of(pair) for name, place in self.fields.items()}

    def pair(self, values: Mapping[str, int]) -> int:
        """Return the two words with these field values; don't-care bits are 0."""
        pair = self.value
        for name, number in values.items():
            place = self.fields[name]
            if number & ~place.mask:
                raise ValueError(f"{number} does not fit field {name!r} of {self.id}, at most {place.mask}")
            pair |= number << place.shift
        return pair

    def cycles_of(self, values: Mapping[str, int]) -> tuple[int, int]:
        """Return cycles for these field values: (taken, not taken), equal if it is not a branch."""
        if where := CYCLES_WHERE.fullmatch(self.cycles_where):
            value, number = values[where[1]], int(where[3], 0)
            if value == number if where[2] == "=" else value & number:
                return int(where[4]), int(where[4])
        return self.cycles, self.not_taken

    @property
    def accesses(self) -> str:
        """The access at the address of its operand field: "", "r", "w" or "rw"."""
        read, written = (any(name in LOCATIONS for name in places(column)) for column in (self.reads, self.writes))
        return "r" * read + "w" * written


def places(column: Iterable[str]) -> list[str]:
    """Return the places of a column `reads` or `writes`, without their phases."""
    return [place.partition("@")[0] for place in column]


LOCATIONS = ("loc16", "loc32", "mem16", "mem32")


@cache
def encodings() -> tuple[Encoding, ...]:
    """Return every form, in the order of the table."""
    return read_table(resources.files(__package__).joinpath("encodings.toml").read_text(encoding="utf-8"))


def read_table(text: str) -> tuple[Encoding, ...]:
    """Parse every form of a table. Raise ValueError if a row has an unused column."""
    return tuple(_encoding(name, columns) for name, columns in tomllib.loads(text).items())


@cache
def by_id() -> dict[str, Encoding]:
    return {encoding.id: encoding for encoding in encodings()}


def _encoding(name: str, columns: dict[str, Any]) -> Encoding:
    """Return the form that a row of the table describes; the head of the table states the defaults."""
    take = columns.pop
    syntax, digits = take("syntax"), take("bits")
    bits = digits.ljust(PAIR, ".")
    cycles, repeated = take("cycles", 1), take("cycles_rpt", "N+0")
    bounds: dict[str, range] = {}
    if where := take("where", ""):  # "s >= 1" or "n <= 5"
        bounded, relation, number = where.split()
        bounds[bounded] = range(int(number), 1 << PAIR) if relation == ">=" else range(int(number) + 1)
    if not repeated.startswith("N+"):
        raise ValueError(f"{repeated!r} is not the cycles of N + 1 executions, such as 'N+1'")
    found = Encoding(
        id=name,
        mnemonic=syntax.partition(" ")[0],
        syntax=syntax,
        also=take("also", ""),
        words=len(digits) // WORD,
        mask=int("".join("01"[bit in "01"] for bit in bits), 2),
        value=int("".join("01"[bit == "1"] for bit in bits), 2),
        fields=_fields(bits),
        bounds=bounds,
        kind=take("class", "core"),
        alias_of=take("alias_of", ""),
        shift_bias=take("shift_bias", 0),
        cycles=cycles,
        not_taken=take("not_taken", cycles),
        cycles_where=take("cycles_where", ""),
        repeated=int(repeated[2:]),
        latency=take("latency", ""),
        flags=take("flags", ""),
        depends=take("depends", ""),
        reads=tuple(take("reads", ())),
        writes=tuple(take("writes", ())),
        op=take("op", ""),
    )
    if columns:
        unread = " and ".join(sorted(columns))
        raise ValueError(f"encodings.toml: {name}: no code reads {unread}; read the column, or make it a comment")
    if found.cycles_where and not CYCLES_WHERE.fullmatch(found.cycles_where):
        what = f"{found.cycles_where!r} is not a field condition with its cycles"
        raise ValueError(f"{what}, such as 'k = 15: 4'")
    return found


def _fields(bits: str) -> dict[str, BitField]:
    fields = {}
    for name in sorted(set(bits) - set("01.")):
        first, last = bits.index(name), bits.rindex(name)
        if bits[first : last + 1] != name * (last - first + 1):
            raise ValueError(f"field {name!r} of {bits} is in two pieces")
        fields[name] = BitField(PAIR - 1 - last, (1 << (last - first + 1)) - 1)
    return fields


WIDE = ("loc32", "mem32", "reg32")
REGISTERS = range(0xA0, 0xAE)
SP_FIELD = 0xAD  # @SP, which has no 32-bit meaning
DIRECT, STACK, INDEXED = range(0x40), range(0x40, 0x80), range(0xC0, 0x100)


@cache
def operand_texts(wide: bool) -> tuple[str, ...]:
    """Return the text of each value of an operand field. wide: the operand has 32 bits."""
    xar, words = range(8), range(0x40)
    # For ACC and P of 32 bits, the assembler emits the second one of two.
    named = ("@ACC", "@ACC", "@P", "@P", "@XT", "@SP") if wide else ("@AH", "@AL", "@PH", "@PL", "@T", "@SP")
    return (
        *(f"@{word:#x}" for word in words),
        *(f"*-SP[{word}]" for word in words),
        *(f"*XAR{n}++" for n in xar),
        *(f"*--XAR{n}" for n in xar),
        *(f"*+XAR{n}[AR0]" for n in xar),
        *(f"*+XAR{n}[AR1]" for n in xar),
        *(f"@XAR{n}" if wide else f"@AR{n}" for n in xar),
        *named,
        "*BR0++",
        "*BR0--",
        *(f"*,ARP{n}" for n in xar),
        *("*", "*++", "*--", "*0++", "*0--", "*SP++", "*--SP", "*AR6%++"),
        *(f"*+XAR{n}[{offset}]" for offset in xar for n in xar),
    )


def is_operand(kind: str, field: int) -> bool:
    """Return True if a field encodes an operand of this kind: loc16, loc32, mem16, mem32 or reg32 (32 bits).

    mem16 and mem32 are modes of memory only [SPRUEO2A Table 4-1].
    """
    if kind.startswith("mem"):
        return field not in REGISTERS
    if field == SP_FIELD and kind in WIDE:
        return False
    return kind != "reg32" or field in REGISTERS


@cache
def fixed_operands(wide: bool) -> dict[str, int]:
    """Return the field of every operand text without a number: registers and address register modes."""
    texts = operand_texts(wide)
    return {texts[field]: field for field in range(0x80, 0x100)} | {f"*XAR{n}": 0xC0 | n for n in range(8)}
