"""Find accesses to constant memory addresses in code, without executing the code.

    MOVW DP,#0x1C5        DP = 0x1C5
    MOVL XAR4,#0x0085F0   XAR4 = 0x0085F0
    MOVL @0x2,XAR4        write of 0x0085F0 to 0x1C5 << 6 | 2

The values of DP, SP and XAR0 to XAR7 are tracked within a function and over its forward branches. A value is unknown if
it comes from memory, from an argument, or from most arithmetic. Accesses to unknown addresses are not found.

Source: SPRU430F chapter 5 (addresses).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ..c28x.decoder import Instruction
from ..c28x.encodings import DIRECT, INDEXED, STACK, WIDE, places
from ..c28x.pipeline import POPS, PUSHES

PAGE = 6  # a data page has 2 ** PAGE words
FPU_REGISTERS = range(0x0F00, 0x0F30)  # a move with an address in this range accesses an FPU register
XAR = re.compile(r"X?AR([0-7n])")
CONSTANT = re.compile(r"(MOVL|MOVB|ADDB|SUBB) (X?AR)[0-7n],#\d+")


class Access(NamedTuple):
    """Access to memory at a constant address.

    width: 16 or 32 bits.
    how: "r" for a read, "w" for a write, "rw" for both.
    value: the value of the address register that MOVL writes, if it is known; otherwise None.
    """

    address: int
    width: int
    how: str
    value: int | None
    instruction: Instruction


class Known:
    """Values of DP, SP and XAR0 to XAR7 at a point of the program. A value is None if it is unknown."""

    def __init__(self, dp: int | None = None, xar: Iterable[int | None] = (None,) * 8, sp: int | None = None) -> None:
        self.dp = dp
        self.xar = list(xar)
        self.sp = sp

    def copy(self) -> Known:
        return Known(self.dp, self.xar, self.sp)


def accesses(
    instructions: Iterable[Instruction | int], functions: frozenset[int], begin: Known | None = None
) -> Iterator[Access]:
    """Yield every access that has a known address.

    instructions: the result of `sweep`: instructions, and the addresses of words that are no instructions.
    functions: the addresses at which functions begin. All register values are unknown there.
    begin: the register values before the first instruction; None if all are unknown.
    """
    known = begin or Known()
    waiting: dict[int, Known] = {}  # for the target of each forward branch, the known values there
    reached = True
    for instruction in instructions:
        if isinstance(instruction, int) or instruction.address in functions:
            known, reached = Known(), True
            waiting.clear()
            if isinstance(instruction, int):
                continue
        arrived = waiting.pop(instruction.address, None)
        if not reached:
            known = arrived or Known()
        yield from _accesses(instruction, known)
        _follow(instruction, known)
        goal = instruction.target
        if instruction.is_call:
            known = Known()
        elif goal is not None and goal > instruction.address:
            waiting.setdefault(goal, known.copy())
        reached = instruction.goes_on


def _accesses(instruction: Instruction, known: Known) -> Iterator[Access]:
    encoding, values = instruction.encoding, instruction.values
    if "l" in values and encoding.accesses:
        address = _address(values["l"], known, _width(instruction))
        if address is not None:
            source = XAR.fullmatch(encoding.syntax.rpartition(",")[2])
            value = known.xar[int(source[1])] if source and encoding.mnemonic == "MOVL" else None
            yield Access(address, _width(instruction), encoding.accesses, value, instruction)
    if "*(0:16)" in encoding.syntax and values["c"] not in FPU_REGISTERS:
        written = encoding.syntax.partition(" ")[2].startswith("*(0:16)")
        yield Access(values["c"], _width(instruction), "w" if written else "r", None, instruction)


def _width(instruction: Instruction) -> int:
    return 32 if any(wide in instruction.encoding.syntax for wide in WIDE) else 16


def _address(field: int, known: Known, width: int) -> int | None:
    """Return the address that field l encodes; None if the operand is a register, or if the address is unknown."""
    if field in DIRECT:
        return None if known.dp is None else known.dp << PAGE | field
    if field in STACK:
        return None if known.sp is None else known.sp - (field & 0x3F)
    if field in INDEXED:
        base = known.xar[field & 7]
        return None if base is None else base + (field >> 3 & 7)
    if field in range(0x80, 0xA0):
        base, mode = known.xar[field & 7], field >> 3 & 3
        if base is None or mode == 0:
            return base
        if mode == 1:
            return base - width // 16
        index = known.xar[mode - 2]
        return None if index is None else base + (index & 0xFFFF)
    return None


def _follow(instruction: Instruction, known: Known) -> None:
    """Update the known values after an instruction."""
    encoding, values, xar = instruction.encoding, instruction.values, known.xar
    field = values.get("l", -1)
    if field in range(0x80, 0x90):
        base, step = xar[field & 7], _width(instruction) // 16
        xar[field & 7] = None if base is None else base + (step if field < 0x88 else -step)
    elif field in range(0xA0, 0xA8) and "w" in encoding.accesses:
        xar[field & 7] = None
    written = places(encoding.writes)
    for found in filter(None, map(XAR.fullmatch, written)):
        number = values["n"] if found[1] == "n" else int(found[1])
        xar[number] = _constant(instruction, xar[number])
    if "XAR[ARP]" in written:
        known.xar = [None] * 8
    if "SP" in written or field in (PUSHES, POPS):
        known.sp = None
    if "DP" in written:
        if encoding.id in ("MOVW_DP_16", "MOVZ_DP_10"):
            known.dp = values["c"]
        else:
            known.dp = known.dp & ~0x3FF | values["c"] if encoding.id == "MOV_DP_10" and known.dp is not None else None


def _constant(instruction: Instruction, before: int | None) -> int | None:
    """Return the value that an instruction writes to an address register; None if it is unknown.

    before: the earlier value of the register.
    """
    found, c = CONSTANT.fullmatch(instruction.encoding.syntax), instruction.values.get("c", 0)
    if found is None:
        return None
    mnemonic, register = found.groups()
    if mnemonic.startswith("MOV") and register == "XAR":
        return c
    if before is None:
        return None
    if register == "AR":  # a write to ARn keeps the upper half of XARn
        return before & ~0xFFFF | c
    return before + c if mnemonic == "ADDB" else before - c
