"""Shifts of ACC, AX and ACC:P.

A form is one encoding of an instruction, a row of `encodings.toml`. The function named like the row executes the form.
C is the last bit that was shifted out; it is 0 for a shift by 0. Source: SPRU430F chapter 6.
"""

# core: compiled

from __future__ import annotations

from .accumulator import logic
from .cpu import Cpu, Operation
from .half_words import put
from .registers import M16, M32, s16, s32

__all__ = ("bind",)  # when compiled, only `bind` is visible from Python; it finds the other functions by name


def left(cpu: Cpu, value: int, shift: int, bits: int) -> int:
    cpu.c = value >> bits - shift & 1 if shift else 0
    return value << shift & (M16 if bits == 16 else M32)


def right(cpu: Cpu, value: int, shift: int) -> int:
    """Return a value shifted right, and set C. A negative value is shifted arithmetically."""
    cpu.c = value >> shift - 1 & 1 if shift else 0
    return value >> shift


def count(cpu: Cpu, f: Operation, mask: int) -> int:
    """Return the shift count, which is in field s or, if the form has no field s, in the bits `mask` of T."""
    return f.s + 1 if f.s >= 0 else cpu.t() & mask


def LSL_ACC_1_16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, left(cpu, cpu.acc, count(cpu, f, 15), 32))


def LSLL_ACC_T(cpu: Cpu, f: Operation) -> None:
    logic(cpu, left(cpu, cpu.acc, cpu.t() & 31, 32))


def LSRL_ACC_T(cpu: Cpu, f: Operation) -> None:
    logic(cpu, right(cpu, cpu.acc, cpu.t() & 31))


def ASRL_ACC_T(cpu: Cpu, f: Operation) -> None:
    logic(cpu, right(cpu, s32(cpu.acc), cpu.t() & 31))


def SFR_ACC_1_16(cpu: Cpu, f: Operation) -> None:
    logic(cpu, right(cpu, s32(cpu.acc) if cpu.sxm else cpu.acc, count(cpu, f, 15)))


def ROL_ACC(cpu: Cpu, f: Operation) -> None:
    carry = cpu.acc >> 31
    logic(cpu, cpu.acc << 1 | cpu.c)
    cpu.c = carry


def ROR_ACC(cpu: Cpu, f: Operation) -> None:
    carry = cpu.acc & 1
    logic(cpu, cpu.acc >> 1 | cpu.c << 31)
    cpu.c = carry


def LSL_AX_1_16(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, left(cpu, cpu.ax(f.x), count(cpu, f, 15), 16))


def LSR_AX_1_16(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, right(cpu, cpu.ax(f.x), count(cpu, f, 15)))


def ASR_AX_1_16(cpu: Cpu, f: Operation) -> None:
    put(cpu, f.x, right(cpu, s16(cpu.ax(f.x)), count(cpu, f, 15)))


def left64(cpu: Cpu, shift: int) -> None:
    """Shift ACC:P left by 0 to 63, in two halves of 32 bits, and set C, N and Z."""
    acc, p = cpu.acc, cpu.p
    cpu.c = 0 if not shift else acc >> 32 - shift & 1 if shift <= 32 else p >> 64 - shift & 1
    if shift < 32:
        cpu.acc, cpu.p = (acc << shift | p >> 32 - shift) & M32, p << shift & M32
    else:
        cpu.acc, cpu.p = p << shift - 32 & M32, 0
    cpu.n, cpu.z = cpu.acc >> 31, int(not cpu.acc | cpu.p)


def LSL64_ACC_P_1_16(cpu: Cpu, f: Operation) -> None:
    left64(cpu, count(cpu, f, 63))


def right64(cpu: Cpu, shift: int) -> None:
    """Shift ACC:P right logically by 0 to 63, in two halves of 32 bits, and set C, N and Z."""
    acc, p = cpu.acc, cpu.p
    cpu.c = 0 if not shift else p >> shift - 1 & 1 if shift <= 32 else acc >> shift - 33 & 1
    if shift < 32:
        cpu.acc, cpu.p = acc >> shift, p >> shift | (acc << 31 - shift & M32 >> 1) << 1
    else:
        cpu.acc, cpu.p = 0, acc >> shift - 32
    cpu.n, cpu.z = cpu.acc >> 31, int(not cpu.acc | cpu.p)


def LSR64_ACC_P_1_16(cpu: Cpu, f: Operation) -> None:
    right64(cpu, count(cpu, f, 63))


def ASR64_ACC_P_1_16(cpu: Cpu, f: Operation) -> None:
    cpu.put_acc_p(right(cpu, cpu.acc_p(), count(cpu, f, 63)))


# Normalise ----------------------------------------------------------------------------------------------------------


def NORM_ACC_ind(cpu: Cpu, f: Operation) -> None:
    """Execute one pass of NORM: if ACC has a redundant sign bit, shift ACC left by one, and step an address register.

    The register is XARn or, if the form has no field n, XAR(ARP). The mode of its step is in b.
    Set TC if there is no redundant sign bit, or ACC is 0; else clear TC.
    """
    if cpu.acc and cpu.acc >> 31 == cpu.acc >> 30 & 1:
        cpu.acc = cpu.acc << 1 & M32
        n = f.n if f.n >= 0 else cpu.arp
        cpu.xar[n] = cpu.xar[n] + cpu.step_of(f.b, 1) & M32
        cpu.tc = 0
    else:
        cpu.tc = 1
    cpu.nz32(cpu.acc)


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name. Raise KeyError if this module has no such function."""
    f.execute = globals()[name]
