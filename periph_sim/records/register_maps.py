"""Which register map a module of a recording has: a module's name goes in, its registers come out."""

from __future__ import annotations

from ..core.registers import Cpu, Field, OnWrite, Register, RegisterMap
from ..f28335.cpu import pie_map, xint_map
from ..f28335.gpio import register_map as gpio_map
from ..f28335.i2c.register_map import I2C_MAP
from ..f28335.sci.register_map import SCI_MAP
from ..f28335.system import clocks_map
from ..f28335.system import cpu_timer_map as timer_map

OF_ALL_UNITS = ("SYS", "PIE")  # every unit has them, whatever its case names


def registers_of(module: str) -> RegisterMap | None:
    """The registers of "I2C-A" or "PIE"; None for a module that is not known here."""
    kinds = {"I2C": I2C_MAP, "SCI": SCI_MAP, "TIM": timer_map.MAP, "XIN": xint_map.XINT}
    whole = {"GPIO": gpio_map.GPIO, "SYS": clocks_map.MAP, "PIE": pie_map.MAP}
    return whole.get(module) or kinds.get(module[:3])


def register_of(module: str, name: str) -> Register | None:
    """A register by its name; None where it is not known."""
    registers = registers_of(module)
    return registers[name] if registers is not None and name in registers else None


def is_status(register: Register) -> bool:
    """Whether hardware changes one of its single bits by itself: a flag that firmware looks at."""
    return any(f.msb == f.lsb and (f.cpu is Cpu.R or f.on_write is OnWrite.ONE_CLEARS) for f in register.fields)


def one_clears(register: Register) -> tuple[Field, ...]:
    """The fields that writing 1 clears."""
    return tuple(f for f in register.fields if f.on_write is OnWrite.ONE_CLEARS)
