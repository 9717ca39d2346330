"""Instructions for status bits, interrupts and repeats, and instructions that stop the CPU or do nothing.

A form is one encoding of an instruction, a row of `encodings.toml`. The function named like the row executes the form.
Stopping a program and entering or leaving a service routine are methods of `Cpu`, which a chip overrides.
Source: SPRU430F chapters 3 and 6, SPRUEO2A chapter 4 (RPTB).
"""

# core: compiled

from __future__ import annotations

from .cpu import Cpu, Operation
from .registers import M16, IllegalOperation

__all__ = ("bind",)  # when compiled, only `bind` is visible from Python; it finds the other functions by name

RA, RC = 1 << 30, M16  # masks of fields of RB: RA is 1 while RPTB repeats a block; RC is the repeat count
RSIZE, RE = 23, 16  # lowest bits of fields of RB: the size and the end address of the block


def NOP_indind(cpu: Cpu, f: Operation) -> None:
    """Do nothing: the only effect is that of the addressing mode on address registers, in `Cpu.locate`."""


def ESTOP0(cpu: Cpu, f: Operation) -> None:
    cpu.stop()


def IDLE(cpu: Cpu, f: Operation) -> None:
    cpu.idle()


# Status bits --------------------------------------------------------------------------------------------------------


def SETC_bit(cpu: Cpu, f: Operation) -> None:
    """Set (c = 1) or clear (c = 0) bit b of ST1."""
    cpu.change_st1(1 << f.b, bool(f.c))


def SETC_mode(cpu: Cpu, f: Operation) -> None:
    """Set (c = 1) or clear (c = 0) status bits: bits 0 to 7 of y are SXM, OVM, TC, C, INTM, DBGM, PAGE0 and VMAP."""
    mask, on = f.y, f.c
    if mask & 1:
        cpu.sxm = on
    if mask & 2:
        cpu.ovm = on
    if mask & 4:
        cpu.tc = on
    if mask & 8:
        cpu.c = on
    if mask & 0x40 and on:
        raise IllegalOperation("SETC PAGE0 selects an operand mode of the C27x")
    if mask >> 4:
        cpu.change_st1(mask >> 4, bool(on))


def SETC_AMODE(cpu: Cpu, f: Operation) -> None:
    raise IllegalOperation("SETC AMODE selects the operand modes of the C2xLP")


def CLRC_OBJMODE(cpu: Cpu, f: Operation) -> None:
    raise IllegalOperation("CLRC OBJMODE selects the instructions of the C27x")


def CLRC_M0M1MAP(cpu: Cpu, f: Operation) -> None:
    raise IllegalOperation("CLRC M0M1MAP selects the memory map of the C27x")


# Interrupts ---------------------------------------------------------------------------------------------------------


def AND_IER_16(cpu: Cpu, f: Operation) -> None:
    cpu.put_ier(cpu.whole_ier() & f.c)


def OR_IER_16(cpu: Cpu, f: Operation) -> None:
    cpu.put_ier(cpu.whole_ier() | f.c)


def MOV_IER_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.put_ier(cpu.read16())


def MOV_loc16_IER(cpu: Cpu, f: Operation) -> None:
    cpu.move16(cpu.whole_ier())


def AND_IFR_16(cpu: Cpu, f: Operation) -> None:
    cpu.and_ifr(f.c)


def OR_IFR_16(cpu: Cpu, f: Operation) -> None:
    cpu.put_ifr(cpu.whole_ifr() | f.c)


def TRAP_0_31(cpu: Cpu, f: Operation) -> None:
    cpu.enter(f.c)


def INTR_INTx(cpu: Cpu, f: Operation) -> None:
    if cpu.intr_clears_flag(f.c):
        cpu.put_ifr(cpu.whole_ifr() & ~(1 << f.c))
    saved = cpu.whole_ier()
    cpu.enter(f.c + 1)
    cpu.put_ier(saved & ~(1 << f.c))


def IRET(cpu: Cpu, f: Operation) -> None:
    cpu.leave()


# Repeats ------------------------------------------------------------------------------------------------------------


def RPT_8(cpu: Cpu, f: Operation) -> None:
    cpu.repeat = cpu.value16(f)


def RPTB_label_RC(cpu: Cpu, f: Operation) -> None:
    """Set RB so that a block is repeated. The block consists of the f.z words after this instruction."""
    count = cpu.value16(f)
    end = f.address + 1 + f.z & 0x7F
    cpu.rb = (RA if count else 0) | f.z << RSIZE | end << RE | count


def LOOPZ_loc16_16(cpu: Cpu, f: Operation) -> None:
    """Execute one pass of LOOPZ (b = 0) or LOOPNZ (b = 1); interrupts can be taken between two passes."""
    value = cpu.read16() & f.c
    cpu.nz16(value)
    if (value == 0) != (f.b == 1):
        cpu.pc = f.address


# Not available on the F28335 ---------------------------------------------------------------------------------------


def IN_loc16_ind_PA(cpu: Cpu, f: Operation) -> None:
    raise IllegalOperation(f"{f.encoding.mnemonic} accesses I/O space, which the F28335 does not have")


def ITRAP0(cpu: Cpu, f: Operation) -> None:
    raise IllegalOperation("0x0000 is the illegal instruction: data was executed, or memory that was not loaded")


def ITRAP1(cpu: Cpu, f: Operation) -> None:
    raise IllegalOperation("0xFFFF is the illegal instruction: erased flash was executed")


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name. Raise KeyError if this module has no such function."""
    f.execute = globals()[name]
