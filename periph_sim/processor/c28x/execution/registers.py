"""Registers of the C28x: their values, the bits of ST0 and ST1, conditions, and parts of registers.

Values are unsigned integers of their width. Source: SPRU430F chapter 2; SPRUEO2A chapter 2.
"""

# core: compiled

from __future__ import annotations

from typing import Annotated

from ....core.state import State

M16, M32 = 0xFFFF, 0xFFFF_FFFF
HIGH16 = 0xFFFF_0000
CODE = 0x3F_FFFF  # mask of the bits of a program address
PMA = 0x3F_0000  # the upper bits of program addresses in C2xLP instructions
SIGN16, SIGN32 = 1 << 15, 1 << 31
ACC_UNIT = 1 << 32  # weight of bit 0 of ACC in ACC:P

ST1_RESET = 0x0A0B  # value of ST1 after the boot ROM's program: OBJMODE, M0M1MAP, VMAP, DBGM and INTM are 1
SP_RESET = 0x400
ARP, ARP_MASK = 13, 0xE000  # lowest bit and mask of the field ARP in ST1
SPA = 1 << 4
READ_ONLY = 0x00A0  # mask of LOOP and IDLESTAT in ST1

# Masks of the bits of STF, the status register of the FPU.
LVF, LUF, NF, ZF, NI, ZI, TF, RND32 = (1 << bit for bit in (0, 1, 2, 3, 4, 5, 6, 9))
STF_WRITTEN = LVF | LUF | NF | ZF | NI | ZI | TF | RND32
SHDWS = 1 << 31


class IllegalOperation(Exception):
    """Raised if an instruction cannot be executed. The message gives the reason, without the address."""


class Registers:
    """The registers of a CPU. The fields of ST0 are separate attributes.

    xar: XAR0 to XAR7.
    ovc: the overflow counter, -32 to 31.
    pm: the product shift mode, coded as in ST0.
    r, shadow_r: R0H to R7H, and their shadow registers, as the bits of float32 numbers.
    pc: the address of the next instruction.
    st1: ST1; its field ARP is not used, because `arp` has it.
    due: mask of the FPU registers that have a pending late result (see `delay_slots`).
    due_r: the pending results, by the number of the register.
    due_flags: the flags LUF and LVF that are set together with the pending results.
    before_r: R0H to R7H before the present instruction; only `delay_slots` uses it.
    """

    STATE = State(
        "acc p xt xar dp rpc arp sp pc sxm ovm tc c z n v pm ovc st1 ier ifr dbgier dbgstat r stf "
        "shadow_r shadow_stf due due_flags due_r before_r rb",
    )

    xar: Annotated[list[int], 8]
    r: Annotated[list[int], 8]
    shadow_r: Annotated[list[int], 8]
    before_r: Annotated[list[int], 8]
    due_r: Annotated[list[int], 8]

    def __init__(self) -> None:
        self.acc = self.p = self.xt = 0
        self.xar = [0] * 8
        self.dp = self.rpc = self.arp = 0
        self.sp = SP_RESET
        self.pc = 0
        self.sxm = self.ovm = self.tc = self.c = self.z = self.n = self.v = 0
        self.pm = self.ovc = 0
        self.st1 = ST1_RESET
        self.ier = self.ifr = self.dbgier = self.dbgstat = 0
        self.r = [0] * 8
        self.stf = 0
        self.shadow_r = [0] * 8
        self.shadow_stf = 0
        self.due = self.due_flags = 0
        self.due_r = [0] * 8
        self.before_r = [0] * 8
        self.rb = 0

    # Status -------------------------------------------------------------------------

    def st0(self) -> int:
        flags = self.v << 6 | self.n << 5 | self.z << 4 | self.c << 3 | self.tc << 2 | self.ovm << 1 | self.sxm
        return (self.ovc & 0x3F) << 10 | self.pm << 7 | flags

    def put_st0(self, value: int) -> None:
        self.put_ovc(value >> 10)
        self.pm = value >> 7 & 7
        self.v, self.n, self.z, self.c = value >> 6 & 1, value >> 5 & 1, value >> 4 & 1, value >> 3 & 1
        self.tc, self.ovm, self.sxm = value >> 2 & 1, value >> 1 & 1, value & 1

    def whole_st1(self) -> int:
        return self.st1 & ~ARP_MASK | self.arp << ARP

    def put_st1(self, value: int) -> None:
        """Write ST1, except LOOP and IDLESTAT, which are read-only."""
        self.st1 = value & ~READ_ONLY | self.st1 & READ_ONLY
        self.arp = value >> ARP & 7

    def change_st1(self, mask: int, on: bool) -> None:
        """Set the bits of ST1 in `mask` if `on` is True, else clear them."""
        self.st1 = self.st1 | mask if on else self.st1 & ~mask

    def whole_ier(self) -> int:
        return self.ier

    def put_ier(self, value: int) -> None:
        self.ier = value & M16

    def whole_ifr(self) -> int:
        return self.ifr

    def put_ifr(self, value: int) -> None:
        self.ifr = value & M16

    def and_ifr(self, mask: int) -> None:
        self.put_ifr(self.ifr & mask)

    def put_ovc(self, value: int) -> None:  # core: C only
        """Set OVC to the low 6 bits of a value, as a signed number."""
        self.ovc = ((value & 0x3F) ^ 0x20) - 0x20

    def nz16(self, value: int) -> None:  # core: C only
        self.n, self.z = value >> 15, int(value == 0)

    def nz32(self, value: int) -> None:  # core: C only
        self.n, self.z = value >> 31, int(value == 0)

    def condition(self, code: int) -> bool:  # core: C only
        """Return True if COND with this code is true [SPRU430F Table 2-10]. A test of V clears V.

        Raise IllegalOperation for NBIO.
        """
        match code:
            case 0:
                return not self.z
            case 1:
                return bool(self.z)
            case 2:
                return not self.z and not self.n
            case 3:
                return not self.n
            case 4:
                return bool(self.n)
            case 5:
                return bool(self.z or self.n)
            case 6:
                return bool(self.c and not self.z)
            case 7:
                return bool(self.c)
            case 8:
                return not self.c
            case 9:
                return bool(not self.c or self.z)
            case 10 | 11:
                v, self.v = self.v, 0
                return bool(v) == (code == 11)
            case 12:
                return not self.tc
            case 13:
                return bool(self.tc)
            case 14:
                raise IllegalOperation("condition NBIO tests a pin that the F28335 does not have")
        return True

    # Parts of registers -------------------------------------------------------------

    def ax(self, x: int) -> int:  # core: C only
        return self.acc >> 16 * x & M16

    def put_ax(self, x: int, value: int) -> None:  # core: C only
        self.acc = self.acc & M16 | value << 16 if x else self.acc & HIGH16 | value

    def t(self) -> int:
        return self.xt >> 16

    def put_t(self, value: int) -> None:
        self.xt = self.xt & M16 | value << 16

    def put_ar(self, n: int, value: int) -> None:  # core: C only
        """Write the lower half of XARn, and keep the upper half."""
        self.xar[n] = self.xar[n] & HIGH16 | value & M16

    def acc_p(self) -> int:
        """Return ACC:P as a signed 64-bit number."""
        return s32(self.acc) * ACC_UNIT | self.p

    def put_acc_p(self, value: int) -> None:  # core: C only
        """Write the low 64 bits of a value to ACC:P, and set N and Z."""
        self.acc, self.p = value >> 32 & M32, value & M32
        self.n, self.z = self.acc >> 31, int(not self.acc | self.p)

    def x16(self, value: int) -> int:  # core: C only
        """Return a 16-bit value extended to 32 bits: with its sign if SXM is 1, else with zeros."""
        return value | HIGH16 if self.sxm and value & SIGN16 else value

    def psh(self) -> int:  # core: C only
        """Return the low 32 bits of P shifted as PM selects."""
        if self.pm == 0:
            return self.p << 1 & M32
        return s32(self.p) >> self.pm - 1 & M32


def s16(value: int) -> int:  # core: noexcept
    return (value ^ SIGN16) - SIGN16


def s32(value: int) -> int:  # core: noexcept
    return (value ^ SIGN32) - SIGN32
