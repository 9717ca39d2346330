"""Convert decoded instructions to operations, which are ready to execute.

Source: SPRU430F Table 5-1 and section 5.10 (forms with byte operands).
"""

# core: compiled

from __future__ import annotations

import re

from ..decoder import Instruction
from ..encodings import WIDE, Encoding
from ..pipeline import writes_at_once
from . import (
    accumulator,
    branches,
    control,
    fpu,
    fpu_moves,
    half_words,
    moves,
    multiply,
    shifts,
    stack,
)
from .cpu import READS, WRITES, Operation

# Ids of forms that encode one certain address register, such as MOVB_XAR6_8. The function for all address registers,
# MOVB_XARn_8 in this example, executes these forms.
OF_ONE_XAR = re.compile(r"((?:[A-Z]+|MOVL_loc32)_X?AR)(\d)(_[a-z0-9]+)?")
MODULES = (accumulator, half_words, multiply, shifts, moves, stack, branches, control, fpu, fpu_moves)

_forms: dict[str, Operation] = {}


def operation(instruction: Instruction) -> Operation:
    """Return a new Operation that executes an instruction. Raise KeyError if no function executes its form."""
    encoding, values = instruction.encoding, instruction.values
    form = form_of(encoding)
    made = Operation()
    for name, value in values.items():
        setattr(made, name, value)
    if form.n >= 0:
        made.n = form.n
    made.place = made.address = instruction.address
    made.next = instruction.address + encoding.words & 0x3F_FFFF
    made.encoding, made.execute = encoding, form.execute
    made.cycles, made.not_taken = encoding.cycles_of(values)
    made.repeated = form.repeated
    made.wide, made.byte = form.wide, form.byte
    made.accesses, made.absolute, made.at_once = form.accesses, form.absolute, form.at_once
    if encoding.mnemonic == "MOV32" and made.absolute and fpu_moves.WINDOW <= made.c < fpu_moves.WINDOW_END:
        made.cycles = made.not_taken = 1  # the instruction is a move between registers
        made.absolute = 0
    return made


def form_of(encoding: Encoding) -> Operation:
    """Return an operation with the properties that all operations of a form share. It is made once for each form.

    Raise KeyError if no function executes the form.
    """
    found = _forms.get(encoding.id)
    if found is None:
        found = _forms[encoding.id] = _form_of(encoding)
    return found


def _form_of(encoding: Encoding) -> Operation:
    made = Operation()
    name, made.encoding = encoding.id, encoding
    one = OF_ONE_XAR.fullmatch(name)
    if one:
        name, made.n = f"{one[1]}n{one[3] or ''}", int(one[2])
    bind(made, name.removesuffix("_ARPn") if encoding.mnemonic == "XBANZ" else name)
    made.repeated = encoding.repeated
    made.wide = any(operand in encoding.syntax for operand in WIDE)
    made.byte = encoding.mnemonic == "MOVB" and ("LSB" in encoding.syntax or "MSB" in encoding.syntax)
    made.accesses = (READS if "r" in encoding.accesses else 0) | (WRITES if "w" in encoding.accesses else 0)
    made.at_once = writes_at_once(encoding)
    if "*(0:16)" in encoding.syntax:
        made.absolute = WRITES if encoding.syntax.split(" ", 1)[1].startswith("*") else READS
    return made


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name in one of MODULES. Raise KeyError if there is none."""
    for module in MODULES:
        try:
            module.bind(f, name)
            return
        except KeyError:
            continue
    raise KeyError(name)
