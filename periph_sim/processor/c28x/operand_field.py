"""The 8-bit operand field of loc16, loc32, mem16 and mem32: conversion to and from text.

    0x41  *-SP[1]      0x05  @0x5      0xA9  @AL as loc16, @ACC as loc32      0xC4  *+XAR4[0]

For AMODE = 0 and PAGE0 = 0. `@0x5` is word 5 of the data page selected by DP.

Source: SPRU430F Table 5-1, section 5; 0xA8 and 0xAA of loc32 as TI's disassembler shows them.
"""

from __future__ import annotations

from functools import cache

WIDE = ("loc32", "mem32", "reg32")
REGISTERS = range(0xA0, 0xAE)
SP_FIELD = 0xAD  # @SP, which has no 32-bit meaning
DIRECT, STACK, INDEXED = range(0x40), range(0x40, 0x80), range(0xC0, 0x100)

_WORDS = ("@AH", "@AL", "@PH", "@PL", "@T", "@SP")  # 0xA8 and on, of 16 bits
_PAIRS = ("@ACC", "@ACC", "@P", "@P", "@XT", "@SP")  # of 32 bits; the assembler emits the second one of two
_BIT_REVERSED = ("*BR0++", "*BR0--")
_LAST = ("*", "*++", "*--", "*0++", "*0--", "*SP++", "*--SP", "*AR6%++")  # 0xB8 and on


@cache
def show(field: int, wide: bool) -> str:
    """Format an operand field. wide: the operand has 32 bits."""
    number = field & 7
    if field in DIRECT:
        return f"@{field:#x}"
    if field in STACK:
        return f"*-SP[{field & 0x3F}]"
    if field in INDEXED:
        return f"*+XAR{number}[{field >> 3 & 7}]"
    if field < 0xA0:
        return (f"*XAR{number}++", f"*--XAR{number}", f"*+XAR{number}[AR0]", f"*+XAR{number}[AR1]")[field >> 3 & 3]
    if field < 0xA8:
        return f"@XAR{number}" if wide else f"@AR{number}"
    if field < 0xAE:
        return (_PAIRS if wide else _WORDS)[field - 0xA8]
    if field < 0xB0:
        return _BIT_REVERSED[field - 0xAE]
    return f"*,ARP{number}" if field < 0xB8 else _LAST[field - 0xB8]


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
def fixed(wide: bool) -> dict[str, int]:
    """Return the field of every operand text without a number: registers and address register modes."""
    found = {show(field, wide): field for field in range(0x80, 0x100)}
    found.update({f"*XAR{number}": 0xC0 | number for number in range(8)})
    return found
