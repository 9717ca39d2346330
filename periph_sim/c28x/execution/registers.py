"""Registers of the C28x, and access to the operands that an operand field encodes.

    locate(field)   address of the operand, and the mode's effect on address registers, in D2
    read16, write   the operand itself: memory at that address, or the register that the field names
    load16, store16 memory access; a chip with a bus overrides them

Values are unsigned integers of their width. Source: SPRU430F chapters 2 and 5; SPRUEO2A chapter 2.
"""

# core: compiled

from __future__ import annotations

from typing import Annotated

from ...core.state import State
from ...form.c_types import CFunction
from ..encodings import Encoding

M16, M32 = 0xFFFF, 0xFFFF_FFFF
HIGH16 = 0xFFFF_0000
CODE = 0x3F_FFFF  # bits of a program address
SIGN16, SIGN32 = 1 << 15, 1 << 31
ACC_UNIT = 1 << 32  # weight of bit 0 of ACC in ACC:P

ST1_RESET = 0x0A0B  # as the boot ROM leaves it: OBJMODE, M0M1MAP, VMAP, DBGM, INTM
SP_RESET = 0x400
ARP, ARP_MASK = 13, 0xE000  # of ST1
SPA = 1 << 4
READ_ONLY = 0x00A0  # LOOP and IDLESTAT

# STF
LVF, LUF, NF, ZF, NI, ZI, TF, RND32 = (1 << bit for bit in (0, 1, 2, 3, 4, 5, 6, 9))
STF_WRITTEN = LVF | LUF | NF | ZF | NI | ZI | TF | RND32
SHDWS = 1 << 31

READS, WRITES = 1, 2
REGISTER = -1  # in place of an address: the field names a register


Execute = CFunction[["Cpu", "Operation"], None]


class IllegalOperation(Exception):
    """An operation that this CPU refuses; the message gives the reason, without the address."""


class Operation:
    """One decoded instruction, ready to execute: the values of its fields by the table's letters, -1 if absent.

    next: the address after it. cycles, not_taken: from the table; repeated: of N + 1 passes, less N, 0 if not
    repeatable. wide: its operand has 32 bits. byte: its operand is a byte. place: its address, until its words are
    overwritten. following, goal: the operation executed after it, and its last jump target. accesses: READS, WRITES,
    both or 0, at its operand's address. absolute: likewise at *(0:16). needs, makes: registers needed early and written
    late, at_once: memory written in the first cycle, see `hazards`. jumps: it may branch; loops: it closes a loop by a
    branch. late: FPU registers written one instruction later, as bits; plain: the effect alone, if `execute` models
    that delay. waited: it is in memory with wait states. tested: the bits of its operand that it tests, if it names
    them. block, block_end: address range of the memory block of its data accesses.
    """

    __slots__ = (
        "absolute", "accesses", "address", "at_once", "b", "block", "block_end", "byte", "c", "cycles", "encoding",
        "execute", "following", "g", "goal", "h", "i", "jumps", "k", "l", "late", "loops", "m", "makes", "n", "needs",
        "next", "not_taken", "p", "place", "plain", "q", "r", "repeated", "s", "t", "tested", "u", "v", "w", "waited",
        "wide", "x", "y", "z",
    )  # fmt: skip

    b: int
    c: int
    g: int
    h: int
    i: int
    k: int
    l: int  # noqa: E741
    m: int
    n: int
    p: int
    q: int
    r: int
    s: int
    t: int
    u: int
    v: int
    w: int
    x: int
    y: int
    z: int
    absolute: int
    accesses: int
    address: int
    at_once: bool
    block: int
    block_end: int
    byte: bool
    cycles: int
    encoding: Encoding
    execute: Execute
    jumps: bool
    late: int
    loops: bool
    makes: int
    needs: int
    following: Operation | None
    goal: Operation | None
    next: int
    not_taken: int
    place: int
    plain: Execute
    repeated: int
    tested: int
    waited: bool
    wide: bool


class Cpu:
    """xar: XAR0 to XAR7. ovc: -32 to 31. pm: as in ST0. r: R0H to R7H as bits. pc: address of the next instruction.

    st1: without ARP, which is `arp`. ea: address of the current operand. high_byte: it is the upper byte there.
    cycles: of the current instruction; written_in: in which of them, from 1 on, its writes leave D2. repeat: repeat
    count of the next one, -1 for none. due: see `fpu_pipeline`.
    """

    STATE = State(
        "acc p xt xar dp rpc arp sp pc sxm ovm tc c z n v pm ovc st1 ier ifr dbgier dbgstat r stf "
        "shadow_r shadow_stf due due_flags due_r before_r rb ea field high_byte cycles written_in repeat "
        "passes",
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
        self.ea = REGISTER
        self.field = 0
        self.high_byte = False
        self.cycles = self.written_in = 0
        self.repeat = -1
        self.passes = 0  # passes done of the current RPT

    # Memory, overridden by a chip ---------------------------------------------------

    def load16(self, address: int) -> int:
        raise NotImplementedError

    def store16(self, address: int, value: int) -> None:
        raise NotImplementedError

    def load32(self, address: int) -> int:
        low = address & ~1
        return self.load16(low) | self.load16(low + 1) << 16

    def store32(self, address: int, value: int) -> None:
        low = address & ~1
        self.store16(low, value & M16)
        self.store16(low + 1, value >> 16)

    def program16(self, address: int) -> int:
        """Read program space, which is the same memory."""
        return self.load16(address & CODE)

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
        """Write ST1; LOOP and IDLESTAT are read-only."""
        self.st1 = value & ~READ_ONLY | self.st1 & READ_ONLY
        self.arp = value >> ARP & 7

    def change_st1(self, mask: int, on: bool) -> None:
        """Set or clear bits of ST1 by an instruction."""
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
        """Set OVC from 6 bits, signed."""
        self.ovc = ((value & 0x3F) ^ 0x20) - 0x20

    def nz16(self, value: int) -> None:  # core: C only
        self.n, self.z = value >> 15, int(value == 0)

    def nz32(self, value: int) -> None:  # core: C only
        self.n, self.z = value >> 31, int(value == 0)

    def condition(self, code: int) -> bool:  # core: C only
        """Evaluate COND [SPRU430F Table 2-10]. Testing V clears it."""
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
        """Write the lower half of XARn; keep the upper one."""
        self.xar[n] = self.xar[n] & HIGH16 | value & M16

    def acc_p(self) -> int:
        """Return ACC:P, signed."""
        return s32(self.acc) * ACC_UNIT | self.p

    def put_acc_p(self, value: int) -> None:  # core: C only
        """Write ACC:P and its flags; bits above 63 are dropped."""
        self.acc, self.p = value >> 32 & M32, value & M32
        self.n, self.z = self.acc >> 31, int(not self.acc | self.p)

    def x16(self, value: int) -> int:  # core: C only
        """Extend 16 bits to 32 according to SXM."""
        return value | HIGH16 if self.sxm and value & SIGN16 else value

    def psh(self) -> int:  # core: C only
        """Return P shifted by PM, to 32 bits."""
        if self.pm == 0:
            return self.p << 1 & M32
        return s32(self.p) >> self.pm - 1 & M32

    # Operands -----------------------------------------------------------------------

    def locate(self, f: Operation) -> None:  # core: C only
        """Set `ea` from the operand field, and apply its mode's effects [SPRU430F Table 5-1]."""
        self.field = field = f.l
        self.high_byte = False
        step = 2 if f.wide else 1
        if field < 0x40:
            self.ea = self.dp << 6 & 0x3F_FFFF | field
        elif field < 0x80:
            self.ea = self.sp - (field & 0x3F) & M16
        elif field >= 0xC0:
            self._at_xar(field & 7, field >> 3 & 7, f.byte)
        elif field < 0xA0:
            self._by_xar(field & 7, field >> 3 & 3, step, f.byte)
        elif field < 0xAE:
            self.ea = REGISTER
        else:
            self._by_arp(field, step)

    def _at_xar(self, n: int, offset: int, byte: bool) -> None:
        self.arp = n
        if byte:
            self.high_byte, offset = bool(offset & 1), offset >> 1
        self.ea = self.xar[n] + offset & M32

    def _by_xar(self, n: int, mode: int, step: int, byte: bool) -> None:
        if mode >= 2:
            self._at_xar(n, self.xar[mode - 2] & M16, byte)
            return
        self.arp = n
        if mode == 0:
            self.ea = self.xar[n]
            self.xar[n] = self.ea + step & M32
        else:
            self.ea = self.xar[n] = self.xar[n] - step & M32

    def _by_arp(self, field: int, step: int) -> None:
        xar, n = self.xar, self.arp
        if field < 0xBD:
            self.ea = xar[n]
        if field in (0xAE, 0xAF):
            low = reversed_carry(self.ea & M16, xar[0] & M16, field == 0xAF)
            xar[n] = self.ea & HIGH16 | low
        elif field < 0xB8:
            self.arp = field & 7
        elif field in (0xB9, 0xBA):
            xar[n] = self.ea + (step if field == 0xB9 else -step) & M32
        elif field in (0xBB, 0xBC):
            index = xar[0] & M16
            xar[n] = self.ea + (index if field == 0xBB else -index) & M32
        elif field == 0xBD:
            self.ea = self.sp
            self.sp = self.sp + step & M16
        elif field == 0xBE:
            self.ea = self.sp = self.sp - step & M16
        elif field == 0xBF:
            self.ea = xar[6]
            low = self.ea & 0xFF00 if (self.ea ^ xar[1]) & 0xFF == 0 else self.ea + step & M16
            xar[6] = self.ea & HIGH16 | low
            self.arp = 6

    def read16(self) -> int:  # core: C only
        if self.ea >= 0:
            return self.load16(self.ea)
        field = self.field
        if field < 0xA8:
            return self.xar[field & 7] & M16
        match field:
            case 0xA8:
                return self.acc >> 16
            case 0xA9:
                return self.acc & M16
            case 0xAA:
                return self.p >> 16
            case 0xAB:
                return self.p & M16
            case 0xAC:
                return self.xt >> 16
        return self.sp

    def write16(self, value: int) -> None:  # core: C only
        if self.ea >= 0:
            self.store16(self.ea, value)
            return
        field = self.field
        if field < 0xA8:
            self.put_ar(field & 7, value)
        elif field in (0xA8, 0xA9):
            self.put_ax(0xA9 - field, value)
        elif field == 0xAA:
            self.p = self.p & M16 | value << 16
        elif field == 0xAB:
            self.p = self.p & HIGH16 | value
        elif field == 0xAC:
            self.put_t(value)
        else:
            self.sp = value

    def read32(self) -> int:  # core: C only
        if self.ea >= 0:
            return self.load32(self.ea)
        field = self.field
        if field < 0xA8:
            return self.xar[field & 7]
        return self.acc if field < 0xAA else self.p if field < 0xAC else self.xt

    def write32(self, value: int) -> None:  # core: C only
        if self.ea >= 0:
            self.store32(self.ea, value)
            return
        field = self.field
        if field < 0xA8:
            self.xar[field & 7] = value
        elif field < 0xAA:
            self.acc = value
        elif field < 0xAC:
            self.p = value
        else:
            self.xt = value

    def beside(self, words: int) -> int:  # core: C only
        """Return the address `words` after the operand's."""
        if self.ea < 0:
            raise IllegalOperation("the operand is a register, but the instruction also writes the next address")
        return self.ea + words & M32

    def move16(self, value: int) -> None:  # core: C only
        """Write the operand; set N and Z if it is AL or AH (nz@AX)."""
        self.write16(value)
        if self.ea < 0 and self.field in (0xA8, 0xA9):
            self.nz16(value)

    def move32(self, value: int) -> None:  # core: C only
        """Write the operand; set N and Z if it is ACC (nz@ACC)."""
        self.write32(value)
        if self.ea < 0 and self.field in (0xA8, 0xA9):
            self.nz32(value)

    # Control, overridden by a chip with time and interrupts -------------------------

    def enter(self, vector: int) -> None:
        """Enter the service routine of a vector number, returning to `pc`."""
        raise IllegalOperation(f"vector {vector} is entered, but this CPU has no interrupts")

    def intr_clears_flag(self, bit: int) -> bool:
        """Return True if INTR clears this bit of IFR."""
        return True

    def leave(self) -> None:
        """Return from a service routine."""
        raise IllegalOperation("IRET is reached, but this CPU has no interrupts")

    def idle(self) -> None:
        """Sleep until an interrupt."""
        raise IllegalOperation("IDLE is reached, but nothing can wake this CPU")

    def stop(self) -> None:
        """Stop the program."""
        raise IllegalOperation("ESTOP0 is reached")

    # The stack ----------------------------------------------------------------------

    def push16(self, value: int) -> None:  # core: C only
        self.store16(self.sp, value)
        self.sp = self.sp + 1 & M16

    def pop16(self) -> int:  # core: C only
        self.sp = self.sp - 1 & M16
        return self.load16(self.sp)

    def push32(self, value: int) -> None:  # core: C only
        self.store32(self.sp, value)
        self.sp = self.sp + 2 & M16

    def pop32(self) -> int:  # core: C only
        self.sp = self.sp - 2 & M16
        return self.load32(self.sp)

    def push_pair(self, low: int, high: int) -> None:  # core: C only
        """Push two words at SP, for either parity."""
        self.push16(low)
        self.push16(high)

    def pop_pair(self) -> int:  # core: C only
        """Pop two words, for either parity of SP; the first one is the lower half."""
        high = self.pop16()
        return self.pop16() | high << 16


def s16(value: int) -> int:  # core: noexcept
    return (value ^ SIGN16) - SIGN16


def s32(value: int) -> int:  # core: noexcept
    return (value ^ SIGN32) - SIGN32


def reversed_carry(low: int, index: int, subtract: bool) -> int:  # core: noexcept
    """Add or subtract 16 bits with the carry propagating from bit 15 to bit 0."""
    first, second = mirrored(low), mirrored(index)
    return mirrored((first - second if subtract else first + second) & M16)


def mirrored(value: int) -> int:  # core: noexcept
    """Reverse the order of 16 bits."""
    value = (value & 0x5555) << 1 | value >> 1 & 0x5555
    value = (value & 0x3333) << 2 | value >> 2 & 0x3333
    value = (value & 0x0F0F) << 4 | value >> 4 & 0x0F0F
    return (value & 0x00FF) << 8 | value >> 8
