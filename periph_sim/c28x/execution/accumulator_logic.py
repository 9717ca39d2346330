"""ACC: logic, sign bits and loads. Each function is one form of `encodings.toml`, by its id.

Source: SPRU430F chapter 6; section 2.3 (flags).
"""

# core: compiled

from __future__ import annotations

from .accumulator import logic
from .cpu import Cpu, Operation
from .registers import M32

__all__ = ("bind",)  # all other functions are compiled to C functions, which `bind` finds


# Logic --------------------------------------------------------------------------------------------------------------


def AND_ACC_16sh_0_15(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc & f.c << f.s)


def AND_ACC_16sh_16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc & f.c << 16)


def AND_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc & cpu.read16())


def OR_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc | cpu.read16())


def OR_ACC_16sh_0_15(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc | f.c << f.s)


def OR_ACC_16sh_16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc | f.c << 16)


def XOR_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc ^ cpu.read16())


def XOR_ACC_16sh_0_15(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc ^ f.c << f.s)


def XOR_ACC_16sh_16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc ^ f.c << 16)


def NOT_ACC(cpu: Cpu, f: Operation) -> None:
    logic(cpu, ~cpu.acc)


def CSB_ACC(cpu: Cpu, f: Operation) -> None:
    """Set T to the number of sign bits after the first one."""
    cpu.tc = cpu.acc >> 31
    rest = cpu.acc ^ (M32 if cpu.tc else 0)
    count = 0
    while count < 31 and not rest >> 30 - count:
        count += 1
    cpu.put_t(count)
    cpu.nz32(cpu.acc)


# Loads --------------------------------------------------------------------------------------------------------------


def MOV_ACC_16sh_0_15(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.x16(f.c) << f.s)


def MOV_ACC_loc16shT(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.x16(cpu.read16()) << (cpu.t() & 15))


def MOV_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.x16(cpu.read16()))


def MOV_ACC_loc16sh_1_15(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.x16(cpu.read16()) << f.s)


def MOV_ACC_loc16sh_16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.read16() << 16)


def MOVB_ACC_8(cpu: Cpu, f: Operation) -> None:
    logic(cpu, f.c)


def MOVU_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.read16())


def MOVL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.read32())


def ZALR_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.read16() << 16 | 0x8000)


def bind(f: Operation, name: str) -> None:
    """Bind an operation to the function of this name. Raise KeyError if it is not here."""
    f.execute = globals()[name]
