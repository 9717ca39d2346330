"""Register maps of recorded modules, by the module's name."""

from __future__ import annotations

from ..core.registers import CpuAccess, Field, OnWrite, Register, RegisterMap, Yields
from ..f28335.parts.f28335 import PART


def registers_of(module: str) -> RegisterMap | None:
    """Return the registers of a module; None if the F28335 has no such module."""
    found = PART.by_name.get(module)
    return None if found is None else found.registers


def register_of(module: str, name: str) -> Register | None:
    """Return a register by its name; None if it is not known."""
    registers = registers_of(module)
    return registers[name] if registers is not None and name in registers else None


def reads_take(name: str) -> bool:
    """Return True if a read of the register "MODULE.REGISTER" removes the word that it returns, or clears a field."""
    register = register_of(*name.partition(".")[::2])
    return register is not None and register.reads_take


def yields_data(name: str) -> bool:
    """Return True if a read of the register returns a word of transferred data. name: "MODULE.REGISTER"."""
    register = register_of(*name.partition(".")[::2])
    return register is not None and register.yields is Yields.DATA


def is_status(register: Register) -> bool:
    """Return True if the register has a field of one bit that is read-only or is cleared by writing 1."""
    return any(f.msb == f.lsb and (f.cpu is CpuAccess.R or f.on_write is OnWrite.ONE_CLEARS) for f in register.fields)


def one_clears(register: Register) -> tuple[Field, ...]:
    """Return the fields that are cleared by writing 1."""
    return tuple(f for f in register.fields if f.on_write is OnWrite.ONE_CLEARS)


MODIFY = 4  # maximum number of cycles between the read and the write of a read-modify-write
# The write of a read-modify-write is one of the next OVERTAKEN accesses that the routine makes after the read.
OVERTAKEN = 3
