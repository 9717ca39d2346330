"""Decoded instructions made ready: a form and its words go in; an operation with its function comes out.

Source: SPRU430F Table 5-1 and section 5.10 (which forms take bytes).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from types import ModuleType

from ..decoder import Instruction
from ..encodings import by_id
from ..operand_field import WIDE
from . import accumulator, branches, control, fpu, fpu_moves, half_words, moves, multiply, shifts, stack
from .registers import Cpu, Operation

Execute = Callable[[Cpu, Operation], None]
FIELDS = "bcghiklmnpqrstuvwxyz"
MODULES: tuple[ModuleType, ...] = (
    accumulator,
    half_words,
    multiply,
    shifts,
    moves,
    stack,
    branches,
    control,
    fpu,
    fpu_moves,
)


@cache
def functions() -> Mapping[str, Execute]:
    """What each form does, by its id."""
    known = by_id()
    found = {name: form for module in MODULES for name, form in vars(module).items() if name in known}
    return found | moves.OF_XAR


def operation(instruction: Instruction) -> Operation:
    """The instruction, ready to be executed."""
    encoding, values = instruction.encoding, instruction.values
    made = Operation()
    for name in FIELDS:
        setattr(made, name, values.get(name, -1))
    made.address, made.next = instruction.address, instruction.address + encoding.words & 0x3F_FFFF
    made.encoding, made.execute = encoding, functions()[encoding.id]
    made.cycles, made.not_taken = encoding.cycles, encoding.not_taken
    made.wide = any(operand in encoding.syntax for operand in WIDE)
    made.byte = encoding.mnemonic == "MOVB" and ("LSB" in encoding.syntax or "MSB" in encoding.syntax)
    made.accesses = encoding.accesses
    made.absolute = ""
    if "*(0:16)" in encoding.syntax:
        made.absolute = "w" if encoding.syntax.split(" ", 1)[1].startswith("*") else "r"
    return made
