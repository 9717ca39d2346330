"""Instructions for AX and 16-bit operands: addition, subtraction, comparison, logic, bits and bytes.

A form is one encoding of an instruction, a row of `encodings.toml`. The function named like the row executes the form.
These instructions set V after an overflow, but never clear it [Table 2-7]. Source: SPRU430F chapter 6.
"""

# core: compiled

from __future__ import annotations

from .cpu import Cpu, Operation, mirrored
from .registers import M16, SIGN16, s16

__all__ = ("bind",)  # when compiled, only `bind` is visible from Python; it finds the other functions by name


def sum16(cpu: Cpu, a: int, b: int) -> int:
    total = a + b
    result = total & M16
    cpu.c = total >> 16
    if ~(a ^ b) & (a ^ result) & SIGN16:
        cpu.v = 1
    cpu.nz16(result)
    return result


def difference16(cpu: Cpu, a: int, b: int) -> int:
    result = a - b & M16
    cpu.c = int(a >= b)
    if (a ^ b) & (a ^ result) & SIGN16:
        cpu.v = 1
    cpu.nz16(result)
    return result


def compared16(cpu: Cpu, a: int, b: int) -> None:
    """Set N, Z and C by a - b. N is the sign of the exact signed difference. C is 0 after an unsigned borrow."""
    cpu.n, cpu.z, cpu.c = int(s16(a) < s16(b)), int(a == b), int(a >= b)


def put(cpu: Cpu, x: int, value: int) -> None:
    """Write AL (x = 0) or AH (x = 1), and set N and Z by the value."""
    cpu.put_ax(x, value & M16)
    cpu.nz16(value & M16)


def write(cpu: Cpu, value: int) -> None:
    """Write the operand in memory or in a register, and set N and Z by the value."""
    cpu.write16(value & M16)
    cpu.nz16(value & M16)


def ADD_AX_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.put_ax(f.x, sum16(cpu, cpu.ax(f.x), cpu.read16()))


def ADD_loc16_AX(cpu: Cpu, f: Operation) -> None:
    cpu.write16(sum16(cpu, cpu.read16(), cpu.source16(f)))


def ADDB_AX_8s(cpu: Cpu, f: Operation) -> None:
    cpu.put_ax(f.x, sum16(cpu, cpu.ax(f.x), (f.c ^ 0x80) - 0x80 & M16))


def SUB_AX_loc16(cpu: Cpu, f: Operation) -> None:
    cpu.put_ax(f.x, difference16(cpu, cpu.ax(f.x), cpu.read16()))


def SUB_loc16_AX(cpu: Cpu, f: Operation) -> None:
    cpu.write16(difference16(cpu, cpu.read16(), cpu.ax(f.x)))


def SUBR_loc16_AX(cpu: Cpu, f: Operation) -> None:
    cpu.write16(difference16(cpu, cpu.ax(f.x), cpu.read16()))


def NEG_AX(cpu: Cpu, f: Operation) -> None:
    value = cpu.ax(f.x)
    cpu.c = int(value == 0)
    cpu.v |= int(value == SIGN16)
    put(cpu, f.x, -value)


def CMP_AX_loc16(cpu: Cpu, f: Operation) -> None:
    compared16(cpu, cpu.ax(f.x), cpu.value16(f))


def CMP_loc16_16s(cpu: Cpu, f: Operation) -> None:
    compared16(cpu, cpu.read16(), f.c)


def MAX_AX_loc16(cpu: Cpu, f: Operation) -> None:
    """Set AX to the maximum of AX and the operand; to the minimum if b = 1."""
    value, ax = cpu.read16(), cpu.ax(f.x)
    compared16(cpu, ax, value)
    smaller, larger = (value, ax) if f.b == 1 else (ax, value)
    if s16(smaller) < s16(larger):
        cpu.put_ax(f.x, value)
        cpu.v = 1


def AND_AX_loc16_16(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, cpu.read16() & f.c)


def AND_loc16_AX(cpu: Cpu, f: Operation) -> None:
    write(cpu, cpu.read16() & cpu.source16(f))


def AND_AX_loc16(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, cpu.ax(f.x) & cpu.value16(f))


def OR_AX_loc16(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, cpu.ax(f.x) | cpu.value16(f))


def OR_loc16_AX(cpu: Cpu, f: Operation) -> None:
    write(cpu, cpu.read16() | cpu.source16(f))


def XOR_AX_loc16(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, cpu.ax(f.x) ^ cpu.value16(f))


def XOR_loc16_AX(cpu: Cpu, f: Operation) -> None:
    write(cpu, cpu.read16() ^ cpu.source16(f))


def NOT_AX(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, ~cpu.ax(f.x))


def FLIP_AX(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, mirrored(cpu.ax(f.x)))


def MOV_AX_loc16(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, cpu.value16(f))


# Bits and bytes -----------------------------------------------------------------------------------------------------


def TBIT_loc16_bit(cpu: Cpu, f: Operation) -> None:
    cpu.tc = cpu.read16() >> f.b & 1


def TBIT_loc16_T(cpu: Cpu, f: Operation) -> None:
    cpu.tc = cpu.read16() >> 15 - (cpu.t() & 15) & 1


def TCLR_loc16_bit(cpu: Cpu, f: Operation) -> None:
    """Set TC to a bit of the operand, and clear the bit, or set it if c = 1."""
    value = cpu.read16()
    cpu.tc = value >> f.b & 1
    cpu.move16(value | 1 << f.b if f.c == 1 else value & ~(1 << f.b))


def byte_of(cpu: Cpu) -> int:
    return cpu.read16() >> (8 if cpu.high_byte else 0) & 0xFF


def with_byte(cpu: Cpu, byte: int) -> int:
    """Return the word of the operand, in which `byte` replaces the byte that the operand addresses."""
    word = cpu.read16()
    return word & 0xFF | byte << 8 if cpu.high_byte else word & 0xFF00 | byte


def MOVB_AX_LSB_loc16(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, byte_of(cpu))


def MOVB_AX_MSB_loc16(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, cpu.ax(f.x) & 0xFF | byte_of(cpu) << 8)


def MOVB_loc16_AX_LSB(cpu: Cpu, f: Operation) -> None:
    cpu.move16(with_byte(cpu, cpu.ax(f.x) & 0xFF))


def MOVB_loc16_AX_MSB(cpu: Cpu, f: Operation) -> None:
    cpu.move16(with_byte(cpu, cpu.ax(f.x) >> 8))


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name. Raise KeyError if this module has no such function."""
    f.execute = globals()[name]
