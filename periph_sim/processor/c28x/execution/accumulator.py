"""Instructions for ACC and P: addition, subtraction, comparison and logic.

A form is one encoding of an instruction, a row of `encodings.toml`. The function named like the row executes the form.
Source: SPRU430F chapter 6; sections 2.3 (flags) and 2.2 (OVC).
"""

# core: compiled

from __future__ import annotations

from .cpu import Cpu, Operation
from .registers import M32, SIGN32, s32

__all__ = ("bind",)  # when compiled, only `bind` is visible from Python; it finds the other functions by name


def sum32(cpu: Cpu, a: int, b: int, carry: int = 0, saturates: bool = True) -> int:
    """Return a + b + carry, and set N, Z and C. After a signed overflow, return what `overflowed` returns."""
    total = a + b + carry
    result = total & M32
    cpu.c = total >> 32
    if ~(a ^ b) & (a ^ result) & SIGN32:
        result = overflowed(cpu, a, result, saturates)
    cpu.nz32(result)
    return result


def difference32(cpu: Cpu, a: int, b: int, borrow: int = 0, saturates: bool = True) -> int:
    """Return a - b - borrow, and set N, Z and C. After an overflow, return what `overflowed` returns.

    C is 0 if the subtraction of the unsigned numbers needs a borrow, otherwise 1.
    """
    total = a - b - borrow
    result = total & M32
    cpu.c = int(total >= 0)
    if (a ^ b) & (a ^ result) & SIGN32:
        result = overflowed(cpu, a, result, saturates)
    cpu.nz32(result)
    return result


def overflowed(cpu: Cpu, a: int, result: int, saturates: bool) -> int:
    """Set V after the overflow of a sum or difference, and return the value to use as its result.

    a: the first operand, whose sign is also the sign of the exact sum or difference.
    result: the low 32 bits of the exact sum or difference.
    saturates: False to return `result`. If it is True and OVM is 1, the limit of the signed range is returned. If it is
        True and OVM is 0, OVC counts the overflow, and `result` is returned.
    """
    cpu.v = 1
    upward = not a & SIGN32
    if not saturates:
        return result
    if cpu.ovm:
        return 0x7FFF_FFFF if upward else 0x8000_0000
    cpu.put_ovc(cpu.ovc + (1 if upward else -1))
    return result


def sum_ovcu(cpu: Cpu, a: int, b: int) -> int:
    """Return the unsigned sum a + b. A carry increments OVC; the sum is not saturated."""
    result = sum32(cpu, a, b, 0, False)
    cpu.put_ovc(cpu.ovc + cpu.c)
    return result


def difference_ovcu(cpu: Cpu, a: int, b: int) -> int:
    """Return the unsigned difference a - b. A borrow decrements OVC; the difference is not saturated."""
    result = difference32(cpu, a, b, 0, False)
    cpu.put_ovc(cpu.ovc - 1 + cpu.c)
    return result


def compared32(cpu: Cpu, a: int, b: int) -> None:
    """Set N, Z and C by a - b. N is the sign of the exact signed difference. C is 0 after an unsigned borrow."""
    cpu.n, cpu.z, cpu.c = int(s32(a) < s32(b)), int(a == b), int(a >= b)


def add(cpu: Cpu, value: int) -> None:
    cpu.acc = sum32(cpu, cpu.acc, value & M32)


def subtract(cpu: Cpu, value: int) -> None:
    cpu.acc = difference32(cpu, cpu.acc, value & M32)


def logic(cpu: Cpu, value: int) -> None:
    cpu.acc = value & M32
    cpu.nz32(cpu.acc)


def shifted16(cpu: Cpu, f: Operation) -> int:
    """Return a 16-bit operand extended to 32 bits and shifted by field s or, if the form has no field s, by T(3:0)."""
    return cpu.x16(cpu.value16(f)) << (f.s if f.s >= 0 else cpu.t() & 15)


# Add ----------------------------------------------------------------------------------------------------------------


def ADD_ACC_16sh_0_15(cpu: Cpu, f: Operation) -> None:
    add(cpu, shifted16(cpu, f))


def ADD_ACC_loc16sh_16(cpu: Cpu, f: Operation) -> None:
    before = cpu.c
    add(cpu, cpu.read16() << 16)
    cpu.c |= before


def ADDCL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.acc = sum32(cpu, cpu.acc, cpu.read32(), cpu.c)


def ADDCU_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.acc = sum32(cpu, cpu.acc, cpu.read16(), cpu.c)


def ADDL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    add(cpu, cpu.read32())


def ADDL_loc32_ACC(cpu: Cpu, f: Operation) -> None:
    cpu.write32(sum32(cpu, cpu.read32(), cpu.acc))


def ADDU_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    add(cpu, cpu.read16())


def ADDUL_P_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.p = sum_ovcu(cpu, cpu.p, cpu.read32())


def ADDUL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.acc = sum_ovcu(cpu, cpu.acc, cpu.read32())


# Subtract -----------------------------------------------------------------------------------------------------------


def SUB_ACC_loc16sh_16(cpu: Cpu, f: Operation) -> None:
    before = cpu.c
    subtract(cpu, cpu.read16() << 16)
    cpu.c &= before


def SUB_ACC_16sh_0_15(cpu: Cpu, f: Operation) -> None:
    subtract(cpu, shifted16(cpu, f))


def SBBU_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.acc = difference32(cpu, cpu.acc, cpu.read16(), 1 - cpu.c)


def SUBBL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.acc = difference32(cpu, cpu.acc, cpu.read32(), 1 - cpu.c)


def SUBL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    subtract(cpu, cpu.read32())


def SUBL_loc32_ACC(cpu: Cpu, f: Operation) -> None:
    cpu.write32(difference32(cpu, cpu.read32(), cpu.acc))


def SUBRL_loc32_ACC(cpu: Cpu, f: Operation) -> None:
    cpu.write32(difference32(cpu, cpu.acc, cpu.read32()))


def SUBU_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    subtract(cpu, cpu.read16())


def SUBUL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.acc = difference_ovcu(cpu, cpu.acc, cpu.read32())


def SUBUL_P_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.p = difference_ovcu(cpu, cpu.p, cpu.read32())


def SUBCU_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    """Execute one step of a division by an unsigned 16-bit number; the quotient is built in the low bits of ACC."""
    shifted = cpu.acc << 1
    rest = shifted - (cpu.read16() << 16)
    cpu.c = int(rest >= 0)
    logic(cpu, rest + 1 if rest >= 0 else shifted)


def SUBCUL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    """Execute one step of a division by an unsigned 32-bit number; the quotient is built in the low bits of P."""
    shifted = cpu.acc << 1 | cpu.p >> 31
    rest = shifted - cpu.read32()
    cpu.c = int(rest >= 0)
    cpu.p = cpu.p << 1 & M32 | cpu.c
    logic(cpu, rest if rest >= 0 else shifted)


# Compare, minimum, maximum ----------------------------------------------------------------------------------------


def CMPL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    compared32(cpu, cpu.acc, cpu.read32())


def CMPL_ACC_PshPM(cpu: Cpu, f: Operation) -> None:
    compared32(cpu, cpu.acc, cpu.psh())


def CMP64_ACC_P(cpu: Cpu, f: Operation) -> None:
    cpu.n, cpu.z, cpu.v = cpu.v ^ cpu.acc >> 31, int(cpu.acc_p() == 0), 0


def TEST_ACC(cpu: Cpu, f: Operation) -> None:
    cpu.nz32(cpu.acc)


def MAXL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    """Set ACC to the maximum of ACC and the operand; to the minimum if b = 1."""
    value = cpu.read32()
    compared32(cpu, cpu.acc, value)
    smaller, larger = (value, cpu.acc) if f.b == 1 else (cpu.acc, value)
    if s32(smaller) < s32(larger):
        cpu.acc, cpu.v = value, 1


def MAXCUL_P_loc32(cpu: Cpu, f: Operation) -> None:
    """Set P to the lower half of a 64-bit maximum. MAXL has compared the upper halves and set N and Z before."""
    value = cpu.read32()
    if cpu.n and not cpu.z:
        cpu.p = value
    elif not cpu.n and cpu.z and cpu.p < value:
        cpu.p, cpu.v = value, 1


def MINCUL_P_loc32(cpu: Cpu, f: Operation) -> None:
    value = cpu.read32()
    if not cpu.n and not cpu.z:
        cpu.p = value
    elif not cpu.n and cpu.z and cpu.p > value:
        cpu.p, cpu.v = value, 1


# Sign, saturation ---------------------------------------------------------------------------------------------------


def negate(cpu: Cpu, value: int) -> int:
    """Return -value. For the most negative value, set V, and return the most positive one if OVM is 1, else `value`."""
    if value == SIGN32:
        cpu.v = 1
        return 0x7FFF_FFFF if cpu.ovm else SIGN32
    return -value & M32


def ABS_ACC(cpu: Cpu, f: Operation) -> None:
    logic(cpu, negate(cpu, cpu.acc) if cpu.acc & SIGN32 else cpu.acc)
    cpu.c = 0


def ABSTC_ACC(cpu: Cpu, f: Operation) -> None:
    cpu.tc ^= cpu.acc >> 31
    ABS_ACC(cpu, f)


def NEG_ACC(cpu: Cpu, f: Operation) -> None:
    cpu.c = int(cpu.acc == 0)
    logic(cpu, negate(cpu, cpu.acc))


def NEGTC_ACC(cpu: Cpu, f: Operation) -> None:
    if cpu.tc:
        NEG_ACC(cpu, f)
    else:
        cpu.nz32(cpu.acc)


def NEG64_ACC_P(cpu: Cpu, f: Operation) -> None:
    cpu.c = int(not cpu.acc | cpu.p)
    if cpu.acc == SIGN32 and not cpu.p:  # the most negative value overflows
        cpu.v = 1
        if cpu.ovm:
            cpu.acc, cpu.p = 0x7FFF_FFFF, M32
        cpu.put_acc_p(cpu.acc_p())
    else:
        cpu.put_acc_p(-cpu.acc_p())


def SAT_ACC(cpu: Cpu, f: Operation) -> None:
    if cpu.ovc:
        cpu.acc = 0x7FFF_FFFF if cpu.ovc > 0 else SIGN32
    cpu.v, cpu.ovc, cpu.c = int(cpu.ovc != 0), 0, 0
    cpu.nz32(cpu.acc)


def SAT64_ACC_P(cpu: Cpu, f: Operation) -> None:
    if cpu.ovc > 0:
        cpu.acc, cpu.p = 0x7FFF_FFFF, M32
    elif cpu.ovc < 0:
        cpu.acc, cpu.p = SIGN32, 0
    cpu.v, cpu.ovc, cpu.c = int(cpu.ovc != 0), 0, 0
    cpu.put_acc_p(cpu.acc_p())


def ZAPA(cpu: Cpu, f: Operation) -> None:
    cpu.p = cpu.ovc = 0
    logic(cpu, 0)


# Logic --------------------------------------------------------------------------------------------------------------


def AND_ACC_16sh_0_15(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc & cpu.value16(f) << f.s)


def OR_ACC_16sh_0_15(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc | cpu.value16(f) << f.s)


def XOR_ACC_16sh_0_15(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.acc ^ cpu.value16(f) << f.s)


def NOT_ACC(cpu: Cpu, f: Operation) -> None:
    logic(cpu, ~cpu.acc)


def CSB_ACC(cpu: Cpu, f: Operation) -> None:
    """Set T to the number of equal leading bits of ACC minus one, and TC to the sign bit. Set N and Z by ACC."""
    cpu.tc = cpu.acc >> 31
    rest = cpu.acc ^ (M32 if cpu.tc else 0)
    count = 0
    while count < 31 and not rest >> 30 - count:
        count += 1
    cpu.put_t(count)
    cpu.nz32(cpu.acc)


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name. Raise KeyError if this module has no such function."""
    f.execute = globals()[name]
