"""Moves and flags of the FPU. Each function is one form of `encodings.toml`, by its id.

Source: SPRUEO2A chapter 4.
"""

from __future__ import annotations

from .fpu import UNCF, condition, moved
from .registers import LUF, LVF, M16, NF, NI, SHDWS, STF_WRITTEN, TF, ZF, ZI, Cpu, IllegalOperation, Operation

WINDOW = range(0x0F00, 0x0F30)  # where R0H to R7H stand for moves that name an address
FIRST, APART = 0x0F12, 4
MOVST0_FLAGS = (LVF, LUF, NF, NI, ZF, ZI, 0, TF)  # bits of its mask, bit 0 first


def register_of(address: int) -> int | None:
    """The number of the FPU register that a move's address names; None for memory."""
    if address not in WINDOW:
        return None
    number, rest = divmod(address - FIRST, APART)
    if rest or not 0 <= number < 8:
        raise IllegalOperation(f"a move names {address:#06x}, where no FPU register is known to stand")
    return number


def MOV32_ind_0_16_loc32(cpu: Cpu, f: Operation) -> None:
    number = register_of(f.c)
    if number is None:
        cpu.store32(f.c, cpu.read32())
    else:
        cpu.r[number] = cpu.read32()
        cpu.cycles = 1


def MOV32_loc32_ind_0_16(cpu: Cpu, f: Operation) -> None:
    number = register_of(f.c)
    if number is None:
        cpu.move32(cpu.load32(f.c))
    else:
        cpu.move32(cpu.r[number])
        cpu.cycles = 1


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
    cpu.r[f.p] = cpu.r[f.p] & 0xFFFF_0000 | f.i


def SWAPF_RaH_RbH_CNDF(cpu: Cpu, f: Operation) -> None:
    if condition(cpu, f.w):
        cpu.r[f.p], cpu.r[f.q] = cpu.r[f.q], cpu.r[f.p]


def ZERO_RaH(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = 0


def ZEROA(cpu: Cpu, f: Operation) -> None:
    cpu.r[:] = [0] * 8


# Flags --------------------------------------------------------------------------------------------------------------


def TESTTF_CNDF(cpu: Cpu, f: Operation) -> None:
    cpu.stf = cpu.stf & ~TF | (TF if condition(cpu, f.w) else 0)


def MOVST0_FLAG(cpu: Cpu, f: Operation) -> None:
    """Flags of STF into ST0: two that share a bit there are joined."""
    chosen = 0
    for bit, flag in enumerate(MOVST0_FLAGS):
        if f.g >> bit & 1:
            chosen |= flag
    seen = cpu.stf & chosen
    if chosen & (LVF | LUF):
        cpu.v = int(bool(seen & (LVF | LUF)))
    if chosen & (NF | NI):
        cpu.n = int(bool(seen & (NF | NI)))
    if chosen & (ZF | ZI):
        cpu.z = int(bool(seen & (ZF | ZI)))
    if chosen & TF:
        cpu.c = cpu.tc = int(bool(seen & TF))
    cpu.stf &= ~(chosen & (LVF | LUF))


def SETFLG_FLAG_VALUE(cpu: Cpu, f: Operation) -> None:
    mask = f.g & STF_WRITTEN
    cpu.stf = cpu.stf & ~mask | f.h & mask


def SAVE_FLAG_VALUE(cpu: Cpu, f: Operation) -> None:
    cpu.shadow = list(cpu.r), cpu.stf & STF_WRITTEN
    cpu.stf |= SHDWS
    SETFLG_FLAG_VALUE(cpu, f)


def RESTORE(cpu: Cpu, f: Operation) -> None:
    registers, cpu.stf = cpu.shadow
    cpu.r[:] = registers
