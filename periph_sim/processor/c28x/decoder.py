"""Decode words of program memory into instructions.

The decoder assumes OBJMODE = 1, AMODE = 0 and PAGE0 = 0, as compiled C code uses them on this chip. Words are no
instruction if they match no form (no row) of `encodings.toml`, if their operand is not allowed in the form, such as @SP
as a 32-bit operand, or if their FPU condition is reserved [SPRU430F 3.6, Table 5-1; SPRUEO2A].
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache
from typing import NamedTuple

from .encodings import Encoding, encodings, is_operand, places
from .operands import FPU_CONDITION_NAMES, PMA_PAGE, parts_of

OPERAND = re.compile(r"(loc|mem)(16|32)")
ADDRESS_BITS = 0x3F_FFFF
UNC = 15  # the value of field k in a branch without a condition
CALLS = frozenset(["LCR", "LC", "FFC", "XCALL"])
RETURNS = frozenset(["LRETR", "LRET", "LRETE", "IRET"])
INTERRUPTS = frozenset(["TRAP", "INTR", "ITRAP0", "ITRAP1"])
RELATIVE = frozenset(["B", "BF", "SB", "SBF", "BANZ", "BAR"])
UNC_ENDS = frozenset(["B", "BF", "SB", "XB", "XRETC"])  # mnemonics that always jump if their condition is UNC
ENDS = RETURNS | {"ESTOP0", "ITRAP0", "ITRAP1", "LB"}
TMU = range(0xE270, 0xE27D)
VCU = (0xE2, 0xE5)  # values of the upper byte of the first word of an instruction for the VCU


class Instruction(NamedTuple):
    """A decoded instruction.

    address: the address of its first word.
    pair: first word << 16 | second word; the second word is ignored if the instruction has one word.
    """

    address: int
    pair: int
    encoding: Encoding

    @property
    def words(self) -> int:
        return self.encoding.words

    @property
    def values(self) -> dict[str, int]:
        """The value of each field of the instruction, by the letter of the field in `encodings.toml`."""
        return self.encoding.values(self.pair)

    @property
    def text(self) -> str:
        """The instruction in assembler syntax; a branch shows its target address."""
        values = self.values
        return "".join(part.show(values, self.address) for part in parts_of(self.encoding)).rstrip()

    @property
    def is_call(self) -> bool:
        """True for LCR, LC, FFC, XCALL, TRAP and INTR; the called code returns to the next instruction."""
        return self.encoding.mnemonic in CALLS or self.encoding.mnemonic in ("TRAP", "INTR")

    @property
    def target(self) -> int | None:
        """The target address of a branch or call; None if it is in a register or a vector, and for other instructions.

        The distance of a relative branch counts from the address of the branch [SPRU430F chapter 6].
        """
        encoding = self.encoding
        if "PC" not in places(encoding.writes) or "c" not in encoding.fields:
            return None
        mnemonic, number = encoding.mnemonic, self.values["c"]
        if mnemonic in INTERRUPTS:
            return None
        if mnemonic in RELATIVE:
            half = encoding.fields["c"].mask + 1 >> 1
            return self.address + ((number ^ half) - half) & ADDRESS_BITS
        return PMA_PAGE | number if mnemonic.startswith("X") else number

    @property
    def goes_on(self) -> bool:
        """True if the program can continue at the next address, directly or after a return from a call."""
        mnemonic = self.encoding.mnemonic
        if self.is_call:
            return True
        return mnemonic not in ENDS and (mnemonic not in UNC_ENDS or self.values.get("k", UNC) != UNC)


def decode(first: int, second: int) -> Encoding | None:
    """Return the form of the instruction whose first word is `first`; None if these words are no instruction.

    second: the next word, which belongs to the instruction only if the form has two words.
    """
    pair = first << 16 | second
    for encoding in _candidates()[first >> 8]:
        if encoding.matches(pair):
            values, kind = encoding.values(pair), OPERAND.search(encoding.syntax)
            if "w" in values and values["w"] not in FPU_CONDITION_NAMES:
                return None
            return encoding if "l" not in values or kind is None or is_operand(kind.group(), values["l"]) else None
    return None


def other_unit(first: int) -> str:
    """Return the name of the unit in other C28x parts that would execute this word, such as "the TMU of an F2837x".

    Return "" if no part has such a unit. first: the first word of an instruction.
    """
    if first in TMU:
        return "the TMU of an F2837x"
    return "the VCU of an F2806x or F2837x" if first >> 8 in VCU else ""


def decode_at(address: int, first: int, second: int) -> Instruction | None:
    """Return the instruction at an address; None if there is none. first, second: the word there, and the next word."""
    encoding = decode(first, second)
    return None if encoding is None else Instruction(address, first << 16 | second, encoding)


def sweep(address: int, words: Sequence[int]) -> Iterator[Instruction | int]:
    """Yield the consecutive instructions in these words, and the address of each word that starts no instruction."""
    at = 0
    while at < len(words):
        second = words[at + 1] if at + 1 < len(words) else 0
        found = decode_at(address + at, words[at], second)
        if found is None or at + found.words > len(words):
            yield address + at
            at += 1
        else:
            yield found
            at += found.words


@cache
def _candidates() -> tuple[tuple[Encoding, ...], ...]:
    """Return, for each value of the upper byte of the first word, the forms that can match, except aliases."""
    table: list[list[Encoding]] = [[] for _ in range(256)]
    for encoding in encodings():
        if encoding.alias_of:
            continue
        mask, value = encoding.mask >> 24, encoding.value >> 24
        for upper in range(256):
            if upper & mask == value:
                table[upper].append(encoding)
    return tuple(tuple(row) for row in table)
