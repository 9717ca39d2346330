"""The instruction set as data: the forms of `encodings.toml` with their fields, and the operand texts of field l.

A form is one encoding of an instruction, with one syntax of its operands. Each letter of its bits is a field:

    bits    1100110xllllllll cccccccccccccccc      first word first, most significant bit first
    fields  x = 0, l = 0x41, c = 0x00FF            in a given pair of words

Words are matched as a pair, first word << 16 | second word. The pattern of a form of one word covers the upper half of
the pair.

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
PAIR = 2 * WORD  # number of bits of a pair of words
CYCLES_WHERE = re.compile(r"(\w) (&|=) (\w+): (\d+)")


class BitField(NamedTuple):
    """The position of a field in a pair of words: the field is `pair >> shift & mask`."""

    shift: int
    mask: int

    def of(self, pair: int) -> int:
        return pair >> self.shift & self.mask


@dataclass(frozen=True, eq=False, slots=True)
class Encoding:
    """One form of an instruction.

    also: a second syntax of the form, or "".
    words: the number of words, 1 or 2.
    mask, value: a pair of words matches the form if pair & mask == value. The fixed bits are 1 in the mask.
    fields: for the letter of each field, its position.
    bounds: for the letter of a field whose values are limited, the allowed values. Words with other values belong to
        another form.
    kind: the class of the instruction: core, fpu, c2xlp, c27x, emu (for emulators) or trap.
    alias_of: the id of a more general form that encodes the same words; "" if this form is no alias.
    cycles: the cycles of one execution; for a conditional jump, call or return, the cycles if it is taken.
    not_taken: the cycles of a conditional jump, call or return that is not taken; otherwise equal to `cycles`.
    cycles_where: a condition on a field, and the cycles if it is true. "y & 0x30: 2" means 2 cycles if field y has any
        of the bits 0x30, "k = 15: 4" means 4 cycles if field k is 15. "" if the cycles do not depend on a field.
    repeated: R if RPT #N makes the CPU execute the instruction N + 1 times in N + R cycles; 0 if the instruction cannot
        be repeated.
    latency: "2p" if the FPU writes the result only after the next instruction; "" if it is written at once. For two
        parallel instructions, the latency of each: "2p/1" or "2p/2p".
    depends: the status bits on which the effect depends, as a text.
    reads, writes: the names of the registers and memory that are read and written. A name may end with the phase of the
        pipeline: "SP@D2".
    flags: the flags that are written, as a text.
    op: the effect, as a text. Tests compare `flags` and `op` with the functions of `execution`.
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
        """Return True if a pair of words matches this form. A form of one word ignores the second word."""
        return pair & self.mask == self.value and all(
            self.fields[name].of(pair) in allowed for name, allowed in self.bounds.items()
        )

    def values(self, pair: int) -> dict[str, int]:
        """Return the value of each field in this pair, by the letter of the field."""
        return {name: place.of(pair) for name, place in self.fields.items()}

    def pair(self, values: Mapping[str, int]) -> int:
        """Return the pair of words with these field values. Raise ValueError if a value does not fit its field."""
        pair = self.value
        for name, number in values.items():
            place = self.fields[name]
            if number & ~place.mask:
                raise ValueError(f"{number} does not fit field {name!r} of {self.id}, at most {place.mask}")
            pair |= number << place.shift
        return pair

    def cycles_of(self, values: Mapping[str, int]) -> tuple[int, int]:
        """Return `cycles` and `not_taken` for these field values, with `cycles_where` taken into account.

        Both numbers are equal if the instruction is not a conditional jump, call or return.
        """
        if where := CYCLES_WHERE.fullmatch(self.cycles_where):
            value, number = values[where[1]], int(where[3], 0)
            if value == number if where[2] == "=" else value & number:
                return int(where[4]), int(where[4])
        return self.cycles, self.not_taken

    @property
    def accesses(self) -> str:
        """The kind of access to the operand of field l: "r" reads, "w" writes, "rw" both, "" if there is no access."""
        read, written = (any(name in LOCATIONS for name in places(column)) for column in (self.reads, self.writes))
        return "r" * read + "w" * written


def places(column: Iterable[str]) -> list[str]:
    """Return the entries of a column `reads` or `writes` without their pipeline phases: "SP" for "SP@D2"."""
    return [place.partition("@")[0] for place in column]


LOCATIONS = ("loc16", "loc32", "mem16", "mem32")


@cache
def encodings() -> tuple[Encoding, ...]:
    """Return all forms in the order of `encodings.toml`."""
    return read_table(resources.files(__package__).joinpath("encodings.toml").read_text(encoding="utf-8"))


def read_table(text: str) -> tuple[Encoding, ...]:
    """Return the forms of a table in TOML. Raise ValueError for an invalid row or a column that no code reads."""
    return tuple(_encoding(name, columns) for name, columns in tomllib.loads(text).items())


@cache
def by_id() -> dict[str, Encoding]:
    return {encoding.id: encoding for encoding in encodings()}


def _encoding(name: str, columns: dict[str, Any]) -> Encoding:
    """Return the form that a row of the table describes. The comment at the head of the table lists the defaults."""
    take = columns.pop
    syntax, digits = take("syntax"), take("bits")
    bits = digits.ljust(PAIR, ".")
    cycles, repeated = take("cycles", 1), take("cycles_rpt", "N+0")
    bounds: dict[str, range] = {}
    if where := take("where", ""):  # a condition such as "s >= 1" or "n <= 5"
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
SP_FIELD = 0xAD  # value of field l for @SP, which cannot be a 32-bit operand
DIRECT, STACK, INDEXED = range(0x40), range(0x40, 0x80), range(0xC0, 0x100)


@cache
def operand_texts(wide: bool) -> tuple[str, ...]:
    """Return the operand text for each of the 256 values of field l. wide: True if the operand has 32 bits."""
    xar, words = range(8), range(0x40)
    # Two values of field l encode ACC as a 32-bit operand, and two encode P. The assembler emits the second one.
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
    """Return True if an operand of this kind can have this value of field l, the bits `llllllll` of an instruction.

    kind: "loc16" or "loc32" for memory or a register, "mem16" or "mem32" for memory only [SPRUEO2A Table 4-1], "reg32"
        for a register of 32 bits. SP has 16 bits, so it is no operand of a kind with 32 bits.
    """
    if kind.startswith("mem"):
        return field not in REGISTERS
    if field == SP_FIELD and kind in WIDE:
        return False
    return kind != "reg32" or field in REGISTERS


@cache
def fixed_operands(wide: bool) -> dict[str, int]:
    """Return the value of field l for each operand text, except those with a data page offset or a stack offset.

    Examples are "@AL", "*XAR4++" and "*+XAR4[2]". "*XAR4" is a short form of "*+XAR4[0]".
    wide: True if the operand has 32 bits.
    """
    texts = operand_texts(wide)
    return {texts[field]: field for field in range(0x80, 0x100)} | {f"*XAR{n}": 0xC0 | n for n in range(8)}
