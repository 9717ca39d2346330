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

INTM, DBGM, PAGE0, VMAP = 1 << 0, 1 << 1, 1 << 2, 1 << 3  # masks of bits of ST1
EALLOW_BIT, AMODE, OBJMODE, M0M1MAP, XF = 1 << 6, 1 << 8, 1 << 9, 1 << 11, 1 << 12
RA, RC = 1 << 30, M16  # masks of fields of RB: RA is 1 while RPTB repeats a block; RC is the repeat count
RSIZE, RE = 23, 16  # lowest bits of fields of RB: the size and the end address of the block


def NOP_indind(cpu: Cpu, f: Operation) -> None:
    """Do nothing: the only effect is that of the addressing mode on address registers, in `Cpu.locate`."""


def ESTOP0(cpu: Cpu, f: Operation) -> None:
    cpu.stop()


def ABORTI(cpu: Cpu, f: Operation) -> None:
    cpu.change_st1(DBGM, True)


def IDLE(cpu: Cpu, f: Operation) -> None:
    cpu.idle()


# Status bits --------------------------------------------------------------------------------------------------------


def EALLOW(cpu: Cpu, f: Operation) -> None:
    cpu.change_st1(EALLOW_BIT, True)


def EDIS(cpu: Cpu, f: Operation) -> None:
    cpu.change_st1(EALLOW_BIT, False)


def _status(cpu: Cpu, mask: int, on: int) -> None:
    """Set (on = 1) or clear status bits. mask: its bits 0 to 7 are SXM, OVM, TC, C, INTM, DBGM, PAGE0 and VMAP."""
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


def SETC_mode(cpu: Cpu, f: Operation) -> None:
    _status(cpu, f.y, 1)


def CLRC_mode(cpu: Cpu, f: Operation) -> None:
    _status(cpu, f.y, 0)


def CLRC_AMODE(cpu: Cpu, f: Operation) -> None:
    cpu.change_st1(AMODE, False)


def SETC_AMODE(cpu: Cpu, f: Operation) -> None:
    raise IllegalOperation("SETC AMODE selects the operand modes of the C2xLP")


def SETC_OBJMODE(cpu: Cpu, f: Operation) -> None:
    cpu.change_st1(OBJMODE, True)


def CLRC_OBJMODE(cpu: Cpu, f: Operation) -> None:
    raise IllegalOperation("CLRC OBJMODE selects the instructions of the C27x")


def SETC_M0M1MAP(cpu: Cpu, f: Operation) -> None:
    cpu.change_st1(M0M1MAP, True)


def CLRC_M0M1MAP(cpu: Cpu, f: Operation) -> None:
    raise IllegalOperation("CLRC M0M1MAP selects the memory map of the C27x")


def SETC_XF(cpu: Cpu, f: Operation) -> None:
    cpu.change_st1(XF, True)


def CLRC_XF(cpu: Cpu, f: Operation) -> None:
    cpu.change_st1(XF, False)


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
    cpu.repeat = f.c


def RPT_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.repeat = cpu.read16()


def _begin_block(cpu: Cpu, f: Operation, count: int) -> None:
    """Set RB so that a block is repeated `count` times. The block consists of the f.z words after this instruction."""
    end = f.address + 1 + f.z & 0x7F
    cpu.rb = (RA if count else 0) | f.z << RSIZE | end << RE | count


def RPTB_label_RC(cpu: Cpu, f: Operation) -> None:
    _begin_block(cpu, f, f.c)


def RPTB_label_loc16(cpu: Cpu, f: Operation) -> None:
    _begin_block(cpu, f, cpu.read16())


def LOOPZ_loc16_16(cpu: Cpu, f: Operation) -> None:
    _look_again(cpu, f, cpu.read16() & f.c, False)


def LOOPNZ_loc16_16(cpu: Cpu, f: Operation) -> None:
    _look_again(cpu, f, cpu.read16() & f.c, True)


def _look_again(cpu: Cpu, f: Operation, value: int, until_zero: bool) -> None:
    """Execute one pass of LOOPZ or LOOPNZ; interrupts can be taken between two passes.

    until_zero: True if the loop ends when `value` is 0, False if it ends when `value` is not 0.
    """
    cpu.nz16(value)
    if (value == 0) != until_zero:
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
