"""Multiply, and multiply with accumulate.

A form is one encoding of an instruction, a row of `encodings.toml`. The function named like the row executes the form.
Source: SPRU430F chapter 6; section 5.8 (program addresses that increase in each pass of RPT).
"""

# core: compiled

from __future__ import annotations

from .accumulator import add, difference_ovcu, logic, subtract, sum_ovcu
from .cpu import Cpu, Operation
from .registers import M32, PMA, s16, s32

__all__ = ("bind",)  # when compiled, only `bind` is visible from Python; it finds the other functions by name


def product_low(cpu: Cpu, product: int) -> int:
    """Shift the low 38 bits of a 64-bit product by PM, and return the low 32 bits of the result."""
    return ((product & M32) << 1 if cpu.pm == 0 else product >> cpu.pm - 1) & M32


def product_high(product: int) -> int:
    return product >> 32 & M32


def program32(cpu: Cpu, address: int) -> int:
    return cpu.program16(address & ~1) | cpu.program16(address | 1) << 16


def take_product(cpu: Cpu, f: Operation) -> None:
    """Subtract P, shifted by PM, from ACC if b = 1; otherwise, add it to ACC."""
    if f.b == 1:
        subtract(cpu, cpu.psh())
    else:
        add(cpu, cpu.psh())


# 16 by 16 bits ------------------------------------------------------------------------------------------------------


def MPY_ACC_loc16_16(cpu: Cpu, f: Operation) -> None:
    cpu.put_t(cpu.read16())
    logic(cpu, s16(cpu.t()) * s16(f.c))


def MPY_ACC_T_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, s16(cpu.t()) * s16(cpu.read16()))


def MPY_P_loc16_16(cpu: Cpu, f: Operation) -> None:
    cpu.p = s16(cpu.read16()) * s16(f.c) & M32


def MPY_P_T_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.p = s16(cpu.t()) * s16(cpu.read16()) & M32


def MPYA_P_loc16_16(cpu: Cpu, f: Operation) -> None:
    value = cpu.read16()
    add(cpu, cpu.psh())
    cpu.put_t(value)
    cpu.p = s16(value) * s16(f.c) & M32


def MPYA_P_T_loc16(cpu: Cpu, f: Operation) -> None:
    value = cpu.read16()
    take_product(cpu, f)
    cpu.p = s16(cpu.t()) * s16(value) & M32


def MPYU_P_T_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.p = cpu.t() * cpu.read16()


def MPYU_ACC_T_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.t() * cpu.read16())


def MPYXU_ACC_T_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, s16(cpu.t()) * cpu.value16(f))


def MPYXU_P_T_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.p = s16(cpu.t()) * cpu.value16(f) & M32


def SQRA_loc16(cpu: Cpu, f: Operation) -> None:
    value = cpu.read16()
    take_product(cpu, f)
    cpu.put_t(value)
    cpu.p = s16(value) * s16(value) & M32


# Load T, and use the old P --------------------------------------------------------------------------------------------


def MOVA_T_loc16(cpu: Cpu, f: Operation) -> None:
    value = cpu.read16()
    take_product(cpu, f)
    cpu.put_t(value)


def MOVAD_T_loc16(cpu: Cpu, f: Operation) -> None:
    MOVA_T_loc16(cpu, f)
    cpu.store16(cpu.beside(1), cpu.t())


def MOVP_T_loc16(cpu: Cpu, f: Operation) -> None:
    value = cpu.read16()
    logic(cpu, cpu.psh())
    cpu.put_t(value)


# Multiply with program memory ---------------------------------------------------------------------------------------


def accumulate(cpu: Cpu, address: int) -> None:
    """Add P, shifted by PM, to ACC; load T with the operand; set P to T times the program word at `address`."""
    value = cpu.read16()
    factor = cpu.program16(address)
    add(cpu, cpu.psh())
    cpu.put_t(value)
    cpu.p = s16(value) * s16(factor) & M32


def stepping(cpu: Cpu, by: int) -> int:
    """Return XAR7. Then add `by` to XAR7, unless the operand's mode, other than *BR0++ or *BR0--, has changed it."""
    address = cpu.xar[7]
    own = cpu.field in (0x87, 0x8F) or (cpu.arp == 7 and 0xB9 <= cpu.field <= 0xBC)
    if not own:
        cpu.xar[7] = address + by & M32
    return address


def MAC_P_loc16_0_pma(cpu: Cpu, f: Operation) -> None:
    accumulate(cpu, f.c + cpu.passes)


def MAC_P_loc16_indXAR7inc(cpu: Cpu, f: Operation) -> None:
    accumulate(cpu, stepping(cpu, f.s))


def XMAC_P_loc16_ind_pma(cpu: Cpu, f: Operation) -> None:
    accumulate(cpu, PMA | f.c + cpu.passes & 0xFFFF)


def XMACD_P_loc16_ind_pma(cpu: Cpu, f: Operation) -> None:
    XMAC_P_loc16_ind_pma(cpu, f)
    cpu.store16(cpu.beside(1), cpu.t())


def dual(cpu: Cpu, address: int) -> None:
    """Load XT with the operand, and multiply its halves with those of the 32 bits of program memory at `address`.

    Add the product of the upper halves to ACC, and the product of the lower halves to P, both shifted by PM.
    """
    cpu.xt = cpu.read32()
    factor = program32(cpu, address)
    upper, lower = s16(cpu.xt >> 16) * s16(factor >> 16), s16(cpu.xt & 0xFFFF) * s16(factor & 0xFFFF)
    add(cpu, product_low(cpu, upper))
    cpu.p = cpu.p + product_low(cpu, lower) & M32


def DMAC_ACC_P_loc32_indXAR7inc(cpu: Cpu, f: Operation) -> None:
    dual(cpu, stepping(cpu, f.s))


# 32 by 32 bits ------------------------------------------------------------------------------------------------------


def IMPYL_ACC_XT_loc32(cpu: Cpu, f: Operation) -> None:
    logic(cpu, s32(cpu.xt) * s32(cpu.read32()))


def IMPYL_P_XT_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.p = product_low(cpu, s32(cpu.xt) * s32(cpu.read32()))


def IMPYXUL_P_XT_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.p = product_low(cpu, s32(cpu.xt) * cpu.read32())


def IMPYAL_P_XT_loc32(cpu: Cpu, f: Operation) -> None:
    value = cpu.read32()
    if f.b == 1:  # IMPYSL
        cpu.acc = difference_ovcu(cpu, cpu.acc, cpu.p)
    else:
        cpu.acc = sum_ovcu(cpu, cpu.acc, cpu.p)
    cpu.p = product_low(cpu, s32(cpu.xt) * s32(value))


def accumulate_low(cpu: Cpu, address: int) -> None:
    value, factor = cpu.read32(), program32(cpu, address)
    cpu.acc = sum_ovcu(cpu, cpu.acc, cpu.p)
    cpu.p = product_low(cpu, s32(value) * s32(factor))


def IMACL_P_loc32_indXAR7inc(cpu: Cpu, f: Operation) -> None:
    accumulate_low(cpu, stepping(cpu, f.s))


def QMPYL_P_XT_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.p = product_high(s32(cpu.xt) * s32(cpu.read32()))


def QMPYL_ACC_XT_loc32(cpu: Cpu, f: Operation) -> None:
    logic(cpu, product_high(s32(cpu.xt) * s32(cpu.read32())))


def QMPYUL_P_XT_loc32(cpu: Cpu, f: Operation) -> None:
    value = cpu.read32()  # bit 31 is added separately: the unsigned product does not fit into a signed 64-bit number
    cpu.p = product_high(cpu.xt * s32(value)) + (value >> 31) * cpu.xt & M32


def QMPYXUL_P_XT_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.p = product_high(s32(cpu.xt) * cpu.read32())


def QMPYAL_P_XT_loc32(cpu: Cpu, f: Operation) -> None:
    value = cpu.read32()
    take_product(cpu, f)
    cpu.p = product_high(s32(cpu.xt) * s32(value))


def accumulate_high(cpu: Cpu, address: int) -> None:
    value, factor = cpu.read32(), program32(cpu, address)
    add(cpu, cpu.psh())
    cpu.p = product_high(s32(value) * s32(factor))


def QMACL_P_loc32_indXAR7inc(cpu: Cpu, f: Operation) -> None:
    accumulate_high(cpu, stepping(cpu, f.s))


# P shifted ----------------------------------------------------------------------------------------------------------


def MOV_loc16_P(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.psh() & 0xFFFF)


def MOVH_loc16_P(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.psh() >> 16)


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name. Raise KeyError if this module has no such function."""
    f.execute = globals()[name]
