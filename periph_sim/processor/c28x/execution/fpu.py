"""Arithmetic, comparisons and conversions of the FPU.

A form is one encoding of an instruction, a row of `encodings.toml`. The function named like the row executes the form.
The functions write their results at once, but the chip writes some results only after the next instruction. A program
with correct delay slots computes the same in both cases. `delay_slots.delay` makes an operation write as the chip does.
Source: SPRUEO2A chapter 4.
"""

# core: compiled

from __future__ import annotations

from .cpu import Cpu, Operation
from .float32 import (
    BITS,
    INFINITY,
    OVERFLOW,
    SIGN,
    UNDERFLOW,
    difference_of,
    estimate_of_inverse,
    estimate_of_inverse_root,
    fraction,
    from_integer,
    is_infinite,
    is_zero,
    order,
    product_of,
    sum_of,
    to_integer,
)
from .registers import LUF, LVF, M16, M32, NF, NI, RND32, TF, ZF, ZI, s16, s32

__all__ = ("bind",)  # when compiled, only `bind` is visible from Python; it finds the other functions by name

UNCF = 15


def nearest(cpu: Cpu) -> bool:
    return bool(cpu.stf & RND32)


def result(cpu: Cpu, number: int, value: int) -> None:
    """Write a result of `float32` to RnH. Set LUF if it has the bit UNDERFLOW, and LVF if it has the bit OVERFLOW.

    number: the n of RnH.
    """
    cpu.r[number] = value & BITS
    if value & UNDERFLOW:
        cpu.stf |= LUF
    if value & OVERFLOW:
        cpu.stf |= LVF


def moved(cpu: Cpu, number: int, bits: int) -> None:
    """Write RnH as a move does: set NF and ZF by the value as a float, and NI and ZI by the value as an integer.

    number: the n of RnH.
    """
    cpu.r[number] = bits
    flags = (NF | NI if bits & SIGN else 0) | (ZF if is_zero(bits) else 0) | (ZI if bits == 0 else 0)
    if flags & ZF:
        flags &= ~NF
    cpu.stf = cpu.stf & ~(NF | ZF | NI | ZI) | flags


def compare(cpu: Cpu, a: int, b: int) -> int:
    """Set NF and ZF by a - b. Return a number that has the sign of a - b."""
    first, second = order(a), order(b)
    cpu.stf = cpu.stf & ~(NF | ZF) | (ZF if first == second else 0) | (NF if first < second else 0)
    return first - second


def condition(cpu: Cpu, code: int) -> bool:
    """Return True if the FPU condition CNDF with this code is true."""
    zero, negative = bool(cpu.stf & ZF), bool(cpu.stf & NF)
    match code:
        case 0:
            return not zero
        case 1:
            return zero
        case 2:
            return not zero and not negative
        case 3:
            return not negative
        case 4:
            return negative
        case 5:
            return zero or negative
        case 10:
            return bool(cpu.stf & TF)
        case 11:
            return not cpu.stf & TF
        case 12:
            return bool(cpu.stf & LUF)
        case 13:
            return bool(cpu.stf & LVF)
    return True


def value_of(cpu: Cpu, f: Operation, number: int) -> int:
    """Return RnH, where n is `number`. If it is -1, because the form has no such field, return the float in field i."""
    return cpu.r[number] if number >= 0 else f.i << 16


def add(cpu: Cpu, number: int, a: int, b: int) -> None:
    result(cpu, number, sum_of(a, b, nearest(cpu)))


def subtract(cpu: Cpu, number: int, a: int, b: int) -> None:
    result(cpu, number, difference_of(a, b, nearest(cpu)))


def multiply(cpu: Cpu, number: int, a: int, b: int) -> None:
    result(cpu, number, product_of(a, b, nearest(cpu)))


# Arithmetic ---------------------------------------------------------------------------------------------------------


def ABSF32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    bits = cpu.r[f.p] = cpu.r[f.q] & ~SIGN
    compare(cpu, bits, 0)


def ADDF32_RaH_RbH_RcH(cpu: Cpu, f: Operation) -> None:
    add(cpu, f.p, cpu.r[f.q], value_of(cpu, f, f.r))


def SUBF32_RaH_RbH_RcH(cpu: Cpu, f: Operation) -> None:
    subtract(cpu, f.p, cpu.r[f.q], cpu.r[f.r])


def SUBF32_RaH_16FHi_RbH(cpu: Cpu, f: Operation) -> None:
    subtract(cpu, f.p, f.i << 16, cpu.r[f.q])


def MPYF32_RaH_RbH_RcH(cpu: Cpu, f: Operation) -> None:
    multiply(cpu, f.p, cpu.r[f.q], value_of(cpu, f, f.r))


def EINVF32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    result(cpu, f.p, estimate_of_inverse(cpu.r[f.q]))


def EISQRTF32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    result(cpu, f.p, estimate_of_inverse_root(cpu.r[f.q]))


def NEGF32_RaH_RbH_CNDF(cpu: Cpu, f: Operation) -> None:
    bits = cpu.r[f.q]
    if condition(cpu, f.w):
        bits ^= SIGN
    cpu.r[f.p] = bits
    if f.w == UNCF:
        compare(cpu, bits, 0)


# Two parallel operations; both read the values before the instruction ----------------------------------------------


def _with_load(cpu: Cpu, f: Operation, value: int) -> None:
    bits = cpu.read32()
    result(cpu, f.t, value)
    moved(cpu, f.p, bits)


def _with_store(cpu: Cpu, f: Operation, value: int) -> None:
    before = cpu.r[f.p]
    result(cpu, f.t, value)
    cpu.write32(before)


def ADDF32_RdH_ReH_RfH_par_MOV32_mem32_RaH(cpu: Cpu, f: Operation) -> None:
    _with_store(cpu, f, sum_of(cpu.r[f.u], cpu.r[f.v], nearest(cpu)))


def ADDF32_RdH_ReH_RfH_par_MOV32_RaH_mem32(cpu: Cpu, f: Operation) -> None:
    _with_load(cpu, f, sum_of(cpu.r[f.u], cpu.r[f.v], nearest(cpu)))


def SUBF32_RdH_ReH_RfH_par_MOV32_mem32_RaH(cpu: Cpu, f: Operation) -> None:
    _with_store(cpu, f, difference_of(cpu.r[f.u], cpu.r[f.v], nearest(cpu)))


def SUBF32_RdH_ReH_RfH_par_MOV32_RaH_mem32(cpu: Cpu, f: Operation) -> None:
    _with_load(cpu, f, difference_of(cpu.r[f.u], cpu.r[f.v], nearest(cpu)))


def MPYF32_RdH_ReH_RfH_par_MOV32_mem32_RaH(cpu: Cpu, f: Operation) -> None:
    _with_store(cpu, f, product_of(cpu.r[f.u], cpu.r[f.v], nearest(cpu)))


def MPYF32_RdH_ReH_RfH_par_MOV32_RaH_mem32(cpu: Cpu, f: Operation) -> None:
    _with_load(cpu, f, product_of(cpu.r[f.u], cpu.r[f.v], nearest(cpu)))


def MPYF32_RaH_RbH_RcH_par_ADDF32_RdH_ReH_RfH(cpu: Cpu, f: Operation) -> None:
    product = product_of(cpu.r[f.q], cpu.r[f.r], nearest(cpu))
    add(cpu, f.t, cpu.r[f.u], cpu.r[f.v])
    result(cpu, f.p, product)


def MPYF32_RaH_RbH_RcH_par_SUBF32_RdH_ReH_RfH(cpu: Cpu, f: Operation) -> None:
    product = product_of(cpu.r[f.q], cpu.r[f.r], nearest(cpu))
    subtract(cpu, f.t, cpu.r[f.u], cpu.r[f.v])
    result(cpu, f.p, product)


def MACF32_R3H_R2H_RdH_ReH_RfH_par_MOV32_RaH_mem32(cpu: Cpu, f: Operation) -> None:
    """Add the previous product to the total, compute the next product, and load a register.

    The number of the register with the total is field s; the register with the previous product is the one before it.
    """
    bits = cpu.read32()
    value = product_of(cpu.r[f.u], cpu.r[f.v], nearest(cpu))
    add(cpu, f.s, cpu.r[f.s], cpu.r[f.s - 1])
    result(cpu, f.t, value)
    moved(cpu, f.p, bits)


def MACF32_R7H_R3H_mem32_indXAR7inc(cpu: Cpu, f: Operation) -> None:
    """Accumulate in R3H in passes 1, 3, 5, ... of RPT, and in R7H in passes 2, 4, 6, ..."""
    total, product = (7, 6) if cpu.passes & 1 else (3, 2)
    address = cpu.xar[7]
    cpu.xar[7] = address + 2 & M32
    factor = cpu.program16(address & ~1) | cpu.program16(address | 1) << 16
    add(cpu, total, cpu.r[total], cpu.r[product])
    multiply(cpu, product, cpu.read32(), factor)


# Compare ------------------------------------------------------------------------------------------------------------


def CMPF32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    compare(cpu, cpu.r[f.p], value_of(cpu, f, f.q))


def clean(bits: int) -> int:
    """Return the value that MAXF32 and MINF32 write: infinity for NaN, +0 for a zero or a denormal."""
    if is_infinite(bits):
        return bits & SIGN | INFINITY
    return 0 if is_zero(bits) else bits


def MAXF32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    """Set RaH to the maximum of RaH and the other operand; to the minimum if b = 1.

    If RaH changes and the form has a field r, copy RdH, as it was before, to RcH.
    """
    value = value_of(cpu, f, f.q)
    beside = cpu.r[f.t] if f.r >= 0 else 0
    difference = compare(cpu, cpu.r[f.p], value)
    changes: bool = difference > 0 if f.b == 1 else difference < 0
    if changes:
        cpu.r[f.p] = clean(value)
        if f.r >= 0:
            cpu.r[f.r] = beside


# Conversions --------------------------------------------------------------------------------------------------------


def F32TOI16_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = to_integer(cpu.r[f.q], -0x8000, 0x7FFF, f.s >= 0) & M32


def F32TOI32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = to_integer(cpu.r[f.q], -SIGN, SIGN - 1) & M32


def F32TOUI16_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = to_integer(cpu.r[f.q], 0, M16, f.s >= 0)


def F32TOUI32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = to_integer(cpu.r[f.q], 0, M32)


def FRACF32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = fraction(cpu.r[f.q])


def integer(cpu: Cpu, f: Operation) -> int:
    """Return RbH or, if the form has no field q, the operand in memory."""
    return cpu.r[f.q] if f.q >= 0 else cpu.read32() if f.wide else cpu.read16()


def I16TOF32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = from_integer(s16(integer(cpu, f) & M16), nearest(cpu))


def I32TOF32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = from_integer(s32(integer(cpu, f)), nearest(cpu))


def UI16TOF32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = from_integer(integer(cpu, f) & M16, nearest(cpu))


def UI32TOF32_RaH_RbH(cpu: Cpu, f: Operation) -> None:
    cpu.r[f.p] = from_integer(integer(cpu, f), nearest(cpu))


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name. Raise KeyError if this module has no such function."""
    f.execute = globals()[name]
