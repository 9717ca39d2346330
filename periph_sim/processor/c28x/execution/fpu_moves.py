"""Moves and flags of the FPU.

A form is one encoding of an instruction, a row of `encodings.toml`. The function named like the row executes the form.
Source: SPRUEO2A chapter 4.
"""

# core: compiled

from __future__ import annotations

from ..operands import FPU_APART, FPU_FIRST
from .cpu import Cpu, Operation
from .fpu import UNCF, condition, moved
from .registers import HIGH16, LUF, LVF, M16, NF, NI, SHDWS, STF_WRITTEN, TF, ZF, ZI, IllegalOperation

__all__ = ("bind",)  # when compiled, only `bind` is visible from Python; it finds the other functions by name

WINDOW, WINDOW_END = 0x0F00, 0x0F30  # a move with an address in this range accesses an FPU register
MEMORY = -1  # result of `register_of` for an address in memory


def register_of(address: int) -> int:
    """Return n if a move with this address accesses RnH, and MEMORY if it accesses memory.

    Raise IllegalOperation for other addresses from WINDOW to WINDOW_END - 1.
    """
    if not WINDOW <= address < WINDOW_END:
        return MEMORY
    number, rest = (address - FPU_FIRST) // FPU_APART, (address - FPU_FIRST) % FPU_APART
    if rest or not 0 <= number < 8:
        raise IllegalOperation(f"a move accesses {address:#06x}, which is not a known FPU register")
    return number


def MOV32_ind_0_16_loc32(cpu: Cpu, f: Operation) -> None:
    number = register_of(f.c)
    if number == MEMORY:
        cpu.store32(f.c, cpu.read32())
    else:
        cpu.r[number] = cpu.read32()


def MOV32_loc32_ind_0_16(cpu: Cpu, f: Operation) -> None:
    number = register_of(f.c)
    if number == MEMORY:
        cpu.move32(cpu.load32(f.c))
    else:
        cpu.move32(cpu.r[number])


def MOV16_mem16_RaH(cpu: Cpu, f: Operation) -> None:
    cpu.write16(cpu.r[f.p] & M16)


def MOV32_mem32_RaH(cpu: Cpu, f: Operation) -> None:
    cpu.write32(cpu.r[f.p])


def MOV32_mem32_STF(cpu: Cpu, f: Operation) -> None:
    cpu.write32(cpu.stf)


def MOV32_STF_mem32(cpu: Cpu, f: Operation) -> None:
    cpu.stf = cpu.read32() & STF_WRITTEN | cpu.stf & SHDWS


def _move(cpu: Cpu, f: Operation, bits: int) -> None:
    if f.w == UNCF:
        moved(cpu, f.p, bits)
    elif condition(cpu, f.w):
        cpu.r[f.p] = bits


def MOV32_RaH_mem32_CNDF(cpu: Cpu, f: Operation) -> None:
    _move(cpu, f, cpu.read32())


def MOV32_RaH_RbH_CNDF(cpu: Cpu, f: Operation) -> None:
    _move(cpu, f, cpu.r[f.q])


def MOVD32_RaH_mem32(cpu: Cpu, f: Operation) -> None:
    moved(cpu, f.p, cpu.read32())
    cpu.store32(cpu.beside(2), cpu.r[f.p])


def MOVIZ_RaH_16FHiHex(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = f.i << 16


def MOVXI_RaH_16FLoHex(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = cpu.r[f.p] & HIGH16 | f.i


def SWAPF_RaH_RbH_CNDF(cpu: Cpu, f: Operation) -> None:
    if condition(cpu, f.w):
        cpu.r[f.p], cpu.r[f.q] = cpu.r[f.q], cpu.r[f.p]


def ZEROA(cpu: Cpu, f: Operation) -> None:
    for number in range(8):
        cpu.r[number] = 0


# Flags --------------------------------------------------------------------------------------------------------------


def TESTTF_CNDF(cpu: Cpu, f: Operation) -> None:
    cpu.stf = cpu.stf & ~TF | (TF if condition(cpu, f.w) else 0)


def MOVST0_FLAG(cpu: Cpu, f: Operation) -> None:
    """Copy the selected flags of STF to ST0. If two of them belong to the same bit of ST0, they are ORed.

    LVF and LUF are cleared in STF when they are copied.
    """
    v = (LVF if f.g & 1 else 0) | (LUF if f.g & 2 else 0)
    n = (NF if f.g & 4 else 0) | (NI if f.g & 8 else 0)
    z = (ZF if f.g & 0x10 else 0) | (ZI if f.g & 0x20 else 0)
    if v:
        cpu.v = int(cpu.stf & v != 0)
    if n:
        cpu.n = int(cpu.stf & n != 0)
    if z:
        cpu.z = int(cpu.stf & z != 0)
    if f.g & 0x80:
        cpu.c = cpu.tc = int(cpu.stf & TF != 0)
    cpu.stf &= ~v


def SETFLG_FLAG_VALUE(cpu: Cpu, f: Operation) -> None:
    mask = f.g & STF_WRITTEN
    cpu.stf = cpu.stf & ~mask | f.h & mask


def SAVE_FLAG_VALUE(cpu: Cpu, f: Operation) -> None:
    for number in range(8):
        cpu.shadow_r[number] = cpu.r[number]
    cpu.shadow_stf = cpu.stf & STF_WRITTEN
    cpu.stf |= SHDWS
    SETFLG_FLAG_VALUE(cpu, f)


def RESTORE(cpu: Cpu, f: Operation) -> None:
    for number in range(8):
        cpu.r[number] = cpu.shadow_r[number]
    cpu.stf = cpu.shadow_stf


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name. Raise KeyError if this module has no such function."""
    f.execute = globals()[name]
