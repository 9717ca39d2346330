"""Moves between registers and memory, and arithmetic of address registers.

A form is one encoding of an instruction, a row of `encodings.toml`. The function named like the row executes the form.
Forms that differ only in the address register have one function: `MOVL_XARn_22` executes `MOVL_XAR6_22` with n = 6.
Source: SPRU430F chapter 6; section 5.8 (addresses that increase in each pass of RPT).
"""

# core: compiled

from __future__ import annotations

from .accumulator import logic, shifted16
from .cpu import Cpu, Operation
from .registers import HIGH16, M16, M32, PMA, s16

__all__ = ("bind",)  # when compiled, only `bind` is visible from Python; it finds the other functions by name


def MOV_ind_0_16_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.store16(f.c + cpu.passes & M16, cpu.read16())


def MOV_loc16_ind_0_16(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.load16(f.c + cpu.passes & M16))


def MOV_loc16_ACCsh2_8(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.acc << f.s + 1 & M16)


def MOVH_loc16_ACCsh2_8(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.acc << f.s + 1 >> 16 & M16)


def MOV_loc16_ARn(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.xar[f.n] & M16)


def MOV_loc16_AX(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.source16(f))


def MOV_loc16_AX_COND(cpu: Cpu, f: Operation) -> None:
    if cpu.condition(f.k):
        cpu.move16(cpu.source16(f))


def MOVL_loc32_ACC_COND(cpu: Cpu, f: Operation) -> None:
    if cpu.condition(f.k):
        cpu.move32(cpu.acc)


def MOV_loc16_T(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.t())


def MOV_ARn_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.put_ar(f.n, cpu.value16(f))


def MOV_PH_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.p = cpu.p & M16 | cpu.read16() << 16


def MOV_PL_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.p = cpu.p & HIGH16 | cpu.read16()


def MOV_T_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.put_t(cpu.read16())


def MOV_TL_0(cpu: Cpu, f: Operation) -> None:
    cpu.xt &= HIGH16


def MOVX_TL_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.xt = s16(cpu.read16()) & M32


def MOV_XARn_PC(cpu: Cpu, f: Operation) -> None:
    cpu.xar[f.n] = f.address


def MOV_DP_10(cpu: Cpu, f: Operation) -> None:
    cpu.dp = cpu.dp & ~0x3FF | f.c


def MOVW_DP_16(cpu: Cpu, f: Operation) -> None:
    cpu.dp = f.c


def MOVL_loc32_ACC(cpu: Cpu, f: Operation) -> None:
    cpu.move32(cpu.acc)


def MOVL_loc32_P(cpu: Cpu, f: Operation) -> None:
    cpu.move32(cpu.p)


def MOVL_loc32_XT(cpu: Cpu, f: Operation) -> None:
    cpu.move32(cpu.xt)


def MOVL_P_ACC(cpu: Cpu, f: Operation) -> None:
    cpu.p = cpu.acc


def MOVL_P_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.p = cpu.read32()


def MOVL_XT_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.xt = cpu.read32()


def MOVDL_XT_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.xt = cpu.read32()
    cpu.store32(cpu.beside(2), cpu.xt)


def DMOV_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.store16(cpu.beside(1), cpu.read16())


def MOVL_XARn_loc32(cpu: Cpu, f: Operation) -> None:
    cpu.xar[f.n] = cpu.read32()


def MOVL_loc32_XARn(cpu: Cpu, f: Operation) -> None:
    cpu.move32(cpu.xar[f.n])


def MOVL_XARn_22(cpu: Cpu, f: Operation) -> None:
    cpu.xar[f.n] = cpu.value16(f)


# OVC and PM ---------------------------------------------------------------------------------------------------------


def MOV_loc16_OVC(cpu: Cpu, f: Operation) -> None:
    cpu.move16((cpu.ovc & 0x3F) << f.s)


def MOV_OVC_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.put_ovc(cpu.read16() >> f.s)


def ZAP_OVC(cpu: Cpu, f: Operation) -> None:
    cpu.ovc = 0


def MOV_PM_AX(cpu: Cpu, f: Operation) -> None:
    cpu.pm = cpu.ax(f.x) & 7


def SPM_pm(cpu: Cpu, f: Operation) -> None:
    cpu.pm = f.s


# Address registers --------------------------------------------------------------------------------------------------


def ADDB_XARn_7(cpu: Cpu, f: Operation) -> None:
    cpu.xar[f.n] = cpu.xar[f.n] + f.c & M32


def SUBB_XARn_7(cpu: Cpu, f: Operation) -> None:
    cpu.xar[f.n] = cpu.xar[f.n] - f.c & M32


def ADDB_SP_7(cpu: Cpu, f: Operation) -> None:
    cpu.sp = cpu.sp + f.c & M16


def SUBB_SP_7(cpu: Cpu, f: Operation) -> None:
    cpu.sp = cpu.sp - f.c & M16


def ADRK_8(cpu: Cpu, f: Operation) -> None:
    cpu.xar[cpu.arp] = cpu.xar[cpu.arp] + f.c & M32


def SBRK_8(cpu: Cpu, f: Operation) -> None:
    cpu.xar[cpu.arp] = cpu.xar[cpu.arp] - f.c & M32


def compared(cpu: Cpu) -> int:
    """Return AR(ARP) - AR0."""
    return (cpu.xar[cpu.arp] & M16) - (cpu.xar[0] & M16)


def CMPR_0(cpu: Cpu, f: Operation) -> None:
    cpu.tc = int(compared(cpu) == 0)


def CMPR_1(cpu: Cpu, f: Operation) -> None:
    cpu.tc = int(compared(cpu) < 0)


def CMPR_2(cpu: Cpu, f: Operation) -> None:
    cpu.tc = int(compared(cpu) > 0)


def CMPR_3(cpu: Cpu, f: Operation) -> None:
    cpu.tc = int(compared(cpu) != 0)


# Program space ------------------------------------------------------------------------------------------------------


def PREAD_loc16_indXAR7(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.program16(cpu.xar[7] + cpu.passes))


def PWRITE_indXAR7_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.store16(cpu.xar[7] + cpu.passes & 0x3F_FFFF, cpu.read16())


def XPREAD_loc16_ind_pma(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.program16(PMA | f.c + cpu.passes & M16))


def XPREAD_loc16_indAL(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.program16(PMA | cpu.ax(0) + cpu.passes & M16))


def XPWRITE_indAL_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.store16(PMA | cpu.ax(0) + cpu.passes & M16, cpu.read16())


# Moves to ACC -------------------------------------------------------------------------------------------------------


def MOV_ACC_16sh_0_15(cpu: Cpu, f: Operation) -> None:
    logic(cpu, shifted16(cpu, f))


def MOVU_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.read16())


def MOVL_ACC_loc32(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.read32())


def ZALR_ACC_loc16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, cpu.read16() << 16 | 0x8000)


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name. Raise KeyError if this module has no such function."""
    f.execute = globals()[name]
