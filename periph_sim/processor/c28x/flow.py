"""Control flow: the target of an instruction, and whether the next instruction can be reached.

Source: SPRU430F chapter 6; distances count from the address of the branch itself.
"""

from __future__ import annotations

from .decoder import Instruction
from .number_operands import PMA_PAGE

ADDRESS_BITS = 0x3F_FFFF
UNC = 15

CALLS = frozenset(["LCR", "LC", "FFC", "XCALL"])
RETURNS = frozenset(["LRETR", "LRET", "LRETE", "IRET"])
INTERRUPTS = frozenset(["TRAP", "INTR", "ITRAP0", "ITRAP1"])
RELATIVE = frozenset(["B", "BF", "SB", "SBF", "BANZ", "BAR"])
CONDITIONAL = frozenset(["SBF", "BANZ", "BAR", "XBANZ"])  # for every condition, and without a condition field
ENDS = frozenset(["ESTOP0", "ITRAP0", "ITRAP1"])


def is_call(instruction: Instruction) -> bool:
    """Return True for a call, which returns to the next instruction."""
    return instruction.encoding.mnemonic in CALLS | {"TRAP", "INTR"}


def target(instruction: Instruction) -> int | None:
    """Return the target of a branch or call; None if it is not a branch, or its target is in a register."""
    encoding = instruction.encoding
    if "PC" not in (place.partition("@")[0] for place in encoding.writes) or "c" not in encoding.fields:
        return None
    mnemonic, number = encoding.mnemonic, instruction.values["c"]
    if mnemonic in INTERRUPTS:
        return None
    if mnemonic in RELATIVE:
        half = encoding.fields["c"].mask + 1 >> 1
        return instruction.address + ((number ^ half) - half) & ADDRESS_BITS
    return PMA_PAGE | number if mnemonic.startswith("X") else number


def goes_on(instruction: Instruction) -> bool:
    """Return True if the next instruction may be reached from this one, directly or by a return."""
    mnemonic = instruction.encoding.mnemonic
    if is_call(instruction):
        return True
    if mnemonic in RETURNS or mnemonic in ENDS or mnemonic == "LB":
        return False
    if mnemonic in ("B", "BF", "SB", "XB", "XRETC") and mnemonic not in CONDITIONAL:
        return instruction.values.get("k", UNC) != UNC
    return True
