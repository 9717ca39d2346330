"""What a wait of an image is about: the loop and what it read go in; registers with their bits, for people, come out.

The bits are those that the loop's first test of a bit, or mask, names; all of a register where it has none.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ...c28x.decoder import Instruction, decode_at
from ...core.registers import Register
from ...f28335.system.register_names import full_name
from ..operand import Operand
from .cpu import ImageCpu

LONGEST = 64  # words of a loop that are looked at
ALL = 0xFFFF


class Awaited(NamedTuple):
    """texts: what is read, "I2C-A.I2CSTR.XRDY". unanswered: of what nothing models, as a sentence; "" if nothing is."""

    texts: list[str]
    unanswered: str


def awaited(cpu: ImageCpu, branch: int, operands: Sequence[Operand], elsewhere: Sequence[int], unit: str) -> Awaited:
    """branch: the address of the loop's last instruction; `cpu` stands at its first one."""
    mask = mask_of(cpu, branch)
    texts = [f"{operand.name}.{fields_of(operand.register, mask)}" for operand in operands]
    names = list(dict.fromkeys(f"{full_name(address)} & {mask:#06x}" for address in elsewhere))
    unanswered = ""
    if names:
        register = full_name(elsewhere[0])
        unanswered = f'nothing models that; answer it by [[unit.{unit}.stub]] with register = "{register}" and a value'
    return Awaited(list(dict.fromkeys([*texts, *names])), unanswered)


def fields_of(register: Register, mask: int) -> str:
    """The fields of a register that the bits belong to; "all" where the mask says no more."""
    if mask == ALL:
        return "all"
    return "+".join(field.name for field in register.fields if field.mask & mask) or "all"


def mask_of(cpu: ImageCpu, branch: int) -> int:
    """The bits that the loop looks at."""
    for one in _loop(cpu, branch):
        mnemonic, values = one.encoding.mnemonic, one.values
        if mnemonic == "TBIT" and "b" in values:
            return 1 << values["b"]
        if mnemonic in ("AND", "ANDB") and "c" in values:
            return values["c"]
    return ALL


def _loop(cpu: ImageCpu, branch: int) -> Iterator[Instruction]:
    address = cpu.pc
    while address <= branch < address + LONGEST:
        found = decode_at(address, cpu.word_at(address), cpu.word_at(address + 1))
        if found is None:
            return
        yield found
        address += found.words
