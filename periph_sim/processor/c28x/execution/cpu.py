"""The CPU that executes an operation, a decoded instruction: access to its operands, to memory and to the stack.

    locate          finds the address of the operand, and applies the effects of the addressing mode
    read16, write16 access the operand: memory at this address, or the register that field l selects
    load16, store16 access memory; a subclass for a chip with a bus overrides them

Values are unsigned integers of their width. Source: SPRU430F chapters 2 and 5.
"""

# core: compiled

from __future__ import annotations

from ....core.state import State
from ....form.c_types import CFunction
from ..encodings import Encoding
from .registers import CODE, HIGH16, M16, M32, IllegalOperation, Registers

READS, WRITES = 1, 2
REGISTER = -1  # value of `Cpu.ea` for an operand that is a register

Execute = CFunction[["Cpu", "Operation"], None]


class Operation:
    """One decoded instruction, ready to execute.

    b to z: the values of the fields with these letters in `encodings.toml`; -1 for a field that the form does not have.
    address, next: the address of this instruction, and the address after its last word.
    place: equal to `address`; -1 after the words of the instruction were overwritten.
    cycles: the cycles of one execution; for a conditional jump, call or return, the cycles if it is taken.
    not_taken: the cycles of a conditional jump, call or return that is not taken; otherwise equal to `cycles`.
    repeated: R if RPT #N makes the CPU execute the instruction N + 1 times in N + R cycles; 0 if the instruction cannot
        be repeated.
    wide: True if the operand has 32 bits.
    byte: True if the operand is a byte.
    accesses: READS, WRITES, both or 0: the accesses to the operand that field l encodes.
    absolute: READS, WRITES or 0: the access to the operand *(0:16), whose address is in the instruction.
    following: the operation at `next`; None until that operation is executed after this one.
    goal: the operation to which this one has jumped last; None before its first jump.
    needs, makes: masks of the registers for which the pipeline waits, see `pipeline.hazards`.
    at_once: True if the write to memory passes phase D2 in the first cycle, see `pipeline.writes_at_once`.
    jumps: True if the instruction can write PC.
    loops: True for a branch, which can close a loop; False for calls and returns.
    late: mask of the FPU registers that are written only after the next instruction; the bit FLAGS is for LUF and LVF.
    plain: the function that writes all results at once. It is set only by `delay_slots.delay`, which changes `execute`.
    waited: True if the instruction is in memory with wait states.
    tested: mask of the bits of the operand that TBIT or AND AX,loc16,#16 tests; 0 for other instructions.
    has_flow: True after `data_flow` was stored in the attributes sources, replaces, changes, decides, memory_decides
        and pointers, see `data_flow.DataFlow`. Only `image.data_marks` uses them.
    block, block_end: for an instruction that accesses data, the address range of the memory block that contains the
        instruction; otherwise 0.
    """

    __slots__ = (
        "absolute", "accesses", "address", "at_once", "b", "block", "block_end", "byte", "c", "changes", "cycles",
        "decides", "encoding", "execute", "following", "g", "goal", "h", "has_flow", "i", "jumps", "k", "l",
        "late", "loops", "m", "makes", "memory_decides", "n", "needs", "next", "not_taken", "p", "place", "plain",
        "pointers", "q", "r", "repeated", "replaces", "s", "sources", "t", "tested", "u", "v", "w", "waited", "wide",
        "x", "y", "z",
    )  # fmt: skip

    encoding: Encoding
    execute: Execute
    plain: Execute

    def __init__(self) -> None:
        self.b = self.c = self.g = self.h = self.i = self.k = self.l = self.m = self.n = self.p = self.q = -1
        self.r = self.s = self.t = self.u = self.v = self.w = self.x = self.y = self.z = -1
        self.address = self.next = self.place = self.cycles = self.not_taken = self.repeated = 0
        self.accesses = self.absolute = self.tested = self.needs = self.makes = self.late = 0
        self.block = self.block_end = 0
        self.sources = self.replaces = self.changes = self.decides = self.pointers = 0
        self.has_flow = self.memory_decides = False
        self.at_once = self.byte = self.jumps = self.loops = self.waited = self.wide = False
        self.following: Operation | None = None
        self.goal: Operation | None = None


class Cpu(Registers):
    """State of a CPU while it executes an instruction.

    ea: the address of the current operand; REGISTER if the operand is a register.
    field: the value of the current instruction's field l, which encodes its operand.
    high_byte: True if the operand is the upper byte of the word at `ea`.
    cycles: the cycles of the current instruction.
    written_in: the cycle of the current instruction, counted from 1, in which its write to memory passes phase D2.
    repeat: the repeat count N that RPT has set for the next instruction; -1 if there is none.
    passes: the number of completed passes of a repeated instruction.
    """

    STATE = State("ea field high_byte cycles written_in repeat passes")

    def __init__(self) -> None:
        super().__init__()
        self.ea = REGISTER
        self.field = 0
        self.high_byte = False
        self.cycles = self.written_in = 0
        self.repeat = -1
        self.passes = 0

    # Memory; a subclass for a chip overrides these methods ---------------------------

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
        """Return a word of program space, which is the same memory as data space."""
        return self.load16(address & CODE)

    # Operands -----------------------------------------------------------------------

    def locate(self, f: Operation) -> None:  # core: C only
        """Set `ea` to the address of the operand, which the instruction's field l encodes [SPRU430F Table 5-1].

        Change registers as the addressing mode does, for example increment XARn.
        """
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
        if 0xAE <= field <= 0xAF:
            low = reversed_carry(self.ea & M16, xar[0] & M16, field == 0xAF)
            xar[n] = self.ea & HIGH16 | low
        elif field < 0xB8:
            self.arp = field & 7
        elif 0xB9 <= field <= 0xBC:
            xar[n] = self.ea + self.step_of(field - 0xB8, step) & M32
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

    def step_of(self, mode: int, words: int) -> int:  # core: C only
        """Return what *, *++, *--, *0++ or *0-- (modes 0 to 4) adds to an address register. words: the step of *++."""
        if mode == 0:
            return 0
        size = words if mode < 3 else self.xar[0] & M16
        return size if mode & 1 else -size

    def read16(self) -> int:  # core: C only
        if self.ea >= 0:
            return self.load16(self.ea)
        field = self.field
        if field == 0xAD:
            return self.sp
        whole = self._register()
        return whole & M16 if field < 0xA8 or field & 1 else whole >> 16

    def value16(self, f: Operation) -> int:  # core: C only
        """Return the operand of 16 bits that field l selects or, if the form has no field l, the number in field c."""
        return self.read16() if f.l >= 0 else f.c

    def source16(self, f: Operation) -> int:  # core: C only
        """Return AL or AH, as field x selects, or, if the form has no field x, the number in field c."""
        return self.ax(f.x) if f.x >= 0 else f.c

    def write16(self, value: int) -> None:  # core: C only
        if self.ea >= 0:
            self.store16(self.ea, value)
            return
        field = self.field
        if field == 0xAD:
            self.sp = value
        elif field < 0xA8 or field & 1:
            self._put_register(self._register() & HIGH16 | value)
        else:
            self._put_register(self._register() & M16 | value << 16)

    def read32(self) -> int:  # core: C only
        return self.load32(self.ea) if self.ea >= 0 else self._register()

    def write32(self, value: int) -> None:  # core: C only
        if self.ea >= 0:
            self.store32(self.ea, value)
        else:
            self._put_register(value)

    def _register(self) -> int:  # core: C only
        """Return the register of 32 bits that field l selects, or that contains the selected register of 16 bits."""
        field = self.field
        if field < 0xA8:
            return self.xar[field & 7]
        return self.acc if field < 0xAA else self.p if field < 0xAC else self.xt

    def _put_register(self, value: int) -> None:  # core: C only
        """Write the register that `_register` returns."""
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
        """Return the address of the operand plus `words`. Raise IllegalOperation if the operand is a register."""
        if self.ea < 0:
            raise IllegalOperation("the operand is a register, but the instruction also writes the next address")
        return self.ea + words & M32

    def move16(self, value: int) -> None:  # core: C only
        """Write the operand. Set N and Z if the operand is AL or AH (nz@AX in `encodings.toml`)."""
        self.write16(value)
        if self.ea < 0 and self.field in (0xA8, 0xA9):
            self.nz16(value)

    def move32(self, value: int) -> None:  # core: C only
        """Write the operand. Set N and Z if the operand is ACC (nz@ACC in `encodings.toml`)."""
        self.write32(value)
        if self.ea < 0 and self.field in (0xA8, 0xA9):
            self.nz32(value)

    # Control; a subclass with time and interrupts overrides these methods ------------

    def enter(self, vector: int) -> None:
        """Enter the service routine of a vector. The routine returns to `pc`. vector: the number of the vector."""
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
        """Push two words one by one, `low` first. Unlike `push32`, this stores them at SP even if SP is odd."""
        self.push16(low)
        self.push16(high)

    def pop_pair(self) -> int:  # core: C only
        """Pop two words one by one, even if SP is odd. Return them as 32 bits, with the first one as the upper half."""
        high = self.pop16()
        return self.pop16() | high << 16


def reversed_carry(low: int, index: int, subtract: bool) -> int:  # core: noexcept
    """Add or subtract 16-bit numbers with the carry propagating from bit 15 towards bit 0."""
    first, second = mirrored(low), mirrored(index)
    return mirrored((first - second if subtract else first + second) & M16)


def mirrored(value: int) -> int:  # core: noexcept
    """Return a 16-bit value with the order of its bits reversed."""
    value = (value & 0x5555) << 1 | value >> 1 & 0x5555
    value = (value & 0x3333) << 2 | value >> 2 & 0x3333
    value = (value & 0x0F0F) << 4 | value >> 4 & 0x0F0F
    return (value & 0x00FF) << 8 | value >> 8
